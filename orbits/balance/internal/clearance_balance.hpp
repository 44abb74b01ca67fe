#pragma once

#include <slipmode/friction/clearance.hpp>
#include "orbits/balance/internal/balanced_force.hpp"
#include "orbits/balance/internal/passage.hpp"

#include <complex>
#include <vector>

namespace slipmode::orbits {

/// Stops with play between them, as BalancedLaw lists it.
///
/// A stop presses with λ = −k (y ∓ b) − c Ω y′ on the set of θ where its law says so, which ends at zeros of
/// trigonometric polynomials: a LinearPiece with constant ±k b. Its ends move with y; where the force is continuous
/// there that is of second order, a damped stop that is reached, or let go at its gap, makes it jump. By samples g_m is
/// a mean over them instead, and there are no jumps. Source: docs/theory/harmonic-balance.md, section 2.
struct BalancedClearance {
  static constexpr bool kRemembers = false, kFollowsDrive = false;
  friction::Clearance law;

  /// Gaps in this share of their own: at 0 the stops are a spring.
  [[nodiscard]] BalancedClearance at_share(double share) const;
  [[nodiscard]] BalancedForce force(const TrigonometricPolynomial& y, double omega, int samples,
                                    const Orders& leading) const;
  /// A stop that has let go early is the gap.
  [[nodiscard]] Passage passage(const TrigonometricPolynomial& y, double omega) const;
  /// Of both stops, each half the time.
  [[nodiscard]] std::complex<double> impedance(double omega) const;
  [[nodiscard]] double strongest(double omega) const;
  /// How the force answers a motion beside y.
  /// @param moments  M
  /// @param jumps    with s = Σ_s [λ]/|ẏ| at the switches at which the force jumps by [λ]
  [[nodiscard]] ForceTangent tangent(const TrigonometricPolynomial& y, double omega, Eigen::Index moments,
                                     bool jumps) const;
};

}  // namespace slipmode::orbits
