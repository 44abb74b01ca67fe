#pragma once

namespace slipmode::friction {

/// Dahl's and the LuGre law times the normal load. With s = v_rel and the bristle's deflection z,
///
///     λ = σ0 z + σ1 ż + σ2 s,    ż = s − κ(s) z,    κ = σ0 |s| / g(s),    g(s) = kinetic + drop e^{−(s/v_s)²}.
///
/// Dahl: σ1 = σ2 = 0, g constant. |s| is written as direction · s, so that a law continues smoothly past s = 0, where
/// the direction changes by an event. Theory: docs/theory/bristle-laws.md.
struct BristleForces {
  double stiffness = 0.0;       ///< σ0 [N/m]
  double damping = 0.0;         ///< σ1 [N s/m]
  double viscous = 0.0;         ///< σ2 [N s/m]
  double kinetic = 0.0;         ///< μ_k N [N]
  double drop = 0.0;            ///< (μ_s − μ_k) N [N]
  double stribeck_speed = 1.0;  ///< v_s [m/s]

  /// κ [1/s] and dκ/ds [1/m].
  struct Decay {
    double value, slope;
  };
  [[nodiscard]] Decay decay(double direction, double s) const;
  /// ż [m/s]
  [[nodiscard]] double rate(double direction, double s, double z) const { return s - decay(direction, s).value * z; }
  /// λ [N]
  [[nodiscard]] double force(double direction, double s, double z) const {
    return stiffness * z + damping * rate(direction, s, z) + viscous * s;
  }
  /// ∂λ/∂z [N/m] and ∂λ/∂s [N s/m].
  struct Slopes {
    double by_deflection, by_speed;
  };
  [[nodiscard]] Slopes slopes(double direction, double s, double z) const;
  /// dλ/dt [N/s], for ds/dt [m/s²]
  [[nodiscard]] double force_rate(double direction, double s, double z, double s_rate) const;
};

}  // namespace slipmode::friction
