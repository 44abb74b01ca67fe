#pragma once

#include <slipmode/friction/coefficients.hpp>
#include <slipmode/friction/contact_forces.hpp>

#include <tuple>

namespace slipmode::friction {

/// The smooth stand-in everybody uses: λ = N (μ_k + (μ_s − μ_k) e^{−α |v|}) tanh(v/ε) with |v| ≈ v tanh(v/ε), so that
/// λ is analytic. There is no stick, only creep; the error is of the order of ε. Kept as a baseline to measure against.
struct TanhRegularised {
  double mu_s = 0.0, mu_k = 0.0, alpha = 0.0, epsilon = 1e-3;

  static constexpr const char* word = "tanh";
  static constexpr auto fields() {
    return std::tuple_cat(
        coefficients<TanhRegularised>(),
        std::tuple{optional("alpha", &TanhRegularised::alpha, "s/m", "decay with sliding speed", kNonNegative),
                   optional("epsilon", &TanhRegularised::epsilon, "m/s", "regularisation speed", kPositive)});
  }

  [[nodiscard]] LawKind kind() const { return LawKind::kSmooth; }
  [[nodiscard]] double static_coefficient() const { return mu_s; }
  [[nodiscard]] double limit_coefficient() const { return mu_k; }
  [[nodiscard]] double kinetic_coefficient(double speed) const;
  [[nodiscard]] double fastest_rate(const Pace& pace) const {
    return (1.0 / epsilon + alpha) * (mu_s * pace.load * pace.mobility + pace.acceleration);
  }
  [[nodiscard]] ContactForces forces(double normal_load) const {
    return {.kind = kind(),
            .kinetic = mu_k * normal_load,
            .drop = (mu_s - mu_k) * normal_load,
            .alpha = alpha,
            .epsilon = epsilon};
  }
};

}  // namespace slipmode::friction
