#pragma once

#include "orbits/balance/internal/trigonometric.hpp"

#include <Eigen/Core>

namespace slipmode::orbits {

/// How many instants a force is looked at: 0 for the exact integrals between its switches.
inline constexpr int kExact = 0;

/// Orders of a series: all from 0 on, or the odd ones of a motion that has no others.
struct Orders {
  Eigen::Index first = 0, step = 1, count = 0;

  Orders(Eigen::Index highest) : count(highest + 1) {}  // NOLINT(google-explicit-constructor): all up to it
  [[nodiscard]] static Orders odd(Eigen::Index highest) { return {1, 2, (highest + 1) / 2}; }

  [[nodiscard]] Eigen::Index at(Eigen::Index i) const { return first + step * i; }
  [[nodiscard]] bool has_mean() const { return first == 0; }
  /// Of cosines and sines: there is no sine_0.
  [[nodiscard]] Eigen::Index numbers() const { return 2 * count - (has_mean() ? 1 : 0); }
  /// Of the same kind, up to another order.
  [[nodiscard]] Orders up_to(Eigen::Index highest) const { return has_mean() ? Orders(highest) : odd(highest); }

 private:
  Orders(Eigen::Index from, Eigen::Index by, Eigen::Index many) : first(from), step(by), count(many) {}
};

/// The Fourier coefficients of a contact's force along a given motion, and their derivatives.
struct BalancedForce {
  Eigen::VectorXcd phasors;  ///< of λ [H + 1]
  Orders leading;            ///< by which there are derivatives; odd ones: the motion has no others
  /// d(λ's)/d(y's), both in the order of the cosines, then the sines: cosine_0 … cosine_L, sine_1 … sine_L.
  Eigen::MatrixXd jacobian;
  int switches = 0;    ///< instants at which the law's branch changes; of samples, changes from one to the next
  bool stuck = false;  ///< behind a contact spring, and never sliding: the slider's place is not told by the motion

  BalancedForce(Eigen::Index harmonics, const Orders& own)
      : phasors(Eigen::VectorXcd::Zero(harmonics + 1)),
        leading(own),
        jacobian(Eigen::MatrixXd::Zero(own.numbers(), own.numbers())) {}
};

/// How a contact's force answers a motion beside y, δλ = s(θ) δy + d(θ) δẏ, as g_m = (1/2π) ∫ e^{imθ} s dθ of s and d.
struct ForceTangent {
  Eigen::VectorXcd stiffness, damping;  ///< m = 0 … M
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
