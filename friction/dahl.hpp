#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/friction/contact_forces.hpp>

#include <cmath>
#include <tuple>

namespace slipmode::friction {

/// Dahl's law: λ = σ z, ż = v_rel − |v_rel| σ z / (μ N): a spring σ that yields smoothly; no difference between static
/// and kinetic friction. Source: P. R. Dahl, A solid friction model, TOR-158(3107-18), Aerospace Corporation, 1968,
/// with exponent 1.
struct Dahl {
  double mu = 0.0, stiffness = 0.0;

  static constexpr const char* word = "dahl";
  static constexpr auto fields() {
    return std::tuple{required("mu", &Dahl::mu, "1", "coefficient", kPositive).stored_as("mu_s"),
                      required("stiffness", &Dahl::stiffness, "N/m", "of contact spring or bristle", kPositive)};
  }

  [[nodiscard]] LawKind kind() const { return LawKind::kBristle; }
  [[nodiscard]] double static_coefficient() const { return mu; }
  [[nodiscard]] double limit_coefficient() const { return mu; }
  [[nodiscard]] double kinetic_coefficient(double /*speed*/) const { return mu; }
  [[nodiscard]] double fastest_rate(const Pace& pace) const {
    return std::sqrt(stiffness * pace.mobility) + stiffness * pace.speed / (mu * pace.load);
  }
  [[nodiscard]] ContactForces forces(double normal_load) const {
    return {.kind = kind(), .bristle = {.stiffness = stiffness, .kinetic = mu * normal_load}};
  }
};

}  // namespace slipmode::friction
