#pragma once

#include <slipmode/friction/coefficients.hpp>
#include <slipmode/friction/contact_forces.hpp>

#include <cmath>
#include <tuple>

namespace slipmode::friction {

/// Coulomb friction behind a tangential contact spring K_c (Jenkins element, elastic Coulomb). In stick
/// λ = K_c (y_c − y) with y_c the contact point, carried by the drive; in slip λ = μ_k N sign of the sliding speed. The
/// stretch y_c − y is kept when sliding ends; when it begins at |λ| = μ_s N > μ_k N the massless contact point jumps.
/// Source: S4 section 6.1.2 and (6.23), with the sign of K_c corrected.
struct CompliantCoulomb {
  double mu_s = 0.0, mu_k = 0.0, stiffness = 0.0;

  static constexpr const char* word = "compliant";
  static constexpr auto fields() {
    return std::tuple_cat(coefficients<CompliantCoulomb>(),
                          std::tuple{required("stiffness", &CompliantCoulomb::stiffness, "N/m",
                                              "of contact spring or bristle", kPositive)});
  }

  [[nodiscard]] LawKind kind() const { return LawKind::kCompliant; }
  [[nodiscard]] double static_coefficient() const { return mu_s; }
  [[nodiscard]] double limit_coefficient() const { return mu_k; }
  [[nodiscard]] double kinetic_coefficient(double /*speed*/) const { return mu_k; }
  [[nodiscard]] double fastest_rate(const Pace& pace) const { return std::sqrt(stiffness * pace.mobility); }
  [[nodiscard]] ContactForces forces(double normal_load) const {
    return {.kind = kind(), .kinetic = mu_k * normal_load, .stiffness = stiffness};
  }
};

}  // namespace slipmode::friction
