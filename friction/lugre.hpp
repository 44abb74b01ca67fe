#pragma once

#include <slipmode/friction/coefficients.hpp>
#include <slipmode/friction/contact_forces.hpp>

#include <tuple>

namespace slipmode::friction {

/// The LuGre bristle law: λ = σ0 z + σ1 ż + σ2 v_rel, ż = v_rel − σ0 |v_rel| z / g(v_rel),
/// g(v) = N (μ_k + (μ_s − μ_k) e^{−(v/v_s)²}), with stiffness σ0, damping σ1, viscous σ2, stribeck_speed v_s.
/// Source: Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Automatic Control 40 (1995) 419.
struct LuGre {
  double mu_s = 0.0, mu_k = 0.0, stribeck_speed = 0.0, stiffness = 0.0, damping = 0.0, viscous = 0.0;

  static constexpr const char* word = "lugre";
  static constexpr auto fields() {
    return std::tuple_cat(
        coefficients<LuGre>(kPositive),
        std::tuple{
            required("stribeck_speed", &LuGre::stribeck_speed, "m/s", "Stribeck speed", kPositive),
            required("stiffness", &LuGre::stiffness, "N/m", "of contact spring or bristle", kPositive),
            optional("damping", &LuGre::damping, "N s/m", "of the bristle", kNonNegative).stored_as("bristle_damping"),
            optional("viscous", &LuGre::viscous, "N s/m", "viscous friction", kNonNegative)});
  }

  [[nodiscard]] LawKind kind() const { return LawKind::kBristle; }
  [[nodiscard]] double static_coefficient() const { return mu_s; }
  [[nodiscard]] double limit_coefficient() const { return mu_k; }
  [[nodiscard]] double kinetic_coefficient(double speed) const;
  [[nodiscard]] double fastest_rate(const Pace& pace) const;
  [[nodiscard]] ContactForces forces(double normal_load) const;
};

}  // namespace slipmode::friction
