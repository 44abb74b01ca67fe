#pragma once

#include <slipmode/dynamics/bristle.hpp>
#include <slipmode/dynamics/modal_model.hpp>

#include <Eigen/Core>
#include <array>
#include <vector>

namespace slipmode::dynamics {

/// Sign of the sliding speed: −1, 0 (stick) or 1.
[[nodiscard]] inline double sign_of(ContactMode mode) { return static_cast<double>(static_cast<int>(mode)); }

/// A contact's law in the numbers the flow needs, times the normal load.
struct ContactForces {
  /// kFree: no force ever (μ_s N = 0); kConstant: the force in slip depends on the normal load alone; kCompliant: the
  /// same behind a contact spring; kStribeck: it depends on the sliding speed; kSmooth: no stick at all. Free and
  /// smooth contacts have no events (ContactMode::kSmooth). kBristle: no stick either, but the sliding speed's sign
  /// matters; its forces are the collocation flow's. kClearance: stops with play between them, no friction.
  enum class Kind : std::uint8_t { kFree, kConstant, kCompliant, kStribeck, kSmooth, kBristle, kClearance };
  Kind kind = Kind::kConstant;
  double static_limit = 0.0;  ///< μ_s N, in the direction in which it is larger
  double kinetic = 0.0;       ///< μ_k N; without tilt
  double drop = 0.0;          ///< (μ_s − μ_k) N of a speed-dependent law, else 0
  double alpha = 0.0;         ///< [s/m]
  double epsilon = 0.0;       ///< of the smooth law [m/s]
  double stiffness = 0.0;     ///< K_c of a compliant contact, else 0 [N/m]
  BristleForces bristle = {};
  friction::Clearance clearance = {};
  double load = 0.0;    ///< N these forces belong to [N]
  bool varies = false;  ///< the normal load varies: `under` gives the forces of an instant
  /// Coefficients for a force along −w and along +w; they differ on a tilted slider.
  std::array<double, 2> mu_s = {}, mu_k = {};

  [[nodiscard]] double static_coefficient(double direction) const { return mu_s[direction > 0]; }
  [[nodiscard]] double kinetic_coefficient(double direction) const { return mu_k[direction > 0]; }
  /// Largest |λ| in stick along this direction: μ_s N.
  [[nodiscard]] double limit(double direction) const { return static_coefficient(direction) * load; }
  /// |λ| just after sliding begins: μ_k N, for a Stribeck law μ_s N.
  [[nodiscard]] double onset(double direction) const {
    return kind == Kind::kStribeck ? kinetic + drop : kinetic_coefficient(direction) * load;
  }
  /// The law under another normal load ≥ 0. Coulomb laws only.
  [[nodiscard]] ContactForces under(double normal_load) const;
  [[nodiscard]] bool sticks() const {
    return kind == Kind::kConstant || kind == Kind::kCompliant || kind == Kind::kStribeck;
  }
  /// Piecewise linear, and its force in slip constant: what the collocation flow takes without a law to solve.
  [[nodiscard]] bool is_constant() const { return kind == Kind::kFree || kind == Kind::kConstant; }
  [[nodiscard]] bool is_piecewise_linear() const {
    return is_constant() || kind == Kind::kCompliant || kind == Kind::kClearance;
  }
  /// Has what only the closed-form flow provides: a contact spring, a clearance, a load that varies, a tilted slider.
  [[nodiscard]] bool needs_closed_form() const {
    return kind == Kind::kCompliant || kind == Kind::kClearance || varies || mu_s[0] != mu_s[1] || mu_k[0] != mu_k[1];
  }
  /// λ of a clearance at displacement y and velocity ẏ.
  [[nodiscard]] double stop_force(ContactMode mode, double displacement, double velocity) const;
  /// dλ/dt of a clearance.
  [[nodiscard]] double stop_force_rate(ContactMode mode, double velocity, double acceleration) const;
  /// λ while sliding with relative velocity v in this mode (not stick).
  [[nodiscard]] double sliding(ContactMode mode, double v) const;
  /// λ of the smooth law (0 for a free contact, and for a bristle, whose force is not a function of v) at relative
  /// velocity v, and dλ/dv.
  [[nodiscard]] double smooth(double v, double& slope) const;
};
[[nodiscard]] ContactForces contact_forces(const friction::Contact& contact);

/// What every contact does from now on, with its force and how its sliding starts.
struct Resolution {
  std::vector<ContactMode> modes;
  Eigen::VectorXd force;          ///< λ [nc]
  std::vector<int> multiplicity;  ///< order of the zero of the sliding speed at this instant: 0, 1 or 2
};

/// Everything `resolve` has to know of an instant.
struct Instant {
  const ModalModel& model;
  const std::vector<ContactForces>& laws;
  const double* x;  ///< state [2np]
  double time = 0.0;
  double belt_velocity = 0.0;
  double belt_acceleration = 0.0;
  /// λ of the contacts that are not to be decided [nc]; null: their laws give it.
  const Eigen::VectorXd* applied = nullptr;
  double belt_jerk = 0.0;                       ///< d³/dt³ of the counterpart's way: not zero for a shaker only
  Eigen::VectorXd force = {}, force_rate = {};  ///< of a force drive along its directions [nk]; empty without one
};

/// Decides, in one place, what contacts do after an event (Filippov): of the contacts at zero relative velocity
/// (`at_rest`, true where `modes` says stick or the guard was just reached) as many stick as |λ| ≤ μ_s N allows; the
/// worst offender is released in the direction of its stick force until all agree. Where both stick and slip satisfy
/// the equations (μ_k N < |λ| ≤ μ_s N) stick is chosen. The order of evaluation has no influence.
/// @param modes    modes before the instant
/// @param at_rest  contacts to be decided
/// @param released  contacts whose stick force has reached its limit: they slide whatever rounding says
/// @throws NumericalFailure when no consistent choice exists
[[nodiscard]] Resolution resolve(const Instant& now, const std::vector<ContactMode>& modes,
                                 const std::vector<bool>& at_rest, const std::vector<bool>& released);

/// `resolve` for a system with one contact, untilted and under constant load, without allocation.
struct SingleResolution {
  ContactMode mode;
  double force;
  int multiplicity;
};
[[nodiscard]] SingleResolution resolve_single(const Instant& now, bool released, double release_sign);

/// Order of the zero of the sliding speed of a contact that starts to slide now under these forces: 1, or 2 when its
/// acceleration relative to the belt vanishes to rounding. Less than 0: it would be driven back onto the belt.
[[nodiscard]] int start_multiplicity(const Instant& now, int c, ContactMode mode, const Eigen::VectorXd& force);

/// dλ/dt of the sticking contacts; sliding ones follow their laws, bristles their deflections' rates.
/// @param deflection  z of the contacts with bristles; the others' entries are not read [nc]
[[nodiscard]] Eigen::VectorXd stick_force_rates(const Instant& now, const std::vector<ContactMode>& modes,
                                                const Eigen::VectorXd& force, const Eigen::VectorXd& deflection);

/// λ of the sticking contacts (belt acceleration followed), given the sliding ones in `force`; in place.
void stick_forces(const Instant& now, const std::vector<bool>& stuck, Eigen::VectorXd& force);

}  // namespace slipmode::dynamics
