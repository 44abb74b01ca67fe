#pragma once

#include <Eigen/Core>

namespace slipmode::orbits {

// Decompositions by LAPACK where Eigen's (3.4) cannot be trusted with the matrices of contacts that share a place,
// which have many zeros and ones: EigenSolver's iteration does not end on some, and BDCSVD reads outside of its arrays.

/// Of a real square matrix, in LAPACK's order.
struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< norm 1; no columns where they are not asked for
};
/// @throws NumericalFailure  where the iteration does not end, or for a matrix that is not finite
[[nodiscard]] Eigenpairs eigenpairs(Eigen::MatrixXd matrix, bool with_vectors);

/// A = U diag(sigma) Vᵀ, thin, sigma descending.
struct SingularValues {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd sigma;
};
/// @throws NumericalFailure  as above
[[nodiscard]] SingularValues singular_values(Eigen::MatrixXd matrix);

}  // namespace slipmode::orbits
