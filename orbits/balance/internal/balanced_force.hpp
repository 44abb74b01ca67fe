#pragma once

#include <slipmode/friction/clearance.hpp>
#include "orbits/balance/internal/trigonometric.hpp"

#include <Eigen/Core>
#include <vector>

namespace slipmode::orbits {

/// An instant at which a stop begins to press, or lets go.
struct StopSwitch {
  double theta = 0.0;
  int side = 1;          ///< −1 the left stop, +1 the right one
  bool pressed = false;  ///< after it
  bool jumps = false;    ///< the force does, by ∓ c ẏ: a damped stop that is reached, or let go at its gap
};

/// What a contact's stops do along a motion.
struct StopSwitches {
  int side = 0;                      ///< the stop that presses before the first of them, 0: none
  std::vector<StopSwitch> switches;  ///< in [0, 2π), ascending
};
[[nodiscard]] StopSwitches stop_switches(const friction::Clearance& law, const TrigonometricPolynomial& y,
                                         double omega);

/// How a contact's force answers a motion beside y, δλ = s(θ) δy + d(θ) δẏ, as g_m = (1/2π) ∫ e^{imθ} s dθ of s and d.
struct StopTangent {
  Eigen::VectorXcd stiffness, damping;  ///< m = 0 … M
};
/// @param moments  M
/// @param jumps    with s = Σ_s [λ]/|ẏ| at the switches at which the force jumps by [λ]
[[nodiscard]] StopTangent stop_tangent(const friction::Clearance& law, const TrigonometricPolynomial& y, double omega,
                                       Eigen::Index moments, bool jumps);

/// How many instants a force is looked at: 0 for the exact integrals between its switches.
inline constexpr int kExact = 0;

/// The Fourier coefficients of a contact's force along a given motion, and their derivatives.
struct BalancedForce {
  Eigen::VectorXcd phasors;  ///< of λ [H + 1]
  /// d(λ's)/d(y's) of the orders up to `lead`, both in the order cosine_0 … cosine_L, sine_1 … sine_L [2L+1 x 2L+1].
  Eigen::MatrixXd jacobian;
  int switches = 0;  ///< instants at which a stop is reached or let go; of samples, changes from one to the next
};

/// Force of a clearance along y(θ), θ = Ωt.
///
/// A stop presses with λ = −k (y ∓ b) − c Ω y′ on the set of θ where its law says so, which ends at zeros of
/// trigonometric polynomials. With g_m = (1/2π) ∫ e^{imθ} over that set and double-sided coefficients,
///
///     λ̂_j = Σ_k (−k_s − ikΩc) ŷ_k g_{k−j} ± k_s b g_{−j},   ∂λ̂_j/∂ŷ_k = (−k_s − ikΩc) g_{k−j} + Σ_s [f]
///     e^{i(k−j)θ_s}/(2π y′_s),
///
/// the last where the force jumps at a switch: a damped stop that is reached, or let go at its gap. By samples g_m is a
/// mean over them instead, and there are no switches. Source: docs/theory/harmonic-balance.md, section 2.
/// @param samples  kExact, or their number
/// @param lead     L ≤ H
[[nodiscard]] BalancedForce balanced_force(const friction::Clearance& law, const TrigonometricPolynomial& y,
                                           double omega, int samples, Eigen::Index lead);

}  // namespace slipmode::orbits
