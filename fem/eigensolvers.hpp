#pragma once

#include "fem/structure.hpp"

#include <Eigen/Core>

/// The eigensolvers behind modes.hpp, one file each. Not meant for use outside this folder: inputs are not checked.
namespace slipmode::fem::detail {

/// Solutions of K φ = λ M φ with φᵀMφ = 1, ascending in λ = ω². Signs of the columns are arbitrary.
struct EigenPairs {
  Eigen::VectorXd values;   ///< λ [rad²/s²], k
  Eigen::MatrixXd vectors;  ///< n x k
};

/// A chain's eigenproblem after u = M^{1/2} φ: the symmetric tridiagonal matrix M^{-1/2} K M^{-1/2}.
struct Tridiagonal {
  Eigen::VectorXd diagonal;           ///< n
  Eigen::VectorXd off_diagonal;       ///< n - 1
  Eigen::VectorXd inverse_root_mass;  ///< diagonal of M^{-1/2}, n
};

/// @pre structure.is_chain_like()
[[nodiscard]] Tridiagonal tridiagonal_form(const Structure& structure);

/// All pairs, O(n³): Cholesky of M, Householder tridiagonalisation, implicit QR.
[[nodiscard]] EigenPairs solve_dense(const Structure& structure);

/// The lowest `count` pairs of a chain by LAPACK's dstemr (MRRR), O(n·count).
[[nodiscard]] EigenPairs solve_tridiagonal(const Structure& structure, Eigen::Index count);

/// The lowest `count` < n − m pairs by Spectra's shift-invert Lanczos, then one Rayleigh-Ritz step, which brings the
/// values to rounding. With `constraints` [n x m] the pairs of the structure held at wᵀq = 0.
[[nodiscard]] EigenPairs solve_spectra(const Structure& structure, const Eigen::MatrixXd& constraints,
                                       Eigen::Index count);

/// The lowest `count` < n pairs by ARPACK's shift-invert Lanczos, as ARPACK returns them. ARPACK keeps state between
/// its calls: never run two at once.
[[nodiscard]] EigenPairs solve_arpack(const Structure& structure, Eigen::Index count);

}  // namespace slipmode::fem::detail
