#pragma once

#include <slipmode/friction/coefficients.hpp>
#include <slipmode/friction/contact_forces.hpp>

namespace slipmode::friction {

/// Rigid Coulomb friction. In slip λ = μ_k N sign(v_rel); in stick |λ| ≤ μ_s N.
struct Coulomb {
  double mu_s = 0.0, mu_k = 0.0;

  static constexpr const char* word = "coulomb";
  static constexpr auto fields() { return coefficients<Coulomb>(); }

  [[nodiscard]] LawKind kind() const { return LawKind::kConstant; }
  [[nodiscard]] double static_coefficient() const { return mu_s; }
  [[nodiscard]] double limit_coefficient() const { return mu_k; }
  [[nodiscard]] double kinetic_coefficient(double /*speed*/) const { return mu_k; }
  [[nodiscard]] double fastest_rate(const Pace& /*pace*/) const { return 0.0; }
  [[nodiscard]] ContactForces forces(double normal_load) const { return {.kinetic = mu_k * normal_load}; }
};

}  // namespace slipmode::friction
