#pragma once

#include <slipmode/friction/contact_forces.hpp>
#include "orbits/balance/internal/balanced_force.hpp"
#include "orbits/balance/internal/passage.hpp"

#include <complex>

namespace slipmode::orbits {

/// A law of the sliding speed without stick, under a constant load, as BalancedLaw lists it; y as it is seen from the
/// counterpart: λ = f(−Ω y′), δλ = −f′ Ω δy′.
///
/// No integral of f is known along a series. Exact is what as many samples give as it takes: they are doubled until no
/// coefficient moves by 1e-13 of the force, which a periodic analytic function needs few for, up to 2¹⁵, which a law by
/// points takes for its kinks. How many depends on the sharpest turn of the law, ε of the largest speed. Source:
/// docs/theory/harmonic-balance.md, section 2.
struct BalancedSmooth {
  static constexpr bool kRemembers = false, kFollowsDrive = true;
  friction::ContactForces law;
  double share = 1.0;

  /// f(share v)/share: at 0 a damper, with the slope at rest.
  [[nodiscard]] BalancedSmooth at_share(double of_it) const;
  [[nodiscard]] BalancedForce force(const TrigonometricPolynomial& y, double omega, int samples,
                                    const Orders& leading) const;
  [[nodiscard]] Passage passage(const TrigonometricPolynomial& /*y*/, double /*omega*/) const {
    return {dynamics::ContactMode::kSmooth, {}};
  }
  [[nodiscard]] std::complex<double> impedance(double omega) const { return {0.0, strongest(omega)}; }
  [[nodiscard]] double strongest(double omega) const;
  /// How the force answers a motion beside y. @param moments  M
  [[nodiscard]] ForceTangent tangent(const TrigonometricPolynomial& y, double omega, Eigen::Index moments) const;

  /// λ at a relative velocity, and dλ/dv.
  [[nodiscard]] double at(double v, double& out_slope) const;
};

}  // namespace slipmode::orbits
