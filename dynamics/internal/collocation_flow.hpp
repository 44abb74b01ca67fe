#pragma once

#include <slipmode/dynamics/bristle.hpp>
#include <slipmode/dynamics/event_resolver.hpp>
#include <slipmode/dynamics/step_tables.hpp>
#include "dynamics/internal/bernstein.hpp"
#include "dynamics/internal/within_step.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace slipmode::dynamics {

/// The flow by scalar Volterra collocation: between events only contact forces are unknown, eight numbers per contact
/// and step, whatever n is; the linear part is exact. In slip the eight equations λ_i = law(w_i) are solved by Newton;
/// in stick the eight forces that hold wᵀq̇ = v_drive. Slip and stick share the modal basis, so an event costs no change
/// of basis. Bristles (Dahl, LuGre) are collocated at the same nodes and eliminated from the eight equations; their one
/// event is the reversal of the sliding speed. Contact springs, stops and loads that vary with the contact's way are
/// eight more equations, linear in its motion. Theory: docs/theory/flow.md, docs/theory/bristle-laws.md.
///
/// A step ends at the time asked, at the end of a tabulated step, or at an event, whichever comes first. The last step
/// stays readable (`evaluate`) until the next one.
class CollocationFlow {
 public:
  /// @param start  its modes may be undecided where a contact is at rest on its counterpart
  CollocationFlow(const HybridSystem& system, const StepTables& tables, HybridPoint start, const FlowOptions& options);

  /// Advances by one step, not beyond t_limit (> time()). True if it ended at an event.
  bool step(double t_limit);

  [[nodiscard]] const HybridPoint& point() const { return point_; }
  /// Events that ended the last step (simultaneous ones together); before the first step, of the start.
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  [[nodiscard]] const TurnAtStart& turn_at_start() const { return resolver_.turn_at_start(); }
  [[nodiscard]] const WorkSums& work() const { return work_; }
  [[nodiscard]] const FlowStatistics& statistics() const { return statistics_; }

