#pragma once

#include <slipmode/friction/clearance.hpp>
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
