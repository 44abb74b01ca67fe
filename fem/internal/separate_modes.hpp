#pragma once

#include <Eigen/Core>
#include <optional>

/// Inside of modal_rows, not for use elsewhere.
namespace slipmode::fem::detail {

/// Eigenvalues of a symmetric tridiagonal matrix, ascending, and rows of its eigenvectors, whose signs are arbitrary.
struct SeparateModes {
  Eigen::VectorXd values;  ///< [n]
  Eigen::MatrixXd rows;    ///< y_iᵀ u_k [m x n]
};

/// Each pair by itself, many side by side: eigenvalues isolated by Sturm's count and refined by Newton's iteration on
/// the characteristic polynomial, vectors by the recurrence from both ends to where they are largest (Parlett &
/// Dhillon, Linear Algebra Appl. 267 (1997) 247). O(n²), a fifth of implicit QL's time. Nothing orthogonalises the
/// vectors: none are given where eigenvalues are close, couplings small, a residual above 1e-14 (4e-16 √n of more than
/// 600), or where rows Uᵀ U rowsᵀ is not rows rowsᵀ to 1e-11.
/// @param diagonal  n, of order 1 @param off_diagonal  n − 1 @param rows  y_iᵀ [m x n]
[[nodiscard]] std::optional<SeparateModes> separate_modes(const Eigen::VectorXd& diagonal,
                                                          const Eigen::VectorXd& off_diagonal,
                                                          const Eigen::MatrixXd& rows);

}  // namespace slipmode::fem::detail
