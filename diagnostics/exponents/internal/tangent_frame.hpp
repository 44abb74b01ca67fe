#pragma once

#include <slipmode/core/random.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::diagnostics {

/// Remainders below this share of what they came from are rounding.
inline constexpr double kCollapse = 1e-10;

/// Directions made orthonormal again after a stretch of motion.
struct Orthonormalised {
  Eigen::MatrixXd directions;         ///< orthonormal columns [N x r]
  Eigen::VectorXd log_growth;         ///< ln of the diagonal of R, of the columns kept [r]
  std::vector<Eigen::Index> columns;  ///< which images were kept, ascending [r]
};

/// Images = Q R by Gram and Schmidt, twice, from the first column to the last. A column of which less than
/// `collapse` · max(1, its length) remains is left out: the motion lost that direction, or contracted it beyond
/// rounding; what remains of it is noise.
/// @param images  of orthonormal directions [N x k]
/// @throws NumericalFailure  for values that are not finite
/// Cost O(N k²).
[[nodiscard]] Orthonormalised orthonormalise(const Eigen::MatrixXd& images, double collapse = kCollapse);

/// Orthonormal columns in random directions [size x count].
[[nodiscard]] Eigen::MatrixXd random_frame(Eigen::Index size, Eigen::Index count, Random& random);

}  // namespace slipmode::diagnostics
