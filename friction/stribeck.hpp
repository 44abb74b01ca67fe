#pragma once

#include <slipmode/friction/coefficients.hpp>
#include <slipmode/friction/contact_forces.hpp>

#include <tuple>

namespace slipmode::friction {

/// Rigid friction with an exponential Stribeck curve. In slip λ = N (μ_k + (μ_s − μ_k) e^{−α|v_rel|}) sign(v_rel); in
/// stick |λ| ≤ μ_s N. Source: S4 (3.4)-(3.6).
struct Stribeck {
  double mu_s = 0.0, mu_k = 0.0, alpha = 0.0;

  static constexpr const char* word = "stribeck";
  static constexpr auto fields() {
    return std::tuple_cat(coefficients<Stribeck>(), std::tuple{required("alpha", &Stribeck::alpha, "s/m",
                                                                        "decay with sliding speed", kNonNegative)});
  }

  [[nodiscard]] LawKind kind() const {
    return alpha == 0.0 || mu_s == mu_k ? LawKind::kConstant : LawKind::kSpeedDependent;
  }
  [[nodiscard]] double static_coefficient() const { return mu_s; }
  [[nodiscard]] double limit_coefficient() const { return mu_k; }
  [[nodiscard]] double kinetic_coefficient(double speed) const;
  [[nodiscard]] double fastest_rate(const Pace& pace) const {
    return alpha * ((mu_s - mu_k) * pace.load * pace.mobility + pace.acceleration);
  }
  [[nodiscard]] ContactForces forces(double normal_load) const;
};

}  // namespace slipmode::friction