  /// State and contact forces at a time within the last step.
  void evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force);

  /// Carries these tangent vectors along, with saltation at events: of the state, then of the bristles [2np + nb x k].
  /// A direction that would break a stick is projected along the contact's force: the friction impulse of re-sticking.
  void set_tangents(Eigen::MatrixXd tangents);
  [[nodiscard]] const Eigen::MatrixXd& tangents() const { return tangents_; }
  /// d(state, bristles)/dt at the point [2np + nb].
  [[nodiscard]] Eigen::VectorXd point_rate() const;

 private:
  /// Newton's next change is about the square of this one (in units of the law's velocity scale), and is left out when
  /// that is below this share of the tolerance.
  static constexpr double kNewtonShare = 0.03;
  /// A trial step may follow the law past zero relative velocity this far (in units of 1/α): beyond, e^{−αv} runs away.
  /// A characteristic: until it has changed by this share of μ_s.
  static constexpr double kLargestOvershoot = 0.7;
  /// A stick force is told from its limit by this (relative): a step that starts past it by less starts at it.
  static constexpr double kAtLimit = 1e-10;
  /// Speeds below this share of the velocities at play are rounding.
  static constexpr double kUnmoved = 1e-14;
  /// A guard may vanish this share of a step before its form does, or after.
  static constexpr double kAnnounced = 1e-3;

  /// A scalar of an elaborate contact that must stay positive: constant + y wᵀq + v wᵀq̇ + force λ + drive V.
  struct OwnGuard {
    GuardKind kind = GuardKind::kFriction;
    ContactMode next = ContactMode::kStick;  ///< of a clearance
    double constant = 0.0, y = 0.0, v = 0.0, force = 0.0, drive = 0.0;

    [[nodiscard]] double value(double at_y, double at_v, double at_force, double at_drive) const {
      return constant + y * at_y + v * at_v + force * at_force + drive * at_drive;
    }
  };

  struct Guarded {
    double theta = 2.0;  ///< fraction of the step at which the first guard is reached; beyond it: none
    int contact = -1;
    bool touching = false;
    std::optional<OwnGuard> own = {};  ///< of an elaborate contact
    int order = 0;                     ///< of the zero that guard starts with
  };
  /// Those that a step's polynomials reach: the exact time of the first may lie beyond that of others.
  struct FirstGuards {
    Guarded first;
    std::vector<Guarded> others = {};

    void add(Guarded reached) {
      if (reached.theta < first.theta) std::swap(first, reached);
      if (reached.contact >= 0) others.push_back(reached);
    }
  };

  void guess_forces(int level, bool retry);
  [[nodiscard]] int foreseen_level(int level) const;
  /// A characteristic at this speed is steeper than a step of the level resolves.
  [[nodiscard]] bool too_steep(int c, double speed, int level) const;
  bool solve_forces(int level);
  /// One contact of a law the kernels know.
  bool solve_single(const Collocation& table);
  /// @param load  what the load and a drive's forces add to the velocities at the nodes
  bool solve_single_smooth(const Collocation& table, const double* load);
  bool solve_coupled(const Collocation& table, const AtNodes* displacements, double h);
  /// Of a force in `force_error` [1/N]: the largest force, or where it is not known the least of other contacts.
  [[nodiscard]] double over_scale(int c) const;
  [[nodiscard]] double force_error() const;
  /// What of that is the rounding of speeds, which sticks' forces hold within a step, whatever its length: by the time
  /// of a step it is the same, and shorter steps do not lower it.
  [[nodiscard]] double rounding_of_sticks() const;
  /// The impulse that what speeds round by at a held contact takes [Ns].
  [[nodiscard]] double impulse_of_rounding(int c) const;
  /// Of a held contact in a step so short that this is much of its force at the nodes: what states there ask for, which
  /// is what is looked at for its limit.
  void tell_by_states(int c);
  [[nodiscard]] Eigen::Map<const RadauTables::Vector8> told_forces(int c) const;
  /// A stick's margin where a step starts: none where rounding alone has it past the limit; where to, shows next.
  [[nodiscard]] static double or_at_limit(double margin, const ContactForces& law) {
    return margin < 0.0 && margin >= -kAtLimit * law.static_limit ? 0.0 : margin;
  }
  /// Keeps the guards' Bernstein forms for the proof.
  [[nodiscard]] FirstGuards first_guards();

  /// Largest slope of a polynomial of degree 8 that stays within one, on [0, 1] (Markov).
  static constexpr double kSteepest = 2.0 * kNodes * kNodes;
  /// How far the true motion from the step's start may be from the computed one, within the step.
  struct Deviation {
    double force = 0.0, force_slope = 0.0;  ///< of any contact force, and of a sticking one's rate times the step [N]
    double speed = 0.0, speed_slope = 0.0;  ///< of any contact's speed, and of its rate times the step [m/s]
    double room = std::numeric_limits<double>::infinity();  ///< what `speed` was taken to be at most [m/s]
  };
  /// What a bristle brings to that: μ ≤ force · e^{growth t}, as long as speeds are off by no more than `room`.
  struct BristleDefect {
    double force = 0.0, growth = 0.0, room = 0.0;
  };
  /// What a law of which bounds are known brings to it: a force off by `force` and by `growth` times a speed, as long
  /// as that is no more than `room`; and its rate along the computed motion, times the step.
  struct BoundedDefect {
    double force = 0.0, growth = 0.0, room = 0.0, rate = 0.0;
  };
  /// A characteristic or a smooth law, of a contact that is not held.
  [[nodiscard]] bool by_bounds(int c) const;
  [[nodiscard]] BoundedDefect bounded_defect(int c) const;
  /// The largest sliding speed within the step, of the computed motion.
  [[nodiscard]] double fastest_slip(int c) const {
    return std::max(guard_start_(c), guard_forms_.segment<kNodes>(kNodes * c).maxCoeff());
  }
  void prepare_proof();
  /// Whether no guard but the one found vanishes up to this share of the solved step, nor that one before, in the true
  /// motion.
  [[nodiscard]] bool proves(const Guarded& found, double end);
  /// α times the sliding speeds at the nodes.
  [[nodiscard]] RadauTables::Vector8 scaled_speeds(int c) const;
  /// What the polynomial through the nodes leaves out of a speed-dependent law at the computed speeds [N].
  [[nodiscard]] double between_nodes(int c) const;
  /// Whether bounds on everything tell one contact's guard from zero; `ninth_` without the forces' share.
  [[nodiscard]] bool far_from_guards(const StepBounds& bounds, double h) const;
  /// @param at_rest  sliding may come as near to rest as zero speed
  [[nodiscard]] Deviation deviation(const StepBounds& bounds, double h, bool at_rest) const;
  /// @param reach  max |γ|, see StepBounds::response
  [[nodiscard]] BristleDefect bristle_defect(int c, double reach, double h, bool at_rest) const;
  /// Share of the step for which a slip that starts with neither speed nor acceleration goes on; 0: not known.
  [[nodiscard]] double clear_after_release(const StepBounds& bounds, const Deviation& off, double h, int c) const;
  /// Its law's force is the same throughout the step, as long as it is not held.
  [[nodiscard]] bool stays(int c) const {
    const auto i = static_cast<std::size_t>(c);
    return elaborate(c) ? !own_forces_[i].moves() : laws()[i].is_constant();
  }
  /// |dλ/dt| of a contact within the step, of the true motion [N/s].
  [[nodiscard]] double largest_force_rate(int d, const Deviation& off, double h) const;
  /// A guard known with these errors of it and of its slope, positive before `from`. @param found  the event, if it is
  /// this guard's
  [[nodiscard]] bool stays_clear(const BernsteinPolynomial& guard, double error, double slope_error, double from,
                                 const Guarded* found, double end) const;
  /// Of an elaborate contact within the step.
  struct OwnMotion {
    double way = 0.0;    ///< h⁹ max |(wᵀq)⁽⁹⁾| [m]
    double force = 0.0;  ///< h⁹ max |λ⁽⁹⁾| by its law [N]
    double left = 0.0;   ///< what the solution leaves of the law at the nodes [N]
    double start = 0.0;  ///< what the polynomial through the nodes is off it at the step's start [N]
  };
  [[nodiscard]] OwnMotion own_motion(int c, double h) const;
  /// `proves`, of one elaborate contact. @param found  the event, if it is this contact's
  [[nodiscard]] bool proves_own(int c, const Guarded* found, const Deviation& off, double h, double end) const;
  /// Largest |V⁽⁹⁾| h⁹ of the drive.
  [[nodiscard]] double drive_ninth(double h) const;
  [[nodiscard]] bool unmoved(int c) const;
  /// Size of the accelerations that add up to the contact's own where the step begins.
  [[nodiscard]] double balanced(int c) const;
  /// Largest |V − v| at the nodes.
  [[nodiscard]] double fastest_at_nodes(int c) const;
  [[nodiscard]] double velocity_scale(int c, const Eigen::VectorXd& x) const;
  [[nodiscard]] bool too_early(const Guarded& guard) const;
  [[nodiscard]] double deepest_overshoot() const;
  void refine_event(const Guarded& guard, double& tau, Eigen::VectorXd& x);
  /// The same of the first; where that lies beyond the second, whichever is first when both are refined becomes it.
  void refine_first(FirstGuards& guards, double& tau, Eigen::VectorXd& x);
  [[nodiscard]] double stick_force(int c, const Eigen::VectorXd& x, double tau) const;
  /// wᵀq̈ at `begin_ + tau` but for what contacts' forces add.
  [[nodiscard]] double acceleration_without_contacts(int c, const Eigen::VectorXd& x, double tau) const;
  /// wᵀq̈ at `begin_ + tau`. @param basis  Lagrange's there
  [[nodiscard]] double contact_acceleration(int c, const Eigen::VectorXd& x, double tau,
                                            const RadauTables::Vector8& basis) const;
  [[nodiscard]] double acceleration_at_start(int c) const;
  void account(int level, double tau);
  /// ∫ Σ λ v_drive dt over [0, tau] of the step.
  [[nodiscard]] double driven_work(double h, double tau) const;
  void restart_steps();

  // Elaborate contacts (ContactForces::is_elaborate). Unless they are held, their forces are linear in their own
  // motion.
  [[nodiscard]] bool elaborate(int c) const { return elaborate_[static_cast<std::size_t>(c)]; }
  /// Sticks, and not by a spring.
  [[nodiscard]] bool held(const std::vector<ContactMode>& modes, int c) const {
    const auto i = static_cast<std::size_t>(c);
    return modes[i] == ContactMode::kStick && laws()[i].kind != LawKind::kCompliant;
  }
  /// λ = constant + stiffness (way of the drive, where it is followed, − that of wᵀq since the step's start) − damping
  /// wᵀq̇ within a step.
  struct OwnForce {
    double constant = 0.0, stiffness = 0.0, damping = 0.0;
    double place = 0.0;  ///< wᵀq at the step's start
    bool follows = false;

    [[nodiscard]] bool moves() const { return stiffness != 0.0 || damping != 0.0; }
    /// What it changes by at most, of a change of the speed within a step of this length.
    [[nodiscard]] double lipschitz(double h) const { return std::abs(stiffness) * h + std::abs(damping); }
    [[nodiscard]] double at(double way, double moved, double v) const {
      return constant + stiffness * ((follows ? way : 0.0) - moved) - damping * v;
    }
    [[nodiscard]] double rate(double drive, double v, double acceleration) const {
      return stiffness * ((follows ? drive : 0.0) - v) - damping * acceleration;
    }
  };
  /// Of the step that begins at the point.
  void set_own_forces();
  [[nodiscard]] double own_force(int c, double tau, const double* x) const;
  /// What the force of a stop alone rounds by, as its place does [N]: of one that is touched by rounding, all of it.
  [[nodiscard]] double rounding_of_stop(int c) const;
  /// What the contact has moved by since the step's start [m]: to rounding of places, and by as much less where the
  /// polynomial through the nodes tells it, as in a short step. @param x  state at `begin_ + tau`
  [[nodiscard]] double moved(int c, double tau, const double* x) const;
  [[nodiscard]] std::vector<OwnGuard> own_guards(int c, ContactMode mode) const;
  struct GuardValue {
    double value = 0.0, rate = 0.0;
    double second = 0.0;  ///< of a guard of place or stretch alone, where it is told from rounding; else 0
    double size = 0.0, rate_size = 0.0;  ///< of the terms that are summed
  };
  void search_own_guards(int c, FirstGuards& out) const;
  /// Whether a gap that starts at zero, as its slope does, is pushed shut, as told by its curvature at both ends of a
  /// step too short to show it. A stop that lets go has an overlap to lose first.
  /// @param now  at the step's start @param order  of the zero there
  [[nodiscard]] bool pushed_onto(const OwnGuard& guard, int c, const GuardValue& now, int order) const;
  /// The same of a stop's guard that starts at zero, where the order of that zero does not lead: the leading term may
  /// be of any order, where the force that begins to act does so elsewhere, and of a higher one the form's first
  /// coefficients are errors of interpolation. The values at the nodes are none. False where the order leads.
  /// @param now  at the step's start @param order  of the zero there, 1 or 2 @param form  over the step
  [[nodiscard]] bool searched_from_rest(const OwnGuard& guard, int c, const GuardValue& now, int order,
                                        const BernsteinPolynomial& form, FirstGuards& out) const;
  /// Of degree 8 through a start and the nodes.
  [[nodiscard]] BernsteinPolynomial interpolant(double start, const RadauTables::Vector8& at_nodes) const;
  [[nodiscard]] RadauTables::Vector8 at_nodes(const OwnGuard& guard, int c) const;
  /// A guard over the step.
  [[nodiscard]] BernsteinPolynomial form_of(const OwnGuard& guard, int c) const;
  /// What a speed of the contact makes of a guard in the step.
  [[nodiscard]] double moved_by(const OwnGuard& guard, double speed) const;
  /// Where the solved step ends, should nothing end it before.
  [[nodiscard]] Eigen::VectorXd state_ahead() const;
  /// Of the terms that a guard sums where the step ends.
  [[nodiscard]] double size_ahead(const OwnGuard& guard, int c) const;
  /// What the step's tolerance lets a guard be off by.
  [[nodiscard]] double tolerated(const OwnGuard& guard, int c) const;
  /// Of the zero with which a guard starts, 0 if with none. @param now  of the guard at the step's start
  [[nodiscard]] int start_order(const OwnGuard& guard, int c, const GuardValue& now) const;
  [[nodiscard]] GuardValue evaluate(const OwnGuard& guard, int c, double tau, const Eigen::VectorXd& x) const;
  /// d(guard)/d(state, contacts' own states).
  [[nodiscard]] Eigen::RowVectorXd gradient(const OwnGuard& guard, int c) const;
  /// d(λ)/d(state, contacts' own states) of a held contact in the step's modes.
  [[nodiscard]] Eigen::RowVectorXd held_force_gradient(int c) const;
  /// Of an elaborate contact's force, not held, in the step's modes.
  [[nodiscard]] Eigen::RowVectorXd own_force_gradient(int c) const;

  [[nodiscard]] bool bristled(int c) const { return laws()[static_cast<std::size_t>(c)].kind == LawKind::kBristle; }
  void start_bristles();
  /// Forces of bristle contacts, and where those at rest start to, after the resolver has decided about the others.
  void refresh_bristles();
  /// Direction and order of a bristle contact at rest, by its acceleration; the direction stays where that is rounding.
  void start_from_rest(int c);
  /// z at the nodes, for the speeds there.
  void collocate_bristles(double h);
  /// The contacts' own states within the last step, at `begin_ + tau`.
  [[nodiscard]] Eigen::VectorXd internal_within(double tau, const double* x) const;
  /// λ of every contact, but for elaborate ones that are not held: theirs are there. A trial step may have passed zero
  /// speed, beyond which laws go on as their formulas do and the step solves them: a stick's force stays smooth.
  void forces_at(const Instant& now, const std::vector<ContactMode>& modes, const Eigen::VectorXd& internal,
                 Eigen::VectorXd& out_force) const;
  /// λ of every contact within the last step, at `begin_ + tau`, as its law or its stick has it there. @param x  state
  [[nodiscard]] Eigen::VectorXd forces_within(double tau, const Eigen::VectorXd& x) const;
  /// Turns bristle contacts whose acceleration at rest was rounding towards where the solved step takes them. True if
  /// any turned.
  bool turn_resting_bristles();
  /// Of bristle contacts whose direction has changed, at the point.
  void record_reversals(const std::vector<ContactMode>& before);
  void record_bristle(int c, EventKind kind, ContactMode before);
  void settle_bristle(int c, bool touching);
  struct Between;
  /// The start and halfway between nodes.
  static const Between& halfway();
  /// What the force's polynomial leaves of a characteristic there, by the same.
  [[nodiscard]] double characteristic_error(int c) const;
  /// What the polynomials leave of a bristle's equations between the nodes: the error of its force, by the static
  /// limit.
  [[nodiscard]] double bristle_error(int c, const Between& at) const;
  /// The same at a reversal and shortly before.
  [[nodiscard]] double reversal_error(const Guarded& guard) const;
  /// How the Legendre coefficients of a polynomial through the nodes end.
  struct Ending {
    double last = 0.0;   ///< size of the last
    double ratio = 0.0;  ///< of one coefficient to the one before, at most 1
  };
  /// By the last three, so that one which happens to vanish does not say that all that follow do.
  [[nodiscard]] Ending ending(const double* values) const;
  /// The fastest rate at which tangents may change in the solved step, a bristle's on the contact's own mass included:
  /// where nothing moves, the motion's error says nothing of them [1/s].
  [[nodiscard]] double tangent_rate() const;
  void push_tangents(int level, double tau);
  /// @param speeds  tangents of the contacts' velocities at the nodes [8nc x k]
  void push_bristle_tangents(const std::vector<BristleVariation>& bristles, const Eigen::MatrixXd& speeds,
                             double share);
  /// @param rate_before  d(state, contacts' own states)/dt before the event
  void salt_tangents(Eigen::VectorXd rate_before, const Guarded& guard);
  /// A stretch that follows the load where its contact slides is no state of its own.
  void slave_stretches();
  [[nodiscard]] double force_slope(int c, ContactMode mode, double velocity, double drive_velocity) const;

  // The drive at `begin + tau` of a step that began at `begin`; across a belt's corner, what was before it goes on.
  [[nodiscard]] double drive_velocity(double begin, double tau) const;
  [[nodiscard]] double drive_acceleration(double begin, double tau) const;
  [[nodiscard]] RadauTables::Vector8 drive_velocities(double begin, double h) const;
  /// What it has gone since `begin`, to rounding of that way, however short.
  [[nodiscard]] double drive_way(double begin, double tau) const;

  // A drive's forces follow those of the contacts, at the nodes as everywhere: docs/theory/flow.md, section 2.
  /// At the nodes of a step of this level from `begin_` on.
  void give_forces(int level);
  /// At `begin_ + tau` [nk], the derivative of this order.
  [[nodiscard]] Eigen::VectorXd given_force(double tau, int derivative = 0) const;
  /// What it adds to the contact's acceleration there [m/s²].
  [[nodiscard]] double given_acceleration(int c, double tau) const;
  /// What the polynomials through the nodes of a step leave out of it at most; of its rate times the step [N].
  struct LeftOut {
    double value = 0.0, slope = 0.0;
  };
  [[nodiscard]] LeftOut given_left_out(double h) const;
  /// A bound on each derivative [nk].
  [[nodiscard]] Eigen::VectorXd given_most(int derivative) const;

  [[nodiscard]] std::size_t stuck_count() const;
  [[nodiscard]] const std::vector<ContactForces>& laws() const { return resolver_.laws(); }
  [[nodiscard]] const friction::Drive& drive() const { return resolver_.drive(); }

  const StepTables& tables_;
  const RadauTables& nodes_ = radau();
  const ModalModel& model_;
  const kernels::Kernels& kernels_ = kernels::kernels();
  EventResolver resolver_;
  FlowOptions options_;
  WithinStep within_;
  int nc_;
  int given_;                        ///< directions of a drive's forces
  bool single_ = false;              ///< one contact, of a law the kernels know: no bristles, no characteristic
  const double* ahead_ = nullptr;    ///< takes the last step's velocities to this one's nodes, where that is the guess
  double acting_;                    ///< StepTables::acting_time [s]
  std::vector<double> steep_speed_;  ///< sliding speed at which a law is just resolved by the largest step [m/s]
  std::vector<double> steep_fall_;   ///< what that speed falls by from level to level [m/s]
  std::vector<int> slow_start_level_;  ///< of the longest step that follows the start of a slip
  std::vector<double> over_limit_;     ///< 1 / largest force of the law [1/N]
  double least_limit_ = std::numeric_limits<double>::infinity();  ///< of those there are [N]

  double begin_;
  HybridPoint point_;
  Eigen::VectorXd x_begin_, internal_begin_;
  bool any_bristle_ = false, any_elaborate_ = false;
  std::vector<bool> elaborate_;
  std::vector<OwnForce> own_forces_;
  int touched_ = -1;  ///< the contact whose guard was touched where the step begins
  double turned_at_ = std::numeric_limits<double>::quiet_NaN();  ///< when a contact at rest was last turned
  std::vector<Eigen::Index> own_at_;                             ///< index of each contact's first own state
  std::vector<Event> events_;
  std::vector<ContactMode> step_modes_;
  int coarsest_ = 0;  ///< level of the largest step that resolves the drive
  int level_ = 3, step_level_ = 0;
  bool solved_ = false;   ///< forces_ hold a solution of the step of step_level_ that began at begin_
  bool fresh_ = true;     ///< no step taken since the last event
  double newton_change_;  ///< see kNewtonShare
  int first_level_ = 0;   ///< of the last first step of a slip (one contact), with its
  RadauTables::Vector8 first_shape_ = RadauTables::Vector8::Ones();  ///< forces by the force at its start
  int stop_level_ = 0;  ///< at which the last slip was followed to its end: a step that ends inside gets no credit
  std::vector<int> start_level_;  ///< remembered first step size after an event, by number of sticking contacts

  // One step's scalars, contact after contact, eight nodes each.
  Eigen::VectorXd free_, velocity_, drive_nodes_, bristle_nodes_, free_way_, moved_, way_nodes_;
  Eigen::VectorXd forces_;  ///< a drive's after the contacts'
  Eigen::VectorXd told_;    ///< of held contacts, where states tell more of them (told_by_states_)
  std::vector<char> told_by_states_;
  Eigen::VectorXd given_speeds_;  ///< what a drive's forces and the load add to one contact's velocity

  // Of the proof: what has guards, and whether they are of laws it knows.
  bool guarded_ = false, provable_ = false, halving_proves_ = false;
  Eigen::VectorXd guard_forms_, guard_start_,
      guard_least_;                     ///< Bernstein form of each guard, its start and least [8nc]
  Eigen::VectorXd ninth_;               ///< h⁹ max |(V − v_c)⁽⁹⁾| [nc]
  std::vector<OwnMotion> own_motions_;  ///< of elaborate contacts [nc]
  std::vector<BoundedDefect> bounded_;  ///< of contacts by bounds [nc]

  /// Of each level: cos and sin of a force's harmonics at the nodes, from the step's begin on [16 x harmonics].
  std::vector<Eigen::MatrixXd> turned_;

  WorkSums work_;
  FlowStatistics statistics_;
  Eigen::MatrixXd tangents_;
};

}  // namespace slipmode::dynamics
