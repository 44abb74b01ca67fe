#pragma once

#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/results/units.hpp>
#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// The same numbers as JSON, slip states left out.
[[nodiscard]] Json to_json(const diagnostics::ValidationReport& report);

/// The same numbers as tables for a terminal. @param units  of its scene
[[nodiscard]] std::string summary_text(const diagnostics::ValidationReport& report, const results::Units& units);

// Of a shaken scene.
[[nodiscard]] Json to_json(const diagnostics::DrivenValidationReport& report);
[[nodiscard]] std::string summary_text(const diagnostics::DrivenValidationReport& report, const scene::Scene& scene);

}  // namespace slipmode::cli
