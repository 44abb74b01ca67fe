#pragma once

#include <slipmode/friction/contact_forces.hpp>

#include <cmath>
#include <functional>
#include <memory>
#include <tuple>

namespace slipmode::friction {

/// Rigid friction with a friction characteristic of the program's own: in slip λ = N μ(|v_rel|) sign(v_rel), in stick
/// |λ| ≤ μ_s N. Stribeck's law is the one with μ = μ_k + (μ_s − μ_k) e^{−αv}:
///
///     Characteristic{.mu_s = 0.4,
///                    .mu = [](double v) { return 0.2 + 0.2 * std::exp(-8.0 * v); },
///                    .slope = [](double v) { return -1.6 * std::exp(-8.0 * v); }}
///
/// μ is continuous for v ≥ 0; where its slope or curvature jumps, steps are short. A trial step may pass v = 0 before
/// the event there is found, so they are asked a little below 0 too, where they should go on as their formulas do: that
/// costs steps if they do not, and changes no result. They are called several times per step, by several threads at
/// once in sweeps, and must not throw.
///
/// A law made of functions has no numbers that a file could hold: it has no word, and whoever writes it to a scene or
/// a result is told so (law_word).
struct Characteristic {
  double mu_s = 0.0;                         ///< ≥ μ(0)
  std::function<double(double)> mu = {};     ///< of the sliding speed v [m/s]
  std::function<double(double)> slope = {};  ///< dμ/dv [s/m]
  /// The largest |dμ/dv| and |d²μ/dv²| between two speeds, below 0 too. With them, and `most`, steps are certified.
  std::function<LawBounds(double, double)> bounds = {};
  /// The largest μ, where it is known. Without it, and with mu_s = 0, forces are measured by themselves.
  double most = 0.0;

  static constexpr auto fields() { return std::tuple{}; }

  [[nodiscard]] LawKind kind() const { return kind_by_speed(mu_s); }
  [[nodiscard]] double static_coefficient() const { return mu_s; }
  /// μ(0): what it tends to at large speed is not known.
  [[nodiscard]] double limit_coefficient() const { return mu(0.0); }
  [[nodiscard]] double kinetic_coefficient(double speed) const { return mu(speed); }
  [[nodiscard]] double fastest_rate(const Pace& pace) const { return std::abs(slope(0.0)) * pace.load * pace.mobility; }
  [[nodiscard]] ContactForces forces(double normal_load) const {
    return {.kind = kind(),
            .kinetic = mu(0.0) * normal_load,
            .characteristic = std::make_shared<const Characteristic>(*this)};
  }
};

}  // namespace slipmode::friction
