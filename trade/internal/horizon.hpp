#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/trade/case.hpp>
#include <slipmode/trade/schedule.hpp>

#include <cstdint>
#include <vector>

namespace slipmode::trade {

/// S4's deviations up to a horizon, with the standard error from the scatter over the starts.
struct HorizonDeviation {
  double dX = 0.0, dE = 0.0;                  ///< over all starts together [%]
  double dX_scatter = 0.0, dE_scatter = 0.0;  ///< standard errors; 0 for one start [%]
};

/// `count` states of the reference's motion, `gap` apart, the first being `start`; at sections where it is.
[[nodiscard]] std::vector<dynamics::State> states_of(const Case& reference, const dynamics::State& start, int count,
                                                     double gap, const StopFlag* stop = nullptr);

/// What both models start from.
enum class HorizonStarts : std::uint8_t {
  kCandidate,  ///< the start as the candidate can have it: dX is zero at time 0
  kReference,  ///< each as it can have it: what a projection or a mesh takes off the start counts
};

/// Both run from each start, as the candidate can have it (projected, on its mesh) or each as it can, up to the
/// horizon.
///
/// Where both have the same degrees of freedom and these are of one kind, ΔX and ΔE are those of
/// diagnostics::deviation. On a beam, where displacements and rotations would be added, and meshes may differ, ΔX is
/// that of the reading and ΔE that of each model's own energy about its mean displacement.
/// @param starts  of the reference; not empty
/// @throws InvalidInput, NumericalFailure  as dynamics::simulate
/// @throws Interrupted  if the stop flag was set
[[nodiscard]] HorizonDeviation horizon_deviation(const Case& reference, const Case& candidate,
                                                 const std::vector<dynamics::State>& starts, const Schedule& schedule,
                                                 HorizonStarts from = HorizonStarts::kCandidate,
                                                 const StopFlag* stop = nullptr);

}  // namespace slipmode::trade
