#pragma once

#include <slipmode/core/ranks.hpp>
#include <slipmode/studies/reduction.hpp>
#include <slipmode/studies/run_options.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace slipmode::studies {

/// Proper orthogonal modes of a scene's ensemble, whose snapshots are not kept.
struct EnsembleModes {
  MotionModes found;                       ///< on ranks other than 0 without modes
  std::size_t members = 0;                 ///< that were simulated
  std::vector<std::string> failures = {};  ///< of these, why; the modes are those of the others
};

/// As studies::ensemble and then motion_modes, with the same bytes but for few modes by ranks (pod::pod_of_ranks).
/// @param modes  kept; 0: all there are
/// @param ranks  processes that each simulate and hold a part of the members, see pod::pod_of_ranks; rank 0 finds the
///               modes. Null: this process is on its own
/// @throws InvalidInput      for a scene without [ensemble], what motion_modes refuses, ranks under a shaker, and on a
///                           rank whose scene, version or kernels are not rank 0's
/// @throws NumericalFailure  if every member failed
/// @throws Interrupted       when the run is stopped, or another rank's
[[nodiscard]] EnsembleModes ensemble_modes(const scene::Scene& scene, Eigen::Index modes = 0,
                                           const RunOptions& run = {}, const Ranks* ranks = nullptr);

}  // namespace slipmode::studies
