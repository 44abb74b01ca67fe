#pragma once

#include <slipmode/friction/bristle_forces.hpp>
#include <slipmode/friction/clearance.hpp>
#include <slipmode/friction/law_kind.hpp>

#include <array>
#include <memory>
#include <optional>

namespace slipmode::friction {

struct Characteristic;

/// The largest |dλ/dv| and |d²λ/dv²| of a law between two speeds.
struct LawBounds {
  double slope = 0.0;  ///< [N s/m]
  double curve = 0.0;  ///< [N s²/m²]
};

/// A contact's law in the numbers a flow needs, times the normal load: copied out of the law once, so that inner loops
/// ask no variant.
struct ContactForces {
  LawKind kind = LawKind::kConstant;
  double static_limit = 0.0;  ///< μ_s N, in the direction in which it is larger
  double kinetic = 0.0;       ///< μ_k N; without tilt
  double drop = 0.0;          ///< (μ_s − μ_k) N of a speed-dependent law, else 0
  double alpha = 0.0;         ///< [s/m]
  double epsilon = 0.0;       ///< of the smooth law [m/s]
  double stiffness = 0.0;     ///< K_c of a compliant contact, else 0 [N/m]
  BristleForces bristle = {};
  Clearance clearance = {};
  std::shared_ptr<const Characteristic> characteristic = {};  ///< the law itself, if it is made of functions
  double load = 0.0;                                          ///< N these forces belong to [N]
  bool varies = false;  ///< the normal load varies: `under` gives the forces of an instant
  /// Coefficients for a force along −w and along +w; they differ on a tilted slider. Where μ depends on the speed,
  /// mu_k is the one at v → ∞, for a characteristic μ(0).
  std::array<double, 2> mu_s = {}, mu_k = {};

  [[nodiscard]] double static_coefficient(double direction) const { return mu_s[direction > 0]; }
  [[nodiscard]] double kinetic_coefficient(double direction) const { return mu_k[direction > 0]; }
  /// Largest |λ| in stick along this direction: μ_s N.
  [[nodiscard]] double limit(double direction) const { return static_coefficient(direction) * load; }
  /// |λ| just after sliding begins: μ_k N, for a Stribeck law μ_s N, for a characteristic μ(0) N.
  [[nodiscard]] double onset(double direction) const {
    return kind == LawKind::kSpeedDependent ? kinetic + drop : kinetic_coefficient(direction) * load;
  }
  /// The law under another normal load ≥ 0. Coulomb laws only.
  [[nodiscard]] ContactForces under(double normal_load) const;
  /// The largest |λ| there is, as far as it is known: a law's static limit, or what its characteristic rises to.
  [[nodiscard]] double most() const;
  [[nodiscard]] bool sticks() const { return friction::sticks(kind); }
  /// Piecewise linear, and its force in slip constant: what the collocation flow takes without a law to solve.
  [[nodiscard]] bool is_constant() const { return kind == LawKind::kFree || kind == LawKind::kConstant; }
  /// Has a contact spring, a clearance, a load that varies or a tilted slider. Such laws are piecewise linear.
  [[nodiscard]] bool is_elaborate() const {
    return kind == LawKind::kCompliant || kind == LawKind::kClearance || varies || mu_s[0] != mu_s[1] ||
           mu_k[0] != mu_k[1];
  }
  /// λ while sliding with relative velocity v in a direction (±1; not read by a law without stick).
  [[nodiscard]] double sliding(double direction, double v) const;
  /// The same, which goes on as its formula does where v has passed zero against the direction.
  [[nodiscard]] double continued(double direction, double v) const;
  /// |dλ/dv| of a speed-dependent law where sliding begins [N s/m].
  [[nodiscard]] double onset_slope() const;
  /// dλ/dv while sliding. Where v has passed zero against the direction, the law goes on as its formula does.
  [[nodiscard]] double slope(double direction, double v) const;
  /// How λ depends on the speed in the direction of sliding, of the smooth law on v itself. None where nothing is known
  /// between speeds.
  [[nodiscard]] std::optional<LawBounds> bounds(double from, double to) const;
  /// λ of the smooth law (0 for a free contact, and for a bristle, whose force is not a function of v) at relative
  /// velocity v, and dλ/dv.
  [[nodiscard]] double smooth(double v, double& slope) const;
};

}  // namespace slipmode::friction
