#pragma once

#include <slipmode/core/coupled_parts.hpp>
#include <slipmode/fem/structure.hpp>
#include "fem/internal/shift_invert.hpp"

#include <Eigen/Core>
#include <optional>

/// The eigensolvers behind modes.hpp, one file each. Not meant for use outside this folder: inputs are not checked.
namespace slipmode::fem::detail {

/// From this size on few modes are sought by iteration rather than all by dense decomposition [degrees of freedom].
inline constexpr Eigen::Index kDenseLimit = 500;
/// Of Lanczos, before it is given up.
inline constexpr int kMaxRestarts = 1000;

/// Solutions of K φ = λ M φ with φᵀMφ = 1, ascending in λ = ω² [rad²/s²]. Signs of the columns are arbitrary.
using EigenPairs = Spectrum;

/// A chain's eigenproblem after u = M^{1/2} φ: the symmetric tridiagonal matrix M^{-1/2} K M^{-1/2}.
struct Tridiagonal {
  Eigen::VectorXd diagonal;           ///< n
  Eigen::VectorXd off_diagonal;       ///< n - 1
  Eigen::VectorXd inverse_root_mass;  ///< diagonal of M^{-1/2}, n
};

/// @pre structure.is_chain_like()
[[nodiscard]] Tridiagonal tridiagonal_form(const Structure& structure);

/// All pairs, part by part where M and K couple no others, O(n³): Cholesky of M, Householder tridiagonalisation,
/// implicit QR. When the lowest λ is below 1e-6 of the highest and K has a Cholesky factor, by solve_by_factors, whose
/// error is ε ω_max in ω instead of ε ω²_max in λ.
[[nodiscard]] EigenPairs solve_dense(const Structure& structure);

/// All pairs of the positive definite K + SᵀS by singular values of the factors of K and M and of S, O(n³): error ε
/// ω_max in ω. Nothing when K has no Cholesky factor.
/// @param springs  S [m x n], one row √k wᵀ for each spring; m = 0 for none
[[nodiscard]] std::optional<EigenPairs> solve_by_factors(const Eigen::MatrixXd& M, const Eigen::MatrixXd& K,
                                                         const Eigen::MatrixXd& springs);

/// The lowest `count` pairs of a chain by LAPACK's dstemr (MRRR), O(n·count); where it fails, by dstevr.
[[nodiscard]] EigenPairs solve_tridiagonal(const Structure& structure, Eigen::Index count);

/// The lowest `count` < n − m pairs by Spectra's shift-invert Lanczos, then one Rayleigh-Ritz step, which brings the
/// values to rounding. m counts the rigid holds.
[[nodiscard]] EigenPairs solve_spectra(const Structure& structure, const Holds& holds, Eigen::Index count);

}  // namespace slipmode::fem::detail
