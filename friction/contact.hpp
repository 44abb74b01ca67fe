#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>

namespace slipmode::friction {

/// Rigid Coulomb friction. In slip λ = μ_k N sign(v_rel); in stick |λ| ≤ μ_s N.
struct Coulomb {
  double mu_s = 0.0;  ///< ≥ mu_k
  double mu_k = 0.0;  ///< ≥ 0
};

/// Rigid friction with an exponential Stribeck curve. In slip λ = N (μ_k + (μ_s − μ_k) e^{−α|v_rel|}) sign(v_rel); in
/// stick |λ| ≤ μ_s N. Source: S4 (3.4)-(3.6).
struct Stribeck {
  double mu_s = 0.0;   ///< ≥ mu_k
  double mu_k = 0.0;   ///< ≥ 0
  double alpha = 0.0;  ///< decay with sliding speed, ≥ 0 [s/m]
};

/// The smooth stand-in everybody uses: λ = N (μ_k + (μ_s − μ_k) e^{−α |v|}) tanh(v/ε) with |v| ≈ v tanh(v/ε), so that
/// λ is analytic. There is no stick, only creep; the error is of the order of ε. Kept as a baseline to measure against.
struct TanhRegularised {
  double mu_s = 0.0;
  double mu_k = 0.0;
  double alpha = 0.0;     ///< [s/m]
  double epsilon = 1e-3;  ///< > 0 [m/s]
};

using Law = std::variant<Coulomb, Stribeck, TanhRegularised>;

/// One contact: displacement wᵀq + offset, friction force λ along w on the structure. Relative velocity is
/// v_rel = v_drive − wᵀq̇, so a positive v_rel drags the structure along +w (S4 (3.4)).
struct Contact {
  Eigen::VectorXd direction;  ///< w [n]
  Law law;
  double normal_load = 1.0;  ///< N ≥ 0 [N]
  double offset = 0.0;       ///< added to wᵀq: what an affine reduced basis leaves at q = q̄ [m]
  std::string name = {};
};

/// Checks a contact's numbers.
/// @throws InvalidInput  naming the contact, the value and the valid range: 0 ≤ μ_k ≤ μ_s, N ≥ 0, α ≥ 0, ε > 0, all
///                       finite, w not zero
void validate(const Contact& contact);

/// Force in slip for |v_rel| = speed ≥ 0, in units of the normal load (the friction coefficient). Not for tanh.
[[nodiscard]] double kinetic_coefficient(const Law& law, double speed);
/// μ_s of any law.
[[nodiscard]] double static_coefficient(const Law& law);
/// True when the force in slip does not depend on the sliding speed (Coulomb, or Stribeck with α = 0 or μ_s = μ_k): the
/// contact is then piecewise linear.
[[nodiscard]] bool is_piecewise_linear(const Law& law);

}  // namespace slipmode::friction
