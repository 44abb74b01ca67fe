#pragma once

#include <slipmode/orbits/skeleton_compare.hpp>
#include <slipmode/results/skeleton_store.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/run_options.hpp>

namespace slipmode::studies {

struct SkeletonRequest {
  double duration = 0.0;    ///< time recorded; 0: 200 times what [time] keeps [s]
  double transient = -1.0;  ///< time left out before it; negative: as [time] says [s]
  orbits::SkeletonOptions search = {};
};

/// The unstable periodic orbits of a model's chaotic motion, from a record of it.
/// @throws Interrupted  when the stop flag was set
[[nodiscard]] results::ModelSkeleton skeleton(const Family& model, const SkeletonRequest& request,
                                              const RunOptions& run = {});

/// Skeletons of a scene's full and reduced model, each also tried from the other's orbits, and both compared in the
/// full one's metric.
struct SkeletonPair {
  results::ModelSkeleton full, reduced;
  orbits::SkeletonComparison comparison;
};
/// @throws Interrupted  when the stop flag was set
[[nodiscard]] SkeletonPair skeletons(const Family& full, const Family& reduced, const SkeletonRequest& request,
                                     const RunOptions& run = {});

}  // namespace slipmode::studies
