#pragma once

#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>

namespace slipmode::results {

inline constexpr const char* kDrivenValidationGroup = "shaken_validation";

/// Writes the group `shaken_validation`: a table of agreements and costs, the sweeps behind them.
void store_driven_validation(StoreWriter& writer, const diagnostics::DrivenValidationReport& report,
                             const scene::Scene& scene);

}  // namespace slipmode::results
