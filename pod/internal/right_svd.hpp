#pragma once

#include <Eigen/Core>

namespace slipmode::pod {

/// A = U diag(sigma) Vᵀ without U.
struct RightSvd {
  Eigen::VectorXd sigma;    ///< descending
  Eigen::MatrixXd vectors;  ///< V; columns that belong to sigma = 0 are zero when Jacobi was used
};

/// One-sided Jacobi after a column-pivoted QR: for A = B D with D diagonal, however badly scaled, every singular value
/// comes with a relative error of about ε κ(B). Eigen's JacobiSVD stops at an absolute threshold and does not do this.
/// Cost O(n³) per sweep, few sweeps.
/// @param A  m x n
/// @throws NumericalFailure  if the columns are not orthogonal after 60 sweeps
/// Source: Drmač & Veselić, SIAM J. Matrix Anal. Appl. 29 (2008) 1322; Demmel & Veselić, same journal 13 (1992) 1204.
[[nodiscard]] RightSvd right_svd_jacobi(const Eigen::MatrixXd& A);

/// Jacobi for up to 256 columns, LAPACK's divide and conquer above (absolute error ε sigma_1).
/// @throws NumericalFailure  if the iteration does not converge
[[nodiscard]] RightSvd right_svd(const Eigen::MatrixXd& A);

}  // namespace slipmode::pod
