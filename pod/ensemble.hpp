#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace slipmode::pod {

/// Snapshots of one or several runs: displacements, one column per instant.
struct Ensemble {
  Eigen::MatrixXd snapshots;                 ///< n x T [m]
  std::vector<Eigen::Index> run_begin = {};  ///< first column of each run; runs are contiguous; empty: one run
};

/// Checks an ensemble's numbers.
/// @throws InvalidInput  naming the first entry that is not finite, an ensemble without dofs or with T < 2, or run
///                       starts that do not begin with 0 and ascend below T
void validate(const Ensemble& ensemble);

/// One ensemble from the snapshots of several runs, in the order given.
/// @param runs  each n x T_r, T_r ≥ 1
/// @throws InvalidInput  if there is no run, a run is empty or the numbers of rows differ
[[nodiscard]] Ensemble join(std::span<const Eigen::MatrixXd> runs);

}  // namespace slipmode::pod
