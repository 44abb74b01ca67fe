#pragma once

#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/event_resolver.hpp>
#include "dynamics/internal/belt_work.hpp"
#include "dynamics/internal/bernstein.hpp"
#include "dynamics/internal/drive_cache.hpp"

#include <Eigen/Core>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

namespace slipmode::dynamics {

/// Of a regime's state, in the scales in which free motion does not grow.
[[nodiscard]] double squared_size(const Regime& r, const Eigen::VectorXd& x);

/// The flow of a piecewise-linear system in closed form: within a regime every state is an exact modal solution, and a
/// window is passed only when its guards are proved positive on all of it. The proof: the guard's interpolant of degree
/// 7 in Bernstein form (convex hull), less a bound on what interpolation leaves out, from the amplitudes of the pairs.
/// Theory: docs/theory/flow.md.
///
/// A step ends at the time asked, at the end of a window, or at an event. The last step stays readable (`evaluate`)
/// until the next one.
class ClosedFormFlow {
 public:
  /// @param start  its modes may be undecided where a contact is at rest on the belt; laws must be piecewise linear
  ClosedFormFlow(const HybridSystem& system, HybridPoint start, const FlowOptions& options);

  /// Starts anew from another point; regimes met so far stay prepared. Drops the tangents.
  void restart(HybridPoint start);

  /// Carries tangents along from here, saltation included. Coordinates: the slipping model's state without padding
  /// (first components, then second ones), then the contacts' own states. @param tangents  [2n + internal_size x k]
  /// @param forces  what they change of a force drive, as Tangents::forces; no rows: nothing
  void set_tangents(Eigen::MatrixXd tangents, Eigen::MatrixXd forces = {});
  /// They, at `point().time` (brought up to date at events and at the time asked).
  [[nodiscard]] const Eigen::MatrixXd& tangents();
  /// d/dt of the point in the same coordinates, right limit [2n + internal_size].
  [[nodiscard]] const Eigen::VectorXd& point_rate();

  /// Advances by one step, not beyond t_limit (> time). True if it ended at an event.
  bool step(double t_limit);

  /// `x` and `force` are brought up to date at events and at the time asked, `time` and `modes` always.
  [[nodiscard]] const HybridPoint& point() const { return point_; }
  /// Of the last step; before the first, of the start.
  [[nodiscard]] const std::vector<Event>& events() const { return resolver_.events(); }
  [[nodiscard]] const TurnAtStart& turn_at_start() const { return resolver_.turn_at_start(); }
  [[nodiscard]] const WorkSums& work() const { return work_; }
  [[nodiscard]] const FlowStatistics& statistics() const { return statistics_; }

  /// State and contact forces at a time within the last step.
  void evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const;

 private:
  /// constant + sign · output ≥ 0 as long as the regime lasts.
  struct Guard {
    Eigen::Index output = 0;
    int contact = 0;
    double sign = 1.0, constant = 0.0;
    GuardKind kind = GuardKind::kFriction;
    ContactMode next = ContactMode::kStick;  ///< of a clearance, once the guard is crossed
    double exempt_until = -1e300;            ///< known to be clear up to this time
    bool at_once = false;                    ///< falls from zero, from rest: a motion that starts on a stop
  };
  /// What tangents need of a regime, without padding.
  struct TangentMaps {
    std::vector<int> follows;              ///< contacts that follow the drive
    Eigen::MatrixXd enter, enter_follows;  ///< tangents → of x [2m x N], of the inputs of those contacts [nf x N]
    Eigen::MatrixXd leave, leave_inputs;   ///< back: of x [N x 2m], of all inputs [N x ni]
    Eigen::MatrixXd row;                   ///< of the outputs [2m x no]
    Eigen::MatrixXd B;                     ///< [2m x ni]
    /// What the regime answers to a cosine of each order along a force direction, one per direction: of x [2m x H], of
    /// the outputs [no x H].
    std::vector<DriveOverlay::Amplitudes> forced_state{}, forced_outputs{};
    std::vector<std::vector<DriveOverlay::Resonance>> forced_resonances{};
  };
  /// What tangents change of the forces at an instant: coefficients of the answers' cosines and sines, direction after
  /// direction [nk H x k], and the forces themselves [nk x k].
  struct ForceChange {
    Eigen::MatrixXd cosine, sine, value;
  };
  /// A regime met in this run.
  struct Visited {
    std::vector<ContactRole> roles;
    const RegimeTables* tables;
    const DriveOverlay* overlay = nullptr;  ///< null for a belt
    const DriveOverlay* steady = nullptr;   ///< of a motion that has just begun: the overlay of what it becomes
    double entered = 0.0;                   ///< when last,
    Eigen::VectorXd x_entered{};            ///< under an overlay: its state then, the steady response included,
    Eigen::VectorXd inputs_entered{};       ///< and inputs, of contacts with the drive's
    const AuditForms* forms = nullptr;      ///< for a shaker or a force; null where the audit integrates by quadrature
    std::unique_ptr<BeltWork> belt;         ///< for a belt, while its speed is constant; the same
    std::unique_ptr<TangentMaps> maps;      ///< null until tangents are carried
  };
  /// A root is found in a window to better than this share of it.
  static constexpr double kRootLeaves = 1e-5;
  /// What a search of one window found.
  struct Search {
    int guard = -1;         ///< which may vanish first; −1: none in this window
    double at = 1.0;        ///< fraction of the window before which no guard vanishes
    bool resolved = false;  ///< nothing is left out that matters: `at` is the event
    bool touching = false;  ///< resolved: the guard comes within tolerance of zero and goes back
    double others = 2.0;    ///< no other guard vanishes before this
    double guess = 0.0;     ///< where the guard vanishes in all likelihood; 0: not in this window
    int refinement = 1;     ///< not resolved: levels to go down until it is
    double spare = 1e300;   ///< smallest ratio of a guard's least value to its remainder
  };
  /// A guard's value and derivatives.
  struct GuardValue {
    double value = 0.0, rate = 0.0;
  };

