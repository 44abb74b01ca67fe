#pragma once

#include <slipmode/fem/structure.hpp>

namespace slipmode::fem {

/// Natural modes K φ = ω² M φ, mass-normalised (φᵀMφ = 1), ascending.
struct Modes {
  /// Circular frequencies [rad/s], k values. Rigid-body modes are exactly 0: ω² counts as zero within the rounding
  /// error of φᵀKφ, 16 ε √(Σ_ij (φ_i K_ij φ_j)²).
  Eigen::VectorXd omega;
  /// n x k. Each column's largest component in magnitude is positive; of several equal within 1e-9 the first counts.
  Eigen::MatrixXd shapes;
};

enum class EigenMethod {
  /// Dense up to 64 dofs; tridiagonal for longer chains; for others dense below 500 dofs or when at least a fifth of
  /// the modes is asked, else Spectra.
  kAutomatic,
  kDense,        ///< Eigen's generalized symmetric solver, all modes, O(n³)
  kTridiagonal,  ///< chains only: LAPACK dstemr (MRRR), O(n k)
  kSpectra,      ///< shift-invert Lanczos at a small negative shift (works for rigid-body modes)
};

/// The lowest `count` natural modes (0 = all).
/// @throws InvalidInput      if count < 0 or count > n, the method cannot serve (all modes by Lanczos, tridiagonal for
///                           what is no chain), or K is not positive semi-definite
/// @throws NumericalFailure  if the iteration does not converge
[[nodiscard]] Modes natural_modes(const Structure& structure, Eigen::Index count = 0,
                                  EigenMethod method = EigenMethod::kAutomatic);

/// The lowest `count` modes of the structure with wᵀq = 0 for every column w of `constraints` [n x m]: the sticking
/// structure. Orthonormal elimination q = Z y, ZᵀZ = I, Zᵀw = 0; shapes are returned in the dofs of `structure`.
/// S4 (3.32) divides by one mode's contact amplitude instead; that amplitude can be tiny, see docs/theory.
///
/// Constraints that each hold one dof strike it out, which keeps a chain a chain, at the cost of natural_modes. Others
/// use the Householder null space, O(n³), below 500 dofs or when at least a fifth of the modes is asked; else
/// shift-invert Lanczos with the constraint forces solved along, at the cost of sparse solves.
/// @param count  0 (all) to n − m
/// @throws InvalidInput  if a size is wrong, the constraints are linearly dependent or m ≥ n
[[nodiscard]] Modes constrained_modes(const Structure& structure, const Eigen::MatrixXd& constraints,
                                      Eigen::Index count = 0);

/// The lowest `count` modes with springs from contacts to the ground, K + Σ k_c w_c w_cᵀ: the structure stuck to
/// compliant contacts. Tends to constrained_modes as 1/k_c (S4 section 6.3.1's contact stiffness K_c).
///
/// Below 500 dofs or when at least a fifth of the modes is asked: singular values of the stacked factors of K and of
/// the springs, O(n³); else shift-invert Lanczos with the contact forces solved along. Neither loses digits of the low
/// modes to a stiff spring as the sum would: the error is ε ω_max in ω, with ω_max of the sprung structure.
/// @param directions   w_c as columns [n x m]
/// @param stiffnesses  k_c > 0 [m, N/m]
/// @param count        0 (all) to n
/// @throws InvalidInput  if a size is wrong, a value is not finite or a stiffness is not positive
[[nodiscard]] Modes compliant_modes(const Structure& structure, const Eigen::MatrixXd& directions,
                                    const Eigen::VectorXd& stiffnesses, Eigen::Index count = 0);

/// Circular frequencies of all modes and the modal rows rowᵀΦ of a few vectors, without forming Φ.
struct ModalRows {
  Eigen::VectorXd omega;  ///< n
  /// m x n: rows(i, k) = y_iᵀ φ_k. The sign of a mode is arbitrary here (its shape is never formed), but the same in
  /// all rows of that mode: products of two rows are those of natural_modes.
  Eigen::MatrixXd rows;
};

/// Implicit QL on a chain's tridiagonal matrix, rotating only the wanted rows: O(n² (1 + m)) instead of O(n³).
/// ω² within n ε of the largest counts as zero.
/// @param vectors  n x m, the vectors y_i in the structure's dofs (contact directions, sensors)
/// @throws InvalidInput  if the structure is not chain-like, a size is wrong, a value is not finite
[[nodiscard]] ModalRows modal_rows(const Structure& chain_like, const Eigen::MatrixXd& vectors);

}  // namespace slipmode::fem
