#pragma once

#include "orbits/balance/internal/trigonometric.hpp"

#include <Eigen/Core>

namespace slipmode::orbits {

/// How many instants a force is looked at: 0 for the exact integrals between its switches.
inline constexpr int kExact = 0;

/// The Fourier coefficients of a contact's force along a given motion, and their derivatives.
struct BalancedForce {
  Eigen::VectorXcd phasors;  ///< of λ [H + 1]
  /// d(λ's)/d(y's) of the orders up to `lead`, both in the order cosine_0 … cosine_L, sine_1 … sine_L [2L+1 x 2L+1].
  Eigen::MatrixXd jacobian;
  int switches = 0;    ///< instants at which the law's branch changes; of samples, changes from one to the next
  bool stuck = false;  ///< behind a contact spring, and never sliding: the slider's place is not told by the motion

  BalancedForce(Eigen::Index harmonics, Eigen::Index lead)
      : phasors(Eigen::VectorXcd::Zero(harmonics + 1)), jacobian(Eigen::MatrixXd::Zero(2 * lead + 1, 2 * lead + 1)) {}
};

/// g_m = (1/2π) ∫ e^{imθ} dθ over the arc from `begin` to `end` ≤ begin + 2π, m = 0 … `moments`.
[[nodiscard]] Eigen::VectorXcd arc_moments(double begin, double end, Eigen::Index moments);

/// e^{2πi n/N}, n = 0 … N − 1.
[[nodiscard]] std::vector<std::complex<double>> sample_turns(int samples);

/// A force −k y − cΩ y′ + constant on a set of θ, zero elsewhere.
struct LinearPiece {
  double stiffness = 0.0, damping = 0.0, constant = 0.0;  ///< k, cΩ
  Eigen::VectorXcd set;                                   ///< its moments g_m, m = 0 … 2H
  /// Σ_s ±e^{imθ_s}/2π over the set's ends at which the force jumps by cΩy′: + where the set ends, − where it begins.
  /// Empty: none.
  Eigen::VectorXcd jumps = {};
};

/// Adds such a force and its derivatives,
///
///     λ̂_j = Σ_k (−k − ikΩc) ŷ_k g_{k−j} + constant g_{−j},   ∂λ̂_j/∂ŷ_k = (−k − ikΩc) g_{k−j} + cΩ (jumps)_{k−j}.
void add_linear(const TrigonometricPolynomial& y, const LinearPiece& piece, BalancedForce& out_force);

/// Adds a constant on a set. @param set  its moments, m = 0 … H or more
void add_constant(double value, const Eigen::VectorXcd& set, BalancedForce& out_force);

/// Adds what a constant on a set does that follows `rate` times y(held_at): derivatives alone.
void add_following(double rate, double held_at, const Eigen::VectorXcd& set, BalancedForce& out_force);

}  // namespace slipmode::orbits
