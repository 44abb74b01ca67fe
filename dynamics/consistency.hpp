#pragma once

#include <slipmode/dynamics/modal_model.hpp>
#include <slipmode/friction/contact_forces.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::dynamics {

using friction::ContactForces;
using friction::LawKind;

/// Sign of the sliding speed: −1, 0 (stick) or 1.
[[nodiscard]] inline double sign_of(ContactMode mode) { return static_cast<double>(static_cast<int>(mode)); }

/// The stop a clearance is at in this mode: −1 left, 1 right, 0 none.
[[nodiscard]] inline int stop_side(ContactMode mode) {
  return mode == ContactMode::kRightStop ? 1 : mode == ContactMode::kLeftStop ? -1 : 0;
}

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
  /// Limits under the sizes that loads which vary are sums of: what limits round by is a share of these [nc]; empty
  /// where all loads are constant.
  Eigen::VectorXd limit_size = {};
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

/// wᵀq̈ of a contact under these forces at the contacts.
[[nodiscard]] double contact_acceleration(const Instant& now, int c, const Eigen::VectorXd& force);

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
