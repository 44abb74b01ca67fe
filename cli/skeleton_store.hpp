#pragma once

#include "cli/session.hpp"
#include "orbits/skeleton_compare.hpp"
#include "results/store.hpp"
#include "results/units.hpp"

#include <Eigen/Core>
#include <string>

namespace slipmode::cli {

/// Group of a result of `slipmode orbit skeleton`; below it "full", "reduced" and "comparison".
inline constexpr const char* kSkeletonGroup = "skeleton";

/// A model's skeleton with what is drawn beside it.
struct ModelSkeleton {
  std::string title;
  orbits::Skeleton skeleton;
  Eigen::MatrixXd
      portrait;  ///< displacement and velocity of the first contact along a stretch of the attractor [2 x T]
};

/// Writes `skeleton/NAME`: a table `orbits`, per orbit a group with its record, passages and path, a table `refusals`.
void store_skeleton(results::StoreWriter& writer, const std::string& name, const ModelSkeleton& model,
                    const results::Units& units);

/// Writes `skeleton/comparison`: a table `matched`, and the numbers of orbits `missed` and `extra`.
void store_comparison(results::StoreWriter& writer, const orbits::SkeletonComparison& comparison);

/// Everything about a skeleton but its paths, orbits numbered from 1.
[[nodiscard]] Json skeleton_json(const ModelSkeleton& model);
[[nodiscard]] std::string skeleton_text(const ModelSkeleton& model);

/// Differences pair by pair, then what is missed and extra.
[[nodiscard]] Json comparison_json(const orbits::SkeletonComparison& comparison);
[[nodiscard]] std::string comparison_text(const orbits::SkeletonComparison& comparison, const orbits::Skeleton& full,
                                          const orbits::Skeleton& reduced);

}  // namespace slipmode::cli
