#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/trade/case.hpp>
#include <slipmode/trade/measures.hpp>
#include <slipmode/trade/schedule.hpp>

#include <cstdint>
#include <vector>

namespace slipmode::trade {

/// The motion a case settles to.
struct Motion {
  std::vector<double> points;    ///< contact displacement at the first contact's slips; the reading at sections
  std::vector<double> readings;  ///< the reading at every sample
  /// Mean of ½ q̇ᵀMq̇ + ½ (q − ⟨q⟩)ᵀK(q − ⟨q⟩) [J]. About the mean, so that reduced models, whose displacements are
  /// measured from elsewhere, need no correction.
  double energy = 0.0;
  double stick = 0.0;  ///< share of the time, mean over contacts; NaN where a law does not tell
  std::int64_t events = 0;
  dynamics::State end;  ///< in the case's own coordinates
};

/// Runs `start` for `transient`, then records `duration`, in pieces that fit into memory.
/// @param start  under a shaker or a force at a section; so is the end
/// @throws NumericalFailure  as dynamics::simulate
/// @throws Interrupted       if the stop flag was set
[[nodiscard]] Motion run_motion(const Case& model, const dynamics::State& start, double transient,
                                const Schedule& schedule, const StopFlag* stop = nullptr);

/// kPoints, kSpread, kEnergy and kStick of `other` against `reference`; the other two stay NaN.
[[nodiscard]] Values motion_distance(const Motion& reference, const Motion& other);

/// Root mean square of kPoints … kStick over all pairs of motions: how far runs of one model are from each other.
/// @throws InvalidInput  for fewer than two motions
[[nodiscard]] Values motion_scatter(const std::vector<Motion>& motions);

/// A change of each measure and what it is uncertain by; kDx and kDe stay NaN [%].
struct MotionChange {
  Values error = {}, noise = {};
};

/// How far the motions of one model are from those of another, run by run from common starts: means over the runs of
/// numbers, and of quantiles where motion_distance compares distributions. The standard error of the difference, from
/// its scatter over the runs, is the noise; its square is taken off that of the difference, so that runs of one model
/// are on average no distance apart.
/// @param reference, other  of the same number of runs, two or more
/// @throws InvalidInput  for other numbers of runs
[[nodiscard]] MotionChange motion_change(const std::vector<Motion>& reference, const std::vector<Motion>& other);

}  // namespace slipmode::trade
