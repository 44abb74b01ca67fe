#pragma once

#include <slipmode/pod/basis.hpp>
#include <slipmode/pod/ensemble.hpp>

namespace slipmode::pod {

enum class PodMethod {
  kAutomatic,   ///< thin QR + SVD; Lanczos when min(n, T) > 1000 and few modes are wanted: at most a twentieth of it by
                ///< count, or a share below 1
  kQrSvd,       ///< blocked thin QR of the (transposed) snapshots, then SVD of R: small modes keep their digits
  kLanczos,     ///< Spectra on the Gram operator applied as X(Xᵀy), never formed; leading modes only
  kCovariance,  ///< eigenvectors of XXᵀ: squares the condition number; only when asked
};

struct PodOptions {
  ModeChoice choice = {.modes = 0, .energy = 1.0};
  PodMethod method = PodMethod::kAutomatic;
  bool remove_mean = true;
  /// Singular values up to this fraction of the largest are rounding. 0: the larger of 4 n ε and 4 ε |q̄|_max / σ_1
  /// (for the covariance 4 sqrt(n ε) in place of 4 n ε). Set it smaller when dofs differ by many decades: with T ≥ n
  /// and n ≤ 256 the QR method then has the relative accuracy to use it.
  double rank_tolerance = 0.0;
};

/// Everything the decomposition says about an ensemble.
struct PodResult {
  Basis basis;                      ///< POMs, ΦᵀΦ = I, sign: largest component positive
  Eigen::VectorXd singular_values;  ///< of X − q̄ scaled by 1/sqrt(T) [m]; all min(n, T) by QR, leading ones by Lanczos
  Eigen::VectorXd shares;           ///< σ_i² / Σσ² for every singular value computed; sums to 1 over all n
  Eigen::Index rank = 0;            ///< singular values above rounding, among those computed
  double mean_square = 0.0;         ///< Σσ² = ‖X − q̄‖²_F / T [m²]
};

/// Proper orthogonal modes of an ensemble.
///
/// QR: memory beyond the snapshots O(n² log(T/n) + 256 n) for T ≥ n, O(n T) otherwise; cost 2 n T min(n, T), a sixth
/// more above max(2 n, 4096) snapshots. Lanczos: O(n k) memory and 4 n T per step. Single-threaded and deterministic;
/// pod_of_ranks() does the same with snapshots that lie on several ranks.
/// @throws InvalidInput      T < 2, values not finite, constant snapshots, more modes asked than the data's rank, all
///                           modes asked of Lanczos
/// @throws NumericalFailure  an iteration that does not converge, modes that are not orthonormal to 1e-10
/// Source: S4 section 2.2 and 3.4.1, without forming its covariance matrix.
[[nodiscard]] PodResult pod(const Ensemble& ensemble, const PodOptions& options = {});

/// Proper orthogonal modes in the mass metric: of all bases of L vectors they leave the least mean of xᵀMx, x the part
/// of q − q̄ outside their span.
///
/// With M = L Lᵀ the modes of LᵀX are mapped back, Φ = L⁻ᵀΦ̃, so ΦᵀMΦ = I. Displacements and rotations are weighed by
/// the mass they move: the measure for dofs of different units, and the best case that modes from sensors can reach.
/// Singular values have the unit of √M·q [kg^½ m], mean_square is the mean of (q − q̄)ᵀM(q − q̄). One more copy of the
/// snapshots is made; otherwise as pod().
/// @param M  n x n, symmetric positive definite: the structure's mass matrix
/// @throws InvalidInput, NumericalFailure  as pod(), and for M of other size or not positive definite
[[nodiscard]] PodResult mass_pod(const Ensemble& ensemble, const fem::Matrix& M, const PodOptions& options = {});

/// Principal angles between the column spaces of A and B, ascending [rad]; min(columns of A, columns of B) of them.
/// Small and near-right angles alike are good to rounding: sines and cosines are both computed.
/// @throws InvalidInput  for different numbers of rows, no columns, dependent columns, values not finite
/// Source: Björck & Golub, Math. Comp. 27 (1973) 579; Knyazev & Argentati, SIAM J. Sci. Comput. 23 (2002) 2008.
[[nodiscard]] Eigen::VectorXd subspace_angles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// The same in the inner product xᵀWy, W symmetric positive definite [n x n]: with W = M, angles between LNMs are
/// right.
[[nodiscard]] Eigen::VectorXd subspace_angles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const fem::Matrix& W);

/// Share of the ensemble's (mean-removed) energy captured by the column space of each leading part of `basis`:
/// element L−1 belongs to the first L vectors. Lets LNMs be compared with POMs. Cost 2 n T L.
/// @throws InvalidInput  for a basis of other size, dependent columns, constant snapshots
[[nodiscard]] Eigen::VectorXd captured_energy(const Ensemble& ensemble, const Basis& basis);

/// The same in the mass metric: share of the mean of (q − q̄)ᵀM(q − q̄), M the structure's mass matrix.
/// @throws InvalidInput  as above, and for M of other size or not positive definite
[[nodiscard]] Eigen::VectorXd captured_energy(const Ensemble& ensemble, const Basis& basis, const fem::Matrix& M);

}  // namespace slipmode::pod
