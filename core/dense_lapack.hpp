#pragma once

#include <Eigen/Core>

namespace slipmode {

// Decompositions by LAPACK where Eigen's (3.4) cannot be trusted: EigenSolver's iteration does not end on some matrices
// of contacts that share a place, which have many zeros and ones; BDCSVD reads outside of its arrays there, and gives
// wrong vectors without a word for some others whose least singular value is rounding, as of a chain that floats.

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
/// By divide and conquer: errors of ε times the largest. @throws NumericalFailure  as above
/// @param with_vectors  else U and V have no columns
[[nodiscard]] SingularValues singular_values(Eigen::MatrixXd matrix, bool with_vectors = true);

}  // namespace slipmode
