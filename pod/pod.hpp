#pragma once

#include "pod/basis.hpp"
#include "pod/ensemble.hpp"

namespace slipmode::pod {

enum class PodMethod {
  kAutomatic,  ///< thin QR + SVD when all modes are wanted or n is small; Spectra for few leading modes of large n
  kQrSvd,    ///< blocked thin QR of the (transposed) snapshots, then SVD of R: small modes keep full relative accuracy
  kLanczos,  ///< Spectra on the Gram operator applied as X(Xᵀy), never formed; leading modes only
  kCovariance,  ///< eigenvectors of XXᵀ: squares the condition number; only when asked
};

struct PodOptions {
  ModeChoice choice = {.modes = 0, .energy = 1.0};
  PodMethod method = PodMethod::kAutomatic;
  bool remove_mean = true;
};

/// Everything the decomposition says about an ensemble.
struct PodResult {
  Basis basis;                      ///< POMs, ΦᵀΦ = I, sign: largest component positive
  Eigen::VectorXd singular_values;  ///< of X − q̄ scaled by 1/sqrt(T); all min(n, T) by QR, leading ones by Lanczos
  Eigen::VectorXd shares;           ///< σ_i² / Σσ² for every singular value computed; sums to 1 over all n
  Eigen::Index rank = 0;            ///< singular values above rounding of the largest
};

/// Proper orthogonal modes of an ensemble.
/// @throws InvalidInput  T < 2, values not finite, constant snapshots, more modes asked than the data's rank
/// Source: S4 section 2.2 and 3.4.1.
[[nodiscard]] PodResult pod(const Ensemble& ensemble, const PodOptions& options = {});

/// Principal angles between the column spaces of A and B in the inner product of W (identity if empty), ascending
/// [rad]. Accurate for small angles (sine form), Björck & Golub 1973, Knyazev & Argentati 2002.
[[nodiscard]] Eigen::VectorXd subspace_angles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Flips columns so that each one's largest component in magnitude is positive.
void fix_signs(Eigen::MatrixXd& vectors);

/// Share of the ensemble's (mean-removed) energy captured by the column space of each leading part of `basis`:
/// element L−1 belongs to the first L vectors. Lets LNMs be compared with POMs.
[[nodiscard]] Eigen::VectorXd captured_energy(const Ensemble& ensemble, const Basis& basis);

}  // namespace slipmode::pod
