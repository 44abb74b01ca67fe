#pragma once

#include <slipmode/orbits/periodic_orbit.hpp>

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace slipmode::orbits {

/// A Floquet multiplier and the direction it stretches: Φ v = μ v.
struct FloquetMode {
  std::complex<double> multiplier;
  Eigen::VectorXcd direction;  ///< (q, q̇, internal) [N], norm 1, its largest entry real and positive
};

/// By modulus, descending; of a conjugate pair the one with positive imaginary part first.
[[nodiscard]] Eigen::VectorXcd sorted_by_modulus(const Eigen::VectorXcd& values);

/// Eigenvalues in that order.
[[nodiscard]] Eigen::VectorXcd sorted_eigenvalues(const Eigen::MatrixXd& matrix);

/// All modes of a square matrix in that order. Cost O(N³).
[[nodiscard]] std::vector<FloquetMode> floquet_modes(const Eigen::MatrixXd& matrix);

/// Indices of the trivial entries of `multipliers`: the `count` nearest to 1.
[[nodiscard]] std::vector<Eigen::Index> trivial_indices(const Eigen::VectorXcd& multipliers, int count);

/// Fills in multipliers, leading_modulus, stability, zero_multipliers and superstable from `monodromy` (where that is
/// empty, the multipliers are there already) and `trivial_multipliers`.
/// @param marginal_band  | |μ| − 1 | within this is kMarginal
/// Zero to rounding is |μ| ≤ 1e-8 max(1, ‖Φ‖): dead directions in a row give a root of rounding.
void set_stability(PeriodicOrbit& orbit, double marginal_band);

}  // namespace slipmode::orbits
