#pragma once

#include "cli/session.hpp"
#include "diagnostics/validate.hpp"
#include "results/store.hpp"
#include "scene/scene.hpp"

#include <string>

namespace slipmode::cli {

/// Writes the tables of a validation: `validation/shares` (form of S4 Table 3.1), `validation/orbits` (S4 Table 3.2),
/// `validation/full`, `validation/bifurcation`, `validation/cost`, and `sweep/full`, `sweep/reduced`.
void store_validation(results::StoreWriter& writer, const diagnostics::ValidationReport& report,
                      const scene::Scene& scene);

/// The same numbers as JSON, slip states left out.
[[nodiscard]] Json to_json(const diagnostics::ValidationReport& report);

/// The same numbers as tables for a terminal.
[[nodiscard]] std::string summary_text(const diagnostics::ValidationReport& report);

}  // namespace slipmode::cli
