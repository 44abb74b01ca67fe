#pragma once

#include <Eigen/Core>
#include <vector>

namespace slipmode::cli {

/// A vector as JSON writes it.
[[nodiscard]] inline std::vector<double> json_list(const Eigen::VectorXd& values) {
  return {values.begin(), values.end()};
}

}  // namespace slipmode::cli
