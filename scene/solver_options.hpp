#pragma once

#include <slipmode/diagnostics/attractors/driven.hpp>
#include <slipmode/diagnostics/attractors/settle.hpp>
#include <slipmode/diagnostics/validation/verdict.hpp>
#include <slipmode/scene/scene.hpp>

// What a scene's tables say, as options of the solvers (for a run itself: simulate_options).

namespace slipmode::scene {

/// [flow] for studies of many runs: they report no certificates, and pay for none.
[[nodiscard]] dynamics::FlowOptions uncertified(dynamics::FlowOptions flow);

/// Settling times and period detection of [validation], for attractors and orbits.
[[nodiscard]] diagnostics::SettleOptions settle_options(const Scene& scene);

/// The same at each value of a sweep: waits no longer than `sweep_limit`, and audits nothing.
[[nodiscard]] diagnostics::SettleOptions sweep_settle_options(const Scene& scene);

/// [validation] and [flow] of a scene whose drive has a period.
[[nodiscard]] diagnostics::DrivenOptions driven_options(const Scene& scene);

/// What the verdict runs by [validation] and [time]: exponents over a fifth of lyapunov_duration, a record
/// of 2,000 to 20,000 samples.
[[nodiscard]] diagnostics::ModelVerdictOptions verdict_options(const Scene& scene);

}  // namespace slipmode::scene
