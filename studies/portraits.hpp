#pragma once

#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/results/portrait_store.hpp>

namespace slipmode::studies {

/// What the full model and reduced ones with fewer and fewer modes settle to at the table's speed (S4 Figure 3.7), over
/// five horizons in 5000 samples. @param horizon  of [validation] [s]
[[nodiscard]] results::PortraitSet level_portraits(const dynamics::HybridSystem& full, const pod::NamedBasis& candidate,
                                                   const diagnostics::ValidationReport& report, double horizon);

/// Periodic orbits, full above reduced (S4 Figure 3.8), one column per speed at which both have one.
[[nodiscard]] results::PortraitSet orbit_portraits(const dynamics::HybridSystem& full, const pod::NamedBasis& candidate,
                                                   const diagnostics::ValidationReport& report);

}  // namespace slipmode::studies