  /// What a guard's values are measured by.
  struct GuardSize {
    double own = 0.0;        ///< of its terms
    double cancelled = 0.0;  ///< in the same units, of a stop's: parts of its place that cancel
    /// What it rounds by.
    [[nodiscard]] double told() const { return own + cancelled; }
    /// Values below may be zero where a regime begins, and derivatives, in radians of the fastest pair.
    [[nodiscard]] double starting() const;
  };

  /// An output for as long as a stay lasts, where free motion does not grow and the inputs rest: within `reach` of
  /// where they hold it.
  struct Swing {
    double held = 0.0, reach = std::numeric_limits<double>::infinity();
  };

  /// A guard at the point, with bounds on its second and third derivative: for as long as the fastest pair takes, or
  /// for good where they are `lasting`; and on itself for good.
  struct GuardStart {
    double value = 0.0, rate = 0.0, second = 0.0, most = 0.0, most_second = 0.0, most_third = 0.0;
    GuardSize size;
    bool lasting = false;
  };

  void enter_regime();
  /// The regime of these roles, made when first met. @param steady  see Visited
  [[nodiscard]] Visited& visit(const std::vector<ContactRole>& roles, const DriveOverlay* steady = nullptr);
  /// Whether a state that holds all there is, is next to none beside the steady response to forces.
  [[nodiscard]] bool has_just_begun(const DriveOverlay& steady, const Eigen::VectorXd& whole) const;
  /// Whether what had just begun no longer has.
  [[nodiscard]] bool has_grown() const;
  /// Moves the ends of contact springs, among the inputs, to where the regime's own rows find the forces that they
  /// have: its coordinates round otherwise than those of the slipping structure, and each return to them would stretch
  /// a spring anew. @param beside  the drive, where x and the inputs are beside its steady response
  void hold_springs(const Eigen::VectorXd& x, const DriveOverlay* beside, Eigen::VectorXd& inputs) const;
  /// A run, from a point whose modes are not decided yet.
  void begin();
  /// What the step that begins at the point begins with: it is readable from here on.
  void begin_step();
  void set_guards();
  void add_clearance_guards(const Guard& guard, RegimeOutput::Kind kind);
  /// What moves freely, and bounds on it.
  void measure_amplitudes();
  /// Drops guards that cannot vanish in this stay.
  void drop_idle_guards();
  /// Takes the state, which is that of the step's begin, on by tau.
  void move(double tau);
  /// The same of a state that has been moved.
  void move_from_begin(double tau);
  /// The same of the last step's begin, whose state, free part and inputs are given.
  void move(const Visited& in, double tau, const Eigen::VectorXd& free, Eigen::VectorXd& x,
            Eigen::VectorXd& inputs) const;
  /// The same over a whole window of the level.
  void pass_window();
  /// Pairs that do not oscillate go by tables, each time from where they are, and so do all of a motion held whole.
  /// Others go by what has moved freely and by the ways, so that what a stiff spring holds together rounds alike.
  [[nodiscard]] bool needs_tables(const Regime& r) const { return whole_ || !r.motion.available(); }
  /// Of those, where tables have led.
  void take_tables(const Regime& r, Eigen::VectorXd& out_x) const;
  /// Windows follow from the state, which is that of t.
  void begin_windows(double t);
  /// Inputs that vary, a time tau after these, and x with them, which is what has moved freely by then.
  void follow_inputs(const Visited& in, const Eigen::VectorXd& from, double tau, Eigen::VectorXd& x,
                     Eigen::VectorXd& out_inputs) const;
  void foresee_starts();
  [[nodiscard]] Swing swing_of(const Guard& guard) const;
  [[nodiscard]] GuardStart start_of(const Guard& guard) const;
  /// At the end of guards' exemptions: whether they have left zero.
  void look_again();
  /// How long, by bounds, a guard stays so near to zero that it cannot be told from it.
  [[nodiscard]] double near_zero(const GuardStart& guard) const;
  [[nodiscard]] GuardSize size_of(const Guard& guard) const;
  /// The size of an output's values, which its rounding error is measured by.
  [[nodiscard]] double scale(const Guard& guard) const;
  /// Of that what moves: by the terms that are summed, not by amplitudes, as a slow drift has a large one, however
  /// little it has moved. What has moved may be a small difference of free motion and what the inputs have moved.
  [[nodiscard]] double moving_size(const Guard& guard) const;
  /// See GuardSize.
  [[nodiscard]] double cancelled(const Guard& guard) const;
  /// What moves of a stop's guard, as it was where an earlier stay ended, for as long as the fastest pair takes: the
  /// state still has the rounding of what moved then.
  struct Recall {
    double time = -std::numeric_limits<double>::infinity();
    double size = 0.0;  ///< of the contact's place [m]
  };
  [[nodiscard]] double recalled(const Guard& guard) const;
  /// A guard's value over the contact's place: 1, or the stop's stiffness.
  [[nodiscard]] double per_place(const Guard& guard) const;
  /// At the end of a stay.
  void recall_sizes();
  [[nodiscard]] GuardValue evaluate(const Guard& guard, double t) const;
  [[nodiscard]] double second_derivative(const Guard& guard, double t) const;
  [[nodiscard]] Search search(int level) const;
  /// That of a guard without a bound at this level.
  /// @throws NumericalFailure  at the finest one
  [[nodiscard]] Search unknown(int guard, int level) const;
  void judge(const BernsteinPolynomial& polynomial, double remainder, double tolerance, int guard, Search& found) const;
  /// Takes the state on to where the guard vanishes, near tau, which follows; where that is no root, or that of a
  /// window which has one at tau is another, tau stays. True if the root is proved to be the first after `from`.
  [[nodiscard]] bool approach(const Guard& guard, double from, double& tau);
  /// Whether one of the guards that the window has vanish about there too does so before, by their exact values: the
  /// first of them is taken, and the state to where it vanishes.
  [[nodiscard]] bool take_earlier(Search& found, double from, double& root);
  /// A harmonic drives a pair at its own frequency, or next to it.
  [[nodiscard]] bool swells() const { return regime_->overlay && !regime_->overlay->resonances.empty(); }
  /// The most that pairs of these weights add up to within a time h, but for what free motion grows by.
  [[nodiscard]] double most(const Eigen::Ref<const Eigen::VectorXd>& weight, double h) const;
  /// Bound on the second derivative of an output over the window.
  [[nodiscard]] double curvature(Eigen::Index output) const;
  /// Adds the work of a step of this length; where forms integrate whole stays, once a stay or the run `ends`.
  void account(double tau, bool ends);
  /// Whether forms integrate this stay. A belt changes speed at corners only, where a stay begins.
  [[nodiscard]] bool has_forms() const {
    return regime_->forms || (regime_->belt && inputs_(tables_->regime().speed_input() + 1) == 0.0);
  }
  /// Up to the point and its state.
  void mark_accounted();
  /// Work of a time tau from a state on, by quadrature.
  /// @param x_free  what moves freely of x
  [[nodiscard]] StayWork integrate(double t, Eigen::VectorXd x, const Eigen::VectorXd& x_free, Eigen::VectorXd inputs,
                                   double tau) const;
  /// Under an overlay: whether x and the steady response at t, each far larger than their sum, leave it few digits. The
  /// sum is then made `anew`: from where the stay began, with what the drive alone has moved since.
  [[nodiscard]] bool cancels(const Visited& in, double t, const Eigen::VectorXd& x) const;
  /// Whether that is so of this regime from t to the point, within a radian of the drive.
  [[nodiscard]] bool little_left(double t, const Eigen::VectorXd& x) const;
  /// The state of a regime, the steady response included, and its inputs, the drive's part included.
  void anew(const Visited& in, double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_inputs) const;
  /// State of the slipping model and contact forces at t, from the regime's.
  void lift(const Visited& in, double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
            Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const;
  /// The same of states and inputs that hold all there is, or of those beside the steady response.
  void lift_sum(const Visited& in, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs, Eigen::VectorXd& out_x,
                Eigen::VectorXd& out_force) const;
  /// State and forces into `point_`, contacts' own states included.
  void lift_point();
  [[nodiscard]] bool settle(int guard, bool touching);
  /// Makes the maps of the regime entered, if tangents are carried.
  void enter_tangents();
  /// Brings the tangents up to the point's time, within a stay.
  void push_tangents();
  /// What changed forces move resonant pairs.
  void push_resonances(double begin, double tau);
  /// δ⁺ = R δ⁻ + (f⁺ − R f⁻) δg/ġ: before and after the event is settled. No guard: a corner of the drive, whose time
  /// is nobody's.
  void leave_tangents(const Guard* guard);
  void salt_tangents();
  void prepare_forced(TangentMaps& out_maps) const;
  [[nodiscard]] ForceChange force_change(double t) const;
  /// Adds what the changed forces alone make of these rows, steadily. @param answers  one per direction
  static void add_forced(const std::vector<DriveOverlay::Amplitudes>& answers, const ForceChange& change, double factor,
                         Eigen::MatrixXd& out_rows);
  /// The phase of a periodic drive, remembered: several are asked at an event.
  [[nodiscard]] DrivePhase phase_at(double t) const {
    if (t != phase_time_) {
      phase_then_ = regime_->overlay->phase(t);
      phase_time_ = t;
    }
    return phase_then_;
  }
  [[nodiscard]] double drive_velocity(double t, const Eigen::VectorXd& inputs) const;

  const HybridSystem& system_;
  const ModalModel& slipping_;
  EventResolver resolver_;
  FlowOptions options_;
  int nc_;
  double slipping_rate_;  ///< of the slipping structure, or of the drive if that is faster [1/s]
  HybridPoint point_;

  Visited* regime_ = nullptr;
  const RegimeTables* tables_ = nullptr;  ///< its tables
  double fastest_ = 0.0;                  ///< rate of the regime, or of the drive if that is faster [1/s]
  const Visited* step_regime_ = nullptr;  ///< that of the last step
  std::vector<Guard> guards_;
  std::vector<Eigen::Index> oscillator_states_;  ///< in HybridPoint::internal
  std::vector<int> compliant_;                   ///< contacts behind a contact spring
  Eigen::VectorXd x_, inputs_, x_begin_, inputs_begin_;
  Eigen::VectorXd free_, amplitude_;  ///< at the step's begin: x less what follows the inputs, and its pairs' sizes
  Eigen::VectorXd free_begin_;        ///< that of x_begin_
  Eigen::VectorXd free_entered_;      ///< that of the state in which the regime was entered
  Eigen::VectorXd resting_;           ///< what follows the inputs, where those are constant: under a periodic drive
  /// Where free_ was told from x_ last, and what it has moved over whole windows since. What a window adds to the
  /// inputs, and to the places that follow them, rounds to one side, and of those that a stiff spring holds together
  /// the difference has a force: ways are by the clock, and places by these.
  struct {
    double time = 0.0;
    Eigen::VectorXd x{}, inputs{}, moved{};
  } windows_from_;
  /// The last step's motion is held whole: on a belt, next to none as yet beside what moves freely and what follows the
  /// inputs, whose sum it is.
  bool whole_ = false;
  bool measured_ = false;       ///< free_ and amplitude_ belong to x_
  std::vector<Recall> recall_;  ///< of each contact
  double begin_ = 0.0;
  DrivePhase phase_;  ///< at begin_, of a periodic drive
  /// Worked in: samples are asked for by the thousand.
  mutable Eigen::VectorXd x_then_, inputs_then_, sum_, by_tables_;
  mutable double phase_time_ = std::numeric_limits<double>::quiet_NaN();
  mutable DrivePhase phase_then_;
  int level_ = 0;

  /// At `point_.time` between stays; within a stay, of x and of the inputs that follow.
  Eigen::MatrixXd tangents_, x_tangents_, follow_tangents_, follow_response_;
  Eigen::MatrixXd force_tangents_;  ///< as Tangents::forces; what x_tangents_ has is beside the steady answer to them
  bool carries_ = false;            ///< tangents are carried, be they none
  bool tangents_current_ = false;   ///< tangents_ belongs to point_
  Eigen::VectorXd rate_, rate_before_, x_rate_, input_rate_;
  Eigen::RowVectorXd delay_;  ///< δg/ġ
  std::vector<ContactMode> modes_before_;
  double tangent_time_ = 0.0;

  AuditForms::Stay stay_;
  double accounted_ = 0.0;                                           ///< where forms integrate: up to here,
  Eigen::VectorXd x_accounted_, free_accounted_, inputs_accounted_;  ///< and from there
  WorkSums work_;
  bool blind_start_ = false;  ///< a guard starts at zero, and no bound says that it rises
  FlowStatistics statistics_;
  std::deque<Visited> visited_;
};

}  // namespace slipmode::dynamics
