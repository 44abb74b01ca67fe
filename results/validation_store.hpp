#pragma once

#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>

#include <string>

namespace slipmode::results {

/// Writes the tables of a validation: `validation/shares` (form of S4 Table 3.1), `validation/orbits` (S4 Table 3.2),
/// `validation/full`, `validation/bifurcation`, `validation/cost`, and `sweep/full`, `sweep/reduced`.
void store_validation(StoreWriter& writer, const diagnostics::ValidationReport& report, const scene::Scene& scene);

}  // namespace slipmode::results
