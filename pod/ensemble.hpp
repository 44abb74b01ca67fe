#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace slipmode::pod {

/// Snapshots of one or several runs: displacements, one column per instant.
struct Ensemble {
  Eigen::MatrixXd snapshots;            ///< n x T [m]
  std::vector<Eigen::Index> run_begin;  ///< first column of each run; runs are contiguous
};

}  // namespace slipmode::pod
