#pragma once

#include <slipmode/dynamics/consistency.hpp>
#include <slipmode/dynamics/regime.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/friction/load_form.hpp>

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace slipmode::dynamics {

/// Where a trajectory is: what both flows carry from step to step.
struct HybridPoint {
  double time = 0.0;
  Eigen::VectorXd x;  ///< state of the slipping structure's modal model [2np]
  std::vector<ContactMode> modes;
  std::vector<int> multiplicity;  ///< order of the zero of each sliding speed right at `time`: 0, 1 or 2
  Eigen::VectorXd force;          ///< λ at `time`, right limit [nc]
  Eigen::VectorXd internal = {};  ///< contacts' own states, as State::internal
  bool goes_on = false;           ///< of a start: its modes are those of a run that goes on

  void assign(Resolution resolution);
};

/// Running sums of the energy balance (see EnergyAudit).
struct WorkSums {
  double contact_work = 0.0, drive_work = 0.0, viscous_loss = 0.0, force_work = 0.0, exchanged = 0.0;

  void add(double contact, double drive, double viscous, double force = 0.0);
};

/// What a guard guards.
enum class GuardKind : std::uint8_t {
  kFriction,  ///< the sliding speed in slip, the force's limit in stick
  kLoad,      ///< the sign of the normal load
  kStop,      ///< where a stop of a clearance is, or what it presses with
};

/// What was reached when a step ended.
struct Reached {
  int contact = -1;       ///< −1: a corner of the drive
  bool touching = false;  ///< the guard was touched and not crossed: a grazing
  GuardKind kind = GuardKind::kFriction;
  ContactMode next = ContactMode::kStick;  ///< of a clearance whose guard was crossed
};

/// A rigid contact that turns or ceases to slide where a run goes on: what that makes of changes of the start.
struct TurnAtStart {
  int contact = -1;              ///< −1: none does
  double acceleration = 0.0;     ///< of V − wᵀq̇, before [m/s²]
  Eigen::VectorXd force_change;  ///< of all contacts [nc]
};

/// A time, and the phase of a drive then, round by this share of themselves.
inline constexpr double kClockRounds = 4.0 * std::numeric_limits<double>::epsilon();
/// What that makes of the drive's velocity [m/s].
double clock_rounding(const friction::Drive& drive, double time);

/// Turns a guard that was reached into events: puts the state onto the guard, lets consistency decide the new modes,
/// keeps the record. The same for either flow.
class EventResolver {
 public:
  EventResolver(const HybridSystem& system, const ModalModel& model, const FlowOptions& options);

  [[nodiscard]] const std::vector<ContactForces>& laws() const { return laws_; }
  [[nodiscard]] const friction::Drive& drive() const { return drive_; }
  [[nodiscard]] Instant instant(double time, const double* x) const;
  /// Force of a force drive along its directions, and its rate [nk]; empty without one.
  [[nodiscard]] Eigen::VectorXd drive_force(double time) const;
  [[nodiscard]] Eigen::VectorXd drive_force_rate(double time) const;
  /// The same with the laws of the instant and the forces of contacts that are not to be decided.
  [[nodiscard]] Instant instant(const HybridPoint& point, const std::vector<ContactForces>& laws,
                                const Eigen::VectorXd& applied) const;
  /// wᵀq̇ of contact c.
  [[nodiscard]] double contact_velocity(int c, const double* x) const;
  /// wᵀq of contact c.
  [[nodiscard]] double contact_displacement(int c, const double* x) const;

  /// The first contact that slides as c does: behind springs at one place, under constant loads. All that slide the
  /// same way turn at the same instant. c itself where there is none before it.
  [[nodiscard]] int slides_as(int c) const { return slides_as_[static_cast<std::size_t>(c)]; }

  /// Takes the velocity error of sticking contacts out of a state, by the impulse that their friction would exert.
  void hold(double time, const std::vector<ContactMode>& modes, double* x) const;

  /// Decides the modes of contacts that start at rest on the drive, behind a contact spring, or without load, and puts
  /// those that stick at its speed. Like `settle`, takes the forces of contacts with bristles from the point. Where a
  /// run goes on, a mode that changes is an event.
  void start(HybridPoint& point);
  [[nodiscard]] const TurnAtStart& turn_at_start() const { return turn_at_start_; }
  /// @throws NumericalFailure  Zeno, or no consistent modes
  void settle(HybridPoint& point, Reached reached);

  /// What contacts in these modes are to a regime's linear equations.
  [[nodiscard]] std::vector<ContactRole> roles(const std::vector<ContactMode>& modes) const;
  /// The regime's input of contact c at a point whose modes are decided.
  [[nodiscard]] double regime_input(const HybridPoint& point, int c) const;
  [[nodiscard]] const friction::LoadForm& load_form(int c) const { return loads_[static_cast<std::size_t>(c)]; }
  /// N of contact c; negative where contact is lost.
  [[nodiscard]] double normal_load(const HybridPoint& point, int c) const;

  /// Events of the last `settle` (simultaneous ones together).
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  void clear() { events_.clear(); }
  /// True if contact c took part in the last `settle`.
  [[nodiscard]] bool has_event(int c) const;
  /// d(stretch)/d(state, contacts' own states) of a contact spring that has just jumped to where it slides
  /// [2np + internal_size].
  [[nodiscard]] Eigen::RowVectorXd slide_stretch_gradient(const HybridPoint& point, int c) const;
  /// Forgets what came before, for a new start.
  void forget() {
    events_.clear();
    turn_at_start_ = {};
    recent_.clear();
  }

 private:
  void hold(double time, const std::vector<Eigen::Index>& contacts, double* x) const;
  /// Whether a stick's force reached its limit because the load is lost.
  [[nodiscard]] bool lets_go(const HybridPoint& point, int contact) const;
  /// See Instant::limit_size.
  [[nodiscard]] Eigen::VectorXd limit_sizes(const HybridPoint& point) const;
  /// Rigid and in contact: between stick and slip accelerations decide.
  [[nodiscard]] bool decides_by_acceleration(const HybridPoint& point, std::size_t c) const;
  [[nodiscard]] bool at_belt_speed(double time, int c, const double* x) const;
  /// @param share  of all that the speed is, and will be, a sum of
  [[nodiscard]] bool at_belt_speed(double time, int c, const double* x, double share) const;
  /// The contact whose limit was reached, and every other that reaches its own at the same instant.
  [[nodiscard]] std::vector<bool> released_together(const HybridPoint& point, int contact) const;
  /// z of the contacts with bristles, 0 of the others [nc].
  [[nodiscard]] Eigen::VectorXd deflections(const HybridPoint& point) const;
  /// What the point's contacts do next, those at rest among them; more are, if at zero speed they do not slide on.
  [[nodiscard]] Resolution decide(const HybridPoint& point, std::vector<bool> at_rest,
                                  const std::vector<bool>& released) const;
  void settle_single(HybridPoint& point);
  /// What turns or slides on through another's event under a shaker is not put at its speed, which rounds with the
  /// event's time, however little of it reaches the structure.
  [[nodiscard]] bool keeps_speed(ContactMode before, ContactMode after, bool reached) const;
  void settle_stop(HybridPoint& point, const Reached& reached);
  /// One contact behind a contact spring: its force is a function of the state, there is nothing to resolve.
  void settle_spring(HybridPoint& point, const Reached& reached);
  void settle_coupled(HybridPoint& point, const Reached& reached);
  /// A contact spring whose contact point starts or ceases to slide.
  void turn_compliant(HybridPoint& point, int c) const;
  /// The same, and of all that cease to slide with it.
  void turn_together(HybridPoint& point, int c) const;
  /// Contact lost or regained.
  void turn_load(HybridPoint& point, int c) const;
  /// The laws at this instant's normal loads.
  [[nodiscard]] std::vector<ContactForces> laws_at(const HybridPoint& point) const;
  /// Of one contact, under the load it has now.
  [[nodiscard]] ContactForces law_at(const HybridPoint& point, int c) const;
  /// λ of a contact in its mode, unless it is rigid and sticks. A bristle's is the point's own.
  [[nodiscard]] double applied_force(const HybridPoint& point, int c) const;
  /// Of all contacts; may be the point's own.
  void applied_forces(const HybridPoint& point, Eigen::VectorXd& out_forces) const;
  /// Velocity at which the contact point of a compliant contact slides in this direction.
  [[nodiscard]] double slide_velocity(const HybridPoint& point, int c, double direction) const;
  [[nodiscard]] const double* own_states(const HybridPoint& point, int c) const;
  void record(const HybridPoint& point, int contact, EventKind kind, ContactMode before);
  void record_change(const HybridPoint& point, int contact, ContactMode before);
  /// @param force_before  of all contacts, in these modes [nc]
  void record_start(const HybridPoint& point, const std::vector<ContactMode>& before,
                    const Eigen::VectorXd& force_before);
  void guard_against_zeno(const HybridPoint& point);

  const ModalModel& model_;
  friction::Drive drive_;
  std::vector<ContactForces> laws_;
  std::vector<friction::LoadForm> loads_;
  std::vector<Eigen::Index> internal_;    ///< of each contact's first own state
  std::vector<Eigen::Index> oscillator_;  ///< of its normal oscillator's, if it has one
  bool plain_ = true;                     ///< one rigid contact, untilted, under constant load
  bool clearances_only_ = true;
  bool lone_spring_ = false;  ///< one contact, compliant
  std::vector<int> slides_as_;
  int max_events_per_window_;
  double zeno_window_;
  std::vector<Event> events_;
  TurnAtStart turn_at_start_;
  std::vector<double> recent_;
};

}  // namespace slipmode::dynamics
