#pragma once

#include "cli/session.hpp"
#include "diagnostics/validate.hpp"

#include <string>

namespace slipmode::cli {

/// The same numbers as JSON, slip states left out.
[[nodiscard]] Json to_json(const diagnostics::ValidationReport& report);

/// The same numbers as tables for a terminal.
[[nodiscard]] std::string summary_text(const diagnostics::ValidationReport& report);

}  // namespace slipmode::cli
