#pragma once

#include <slipmode/orbits/skeleton_compare.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/units.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace slipmode::results {

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
void store_skeleton(StoreWriter& writer, const std::string& name, const ModelSkeleton& model, const Units& units);

/// Writes `skeleton/comparison`: a table `matched`, and the numbers of orbits `missed` and `extra`.
void store_comparison(StoreWriter& writer, const orbits::SkeletonComparison& comparison);

/// Orbits are numbered from 1 for people.
[[nodiscard]] std::vector<std::int64_t> numbers_of(const std::vector<std::size_t>& indices);

}  // namespace slipmode::results
