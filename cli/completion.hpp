#pragma once

#include "cli/help_layout.hpp"

namespace slipmode::cli {

// Scripts by which a shell completes slipmode's verbs, options and the words that options choose among; elsewhere
// files.
[[nodiscard]] std::string bash_completion(const std::vector<HelpPage>& pages);
[[nodiscard]] std::string zsh_completion(const std::vector<HelpPage>& pages);
[[nodiscard]] std::string fish_completion(const std::vector<HelpPage>& pages);

}  // namespace slipmode::cli
