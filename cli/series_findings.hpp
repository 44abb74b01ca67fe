#pragma once

#include <slipmode/diagnostics/series/findings.hpp>
#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// The table of a terminal, and the same numbers as JSON.
[[nodiscard]] std::string findings_text(const std::vector<diagnostics::Finding>& findings);
[[nodiscard]] Json findings_json(const std::vector<diagnostics::Finding>& findings);

}  // namespace slipmode::cli
