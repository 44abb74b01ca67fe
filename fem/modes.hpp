#pragma once

#include "fem/structure.hpp"

namespace slipmode::fem {

/// Natural modes K φ = ω² M φ, mass-normalised (φᵀMφ = 1), ascending.
struct Modes {
  Eigen::VectorXd
      omega;  ///< circular frequencies [rad/s], k values; rigid-body modes are exactly 0 when below rounding
  Eigen::MatrixXd shapes;  ///< n x k, sign convention: the largest component in magnitude is positive
};

enum class EigenMethod {
  kAutomatic,    ///< dense below 500 dofs or when at least a fifth of the modes is asked, tridiagonal for chains, else
                 ///< Spectra
  kDense,        ///< Eigen's generalized symmetric solver, all modes, O(n³)
  kTridiagonal,  ///< chains only: LAPACK dstemr (MRRR), O(n k)
  kSpectra,      ///< shift-invert Lanczos at a small negative shift (works for rigid-body modes)
  kArpack,       ///< shift-invert Lanczos by ARPACK: the independent check
};

/// The lowest `count` natural modes (0 = all).
/// @throws InvalidInput      if count < 0 or count > n, or the method cannot serve (all modes by Lanczos)
/// @throws NumericalFailure  if the iteration does not converge
[[nodiscard]] Modes natural_modes(const Structure& structure, Eigen::Index count = 0,
                                  EigenMethod method = EigenMethod::kAutomatic);

/// The lowest `count` modes of the structure with wᵀq = 0 for every column w of `constraints` [n x m]: the sticking
/// structure. Orthonormal elimination q = Z y, Zᵀw = 0, so shapes are returned in the dofs of `structure`.
/// S4 (3.32) divides by one mode's contact amplitude instead; that amplitude can be tiny, see docs/theory.
/// @throws InvalidInput  if the constraints are linearly dependent or m ≥ n
[[nodiscard]] Modes constrained_modes(const Structure& structure, const Eigen::MatrixXd& constraints,
                                      Eigen::Index count = 0);

/// Circular frequencies of all modes and the modal rows rowᵀΦ of a few vectors, without forming Φ.
struct ModalRows {
  Eigen::VectorXd omega;  ///< n
  Eigen::MatrixXd rows;   ///< m x n: rows(i, k) = y_iᵀ φ_k
};

/// Implicit QL on a chain's tridiagonal matrix, rotating only the wanted rows: O(n² m) instead of O(n³).
/// @param vectors  n x m, the vectors y_i in the structure's dofs (contact directions, sensors)
/// @throws InvalidInput  if the structure is not chain-like
[[nodiscard]] ModalRows modal_rows(const Structure& chain_like, const Eigen::MatrixXd& vectors);

}  // namespace slipmode::fem
