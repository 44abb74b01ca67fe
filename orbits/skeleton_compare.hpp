#pragma once

#include <slipmode/orbits/skeleton.hpp>

#include <cstddef>
#include <functional>
#include <vector>

namespace slipmode::orbits {

/// An orbit that both skeletons have. Differences are reduced less full.
struct OrbitMatch {
  std::size_t full = 0, reduced = 0;  ///< indices into the skeletons' orbits
  double period = 0.0;                ///< difference of the periods, relative to the full one's
  /// Difference of ln |leading multiplier|; 0 if both are 0.
  double log_multiplier = 0.0;
  double shape = 0.0;  ///< see SkeletonComparison
  double share = 0.0;  ///< difference of the shares of the attractors
};

/// Skeletons of a full and a reduced model side by side.
///
/// Orbits match when their words and lengths are equal and their paths are near each other: the shape difference is the
/// root mean square distance of (q; q̇) at equal parts of each interval between passages, the phase chosen best among
/// the passages, relative to the root mean square size of the full orbit about its mean; coordinates are weighed by the
/// full attractor's metric. The nearest pairs are matched first.
struct SkeletonComparison {
  std::vector<OrbitMatch> matched;  ///< in the order of the full skeleton
  std::vector<std::size_t> missed;  ///< orbits of the full skeleton without a partner
  std::vector<std::size_t> extra;   ///< orbits of the reduced skeleton without one
};

struct SkeletonCompareOptions {
  double max_shape = 0.5;    ///< largest shape difference of a match, > 0
  double max_period = 0.05;  ///< largest |relative difference of periods| of a match, > 0
};

/// @param metric  of the full model's attractor
/// @throws InvalidInput  for skeletons of different size or sampling, options out of range
/// Source: the comparison S4 section 3.5.4 makes by eye.
[[nodiscard]] SkeletonComparison compare_skeletons(const Skeleton& full, const Skeleton& reduced, const Metric& metric,
                                                   const SkeletonCompareOptions& options = {});

/// Shape difference of two orbits of equal length. @throws InvalidInput  for paths of different size
[[nodiscard]] double shape_difference(const SkeletonOrbit& full, const SkeletonOrbit& reduced, const Metric& metric);

/// One model's orbits as candidates for the other: without them an orbit that the other model has too may be missed
/// only because its own record did not come near.
/// @param from  the model whose orbits they are
/// @param map   its states to the other model's: rom::restrict_state or rom::lift. Called on `passages_per_segment`
///              passages apart, for multiple shooting
[[nodiscard]] std::vector<Candidate> transferred_candidates(
    const dynamics::HybridSystem& from, const Skeleton& skeleton,
    const std::function<dynamics::State(const dynamics::State&)>& map, Eigen::Index passages_per_segment = 12);

}  // namespace slipmode::orbits
