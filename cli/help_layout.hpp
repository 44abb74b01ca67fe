#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace slipmode::cli {

/// Help of at most 80 columns: what is said about options and verbs, and the notes below them, is broken between words.
/// Examples, which are indented, stay whole.
class HelpLayout : public CLI::Formatter {
 public:
  [[nodiscard]] std::string make_description(const CLI::App* app) const override;
  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override;
  [[nodiscard]] std::string make_subcommand(const CLI::App* verb) const override;
  [[nodiscard]] std::string make_footer(const CLI::App* app) const override;
};

/// A verb as manual pages and completion see it.
struct HelpPage {
  const CLI::App* app = nullptr;
  std::string words;  ///< "slipmode orbit find"
};

/// The root and all verbs below it, parents first.
[[nodiscard]] std::vector<HelpPage> pages_of(const CLI::App& root);

/// What help puts before an option's description: "-o,--output TEXT REQUIRED".
[[nodiscard]] std::string tag_of(const CLI::Option& option);

/// The words an option chooses among; none when it takes any.
[[nodiscard]] std::vector<std::string> choices_of(const CLI::Option& option);

}  // namespace slipmode::cli
