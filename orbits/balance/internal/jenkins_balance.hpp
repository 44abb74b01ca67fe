#pragma once

#include "orbits/balance/internal/balanced_force.hpp"
#include "orbits/balance/internal/passage.hpp"

#include <complex>
#include <optional>
#include <vector>

namespace slipmode::orbits {

/// A stretch of θ on which a Jenkins element sticks or slides.
struct JenkinsSpan {
  double begin = 0.0, end = 0.0;  ///< [rad]
  int slide = 0;                  ///< 0: sticks; ±1: slides with λ at its upper or lower limit
  double place = 0.0;             ///< of the slider while it sticks [m]
  /// The turning point of y that its place follows; none: the place that it has by itself.
  std::optional<double> held_at = {};
};

/// Coulomb friction behind a contact spring, as BalancedLaw lists it; y as it is seen from the counterpart.
///
/// λ = K (y_c − y) within [−lower, upper]. The slider's place y_c is the play operator of y: it stays until a limit is
/// reached, follows y at the limit's distance until y turns, and stays again. Each stick is a set of θ with
///
///     δλ = −K (δy(θ) − δy(θ_i)),
///
/// θ_i the turning point that ended the slide before: it moves with y, but y′ = 0 there. In slip δλ = 0, and λ is
/// continuous. So the Jacobian is Toeplitz with one rank more for each slide. Turning points are all zeros of y′,
/// onsets the zeros of y − y_c ∓ limit/K on the monotone arcs between. One period of clamping y_c at the turning points
/// makes it periodic, from any start; from 0 it ends, where nothing slides, at the place nearest to 0. By samples the
/// same at these, over two periods. Source: docs/theory/harmonic-balance.md, section 2.
struct BalancedJenkins {
  static constexpr bool kRemembers = true, kFollowsDrive = true;
  double stiffness = 0.0, upper = 0.0, lower = 0.0;  ///< K [N/m]; limits ≥ 0 [N]

  /// Limits over this share: at 0 the element is a spring.
  [[nodiscard]] BalancedJenkins at_share(double share) const;
  [[nodiscard]] BalancedForce force(const TrigonometricPolynomial& y, double omega, int samples,
                                    const Orders& leading) const;
  [[nodiscard]] Passage passage(const TrigonometricPolynomial& y, double omega) const;
  [[nodiscard]] std::complex<double> impedance(double /*omega*/) const { return stiffness; }
  [[nodiscard]] double strongest(double /*omega*/) const { return stiffness; }

  /// What happens in a period, from a turning point on: sticks and slides in turn.
  [[nodiscard]] std::vector<JenkinsSpan> spans(const TrigonometricPolynomial& y) const;
  /// y_c − y at θ = 0 [m].
  [[nodiscard]] double stretch(const TrigonometricPolynomial& y) const;
};

}  // namespace slipmode::orbits
