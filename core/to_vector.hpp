#pragma once

#include <Eigen/Core>
#include <vector>

namespace slipmode {

/// A copy. Sums over a copy have one order; over a list's own memory, which is aligned by chance, they have not.
[[nodiscard]] inline Eigen::VectorXd to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace slipmode
