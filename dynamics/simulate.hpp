#pragma once

#include <slipmode/dynamics/system.hpp>

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace slipmode::dynamics {

enum class EventKind : std::uint8_t {
  kStick,        ///< slip ends, the contact sticks
  kRelease,      ///< stick ends at |λ| = μ_s N
  kReversal,     ///< v_rel passes through zero without sticking
  kGrazing,      ///< v_rel (or the stick force) touched its limit within tolerance; the mode did not change
  kDriveCorner,  ///< the drive's acceleration jumped; contact is -1
  kSeparation,   ///< contact lost: the normal load, or a stop's force or its way past the gap, fell to zero
  kContact,      ///< contact gained: the normal load rose from zero, or a stop was reached
  kJump,         ///< behind a contact spring: the contact point slipped from μ_s N to μ_k N and sticks again
};

/// An event belongs to the half-open window (t0, t1]; after it the state lies on the guard to rounding, of the
/// time's too where it turns under a shaker.
struct Event {
  double time = 0.0;
  int contact = -1;
  EventKind kind = EventKind::kStick;
  ContactMode before = ContactMode::kStick;
  ContactMode after = ContactMode::kStick;
  double displacement = 0.0;  ///< contact displacement wᵀq + offset [m]
  double velocity = 0.0;      ///< wᵀq̇ [m/s]
  double force = 0.0;         ///< λ just after the event [N]
};

/// Which flow advances the state.
enum class FlowMethod {
  kAutomatic,    ///< closed form when every law is piecewise linear and n is small, collocation otherwise
  kClosedForm,   ///< exact modal solution in each regime, guaranteed event isolation; piecewise-linear laws only
  kCollocation,  ///< scalar Volterra collocation of the contact forces, error-controlled; any law
};

/// Energy bookkeeping of a run: E_end − E_start = contact_work + force_work − viscous_loss, with
/// contact_work = drive_work − friction_loss.
struct EnergyAudit {
  double energy_start = 0.0;
  double energy_end = 0.0;
  double contact_work = 0.0;  ///< ∫ Σ λ wᵀq̇ dt, done on the structure [J]
  double drive_work = 0.0;    ///< ∫ Σ λ v_drive dt [J]
  /// ∫ Σ λ v_rel dt [J]: what friction dissipates and what contact springs and bristles store more than at the start,
  /// ½ Σ K_c (y_c − y)² and ½ Σ σ₀ z², or stops ½ Σ k (|y| − b)². Rigid and tanh laws store nothing: ≥ 0. It can be < 0
  /// after a deflected start.
  double friction_loss = 0.0;
  /// ∫ Σ u_k d_kᵀq̇ dt, done by a force drive [J].
  double force_work = 0.0;
  double viscous_loss = 0.0;  ///< ∫ q̇ᵀC q̇ dt ≥ 0 [J]
  /// Scale: |contact work| summed over steps + viscous loss + largest energy seen, stored or with constant loads', and
  /// at both ends stored in contacts [J]
  double exchanged = 0.0;
  /// (E_end − E_start − contact_work − force_work + viscous_loss) / exchanged
  [[nodiscard]] double residual() const;
};

struct FlowOptions {
  FlowMethod method = FlowMethod::kAutomatic;
  /// Collocation: bound on the error of one step's contact impulse, as a share of the law's largest force times how
  /// long it acts: four radians of the fastest mode or of the drive, whichever is less.
  double tolerance = 1e-9;
  bool audit = true;  ///< integrate the energy balance along
  /// Prove step by step that no event is passed, see FlowStatistics::certified. The closed form always does.
  bool certify = false;
  int max_events_per_window = 200;  ///< more events than this within `zeno_window` is reported as Zeno
  /// [s]; 0: one hundredth of the shortest natural period, of contacts on their own springs and stops too; without any,
  /// 1e-12 of the time
  double zeno_window = 0.0;
};

/// What a run counted; costs and reports are made of these.
struct FlowStatistics {
  std::int64_t steps = 0;
  std::int64_t rejected = 0;
  /// Steps in which it is proved that the true motion from the step's start passes no event but the one located at its
  /// end, if any. Not: grazings; steps of laws nothing is known of between speeds (characteristics).
  std::int64_t certified = 0;
  std::int64_t events = 0;
  int regimes_built = 0;
  std::vector<double> stick_time;  ///< per contact [s]
};

/// Called at every event while simulating, with a state to go on from; return false to stop the run there.
using EventCallback = std::function<bool(const Event&, const State&)>;

struct SimulateOptions {
  double duration = 0.0;   ///< simulated time after `state.time` [s]
  double transient = 0.0;  ///< events and samples before start + transient are not kept [s]
  double sample = 0.0;     ///< sampling interval; 0: no samples [s]
  bool keep_events = true;
  bool event_states = false;  ///< also keep the full state at each kept event (columns of event_q, event_v)
  /// What samples hold. With kContacts on a long chain no mode shapes are ever formed.
  enum class Output { kAllDofs, kContacts } output = Output::kAllDofs;
  FlowOptions flow = {};
  EventCallback on_event = {};
};

/// The result of a run. Column k of q, v, lambda belongs to times[k] = start + transient + k·sample.
struct Trajectory {
  std::vector<Event> events;
  Eigen::VectorXd times;                         ///< [T]
  Eigen::MatrixXd q, v;                          ///< n x T (kAllDofs)
  Eigen::MatrixXd contact_q, contact_v, lambda;  ///< nc x T: wᵀq + offset, wᵀq̇, contact forces
  Eigen::MatrixXd event_q, event_v;              ///< n x events, if asked
  /// To go on from: contacts that stick move with the belt to rounding. Empty q, v with kContacts on a long chain.
  State final_state;
  EnergyAudit audit;
  FlowStatistics statistics;
};

/// Advances `start` by options.duration.
/// @throws InvalidInput      for sizes, negative durations, a start that violates its own modes, kClosedForm with a law
///                           that is not piecewise linear
/// @throws NumericalFailure  with time and state (q, q̇): Zeno, no convergence of the collocation, values not finite
[[nodiscard]] Trajectory simulate(const HybridSystem& system, const State& start, const SimulateOptions& options);

/// A state handed on to a run of its own: of another system with the same contacts, at another value, or from the start
/// of the drive's cycle again. Modes are derived anew, as the old ones need not hold, but for contacts behind a spring:
/// there sliding at μ_k N is not told from sticking by position, velocity and stretch. To go on within a run, take its
/// final_state as it is.
[[nodiscard]] State handed_on(const HybridSystem& system, const State& state, double time = 0.0);

/// The flow over [start, start + duration] with its fundamental matrix, saltation at every event included.
///
/// Coordinates of the tangents are (q, q̇, internal), internal as State::internal, N = 2n + internal_size.
struct TangentResult {
  State end;
  Eigen::MatrixXd monodromy;  ///< d(end)/d(start) at fixed duration [N x N]
  /// d(q, q̇, internal)/dt at the end, after an event there [N]: what one more instant of duration adds.
  Eigen::VectorXd rate;
  std::vector<Event> events;
};

/// Tangents to carry along a run, one per column: what changes of its start and of the forces on it.
struct Tangents {
  Eigen::MatrixXd start;  ///< (q, q̇, internal) [N x k]
  /// Along the system's force directions, direction after direction: a constant, then the coefficients of cos jωt,
  /// j = 1 … H, then of sin jωt, ω that of its force drive [nk (2H + 1) x k]. No rows: forces stay.
  Eigen::MatrixXd forces = {};
};

/// Called with the state at a time that was asked for, and the tangents there [N x k].
using TangentSample = std::function<void(const State&, const Eigen::MatrixXd&)>;

/// Runs the tangent flow again and again on one system, as shooting does: what a run has prepared serves the next.
/// Not for several threads at once; copies of the system are.
class TangentFlow {
 public:
  /// @throws InvalidInput  as `simulate`
  explicit TangentFlow(const HybridSystem& system, const FlowOptions& options = {.audit = false});
  TangentFlow(TangentFlow&&) noexcept;
  TangentFlow& operator=(TangentFlow&&) noexcept;
  ~TangentFlow();

  /// Carries all N tangents. Entering stick projects out one direction (rank drops by one).
  [[nodiscard]] TangentResult run(const State& start, double duration);
  /// Carries these alone: `monodromy` is what they have become [N x k].
  /// @param times   in order, within the run; `sample` is called at each
  /// @throws InvalidInput  for tangents of wrong size; of forces, for a system without a force drive; for other times
  [[nodiscard]] TangentResult run(const State& start, double duration, const Tangents& tangents,
                                  const std::vector<double>& times = {}, const TangentSample& sample = {});

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// One run of a TangentFlow.
[[nodiscard]] TangentResult tangent_flow(const HybridSystem& system, const State& start, double duration,
                                         const FlowOptions& options = {});

}  // namespace slipmode::dynamics
