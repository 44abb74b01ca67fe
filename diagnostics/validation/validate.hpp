#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/diagnostics/validation/compare.hpp>
#include <slipmode/diagnostics/validation/cost.hpp>
#include <slipmode/diagnostics/validation/verdict.hpp>
#include <slipmode/pod/basis.hpp>

#include <optional>
#include <string>
#include <vector>

namespace slipmode::diagnostics {

struct ValidationOptions {
  double speed = 0.2;                    ///< belt speed of the energy-share table (the ensemble's) [m/s]
  std::vector<Eigen::Index> modes = {};  ///< L to try; empty: 1..basis size
  /// Modes are tried in their order, ascending, up to the chosen number at least, until every candidate's slip states
  /// are within three times the distance of two full runs, twice running. False: all are tried.
  bool grow = false;
  double horizon = 100.0;                 ///< of the shared-start comparison [s]
  int horizon_starts = 16;                ///< starts on the full model's attractor
  double horizon_gap = 200.0;             ///< between those starts [s]
  double start_spread = 0.1;              ///< of further starts about the given one, standard deviation [m, m/s]
  double sample = 0.1;                    ///< of the shared-start records [s]
  std::vector<double> orbit_speeds = {};  ///< belt speeds of the periodic-orbit table [m/s]
  double orbit_tolerance = 1e-8;          ///< to which orbits must have settled
  /// Starts of the full model tried at a speed until one leads to a periodic orbit: the given one, then random ones
  /// about it (start_spread). Where several motions coexist the given start alone may lead to chaos.
  int orbit_starts = 12;
  Eigen::Index orbit_samples = 2048;          ///< per period
  Eigen::Index chosen = 0;                    ///< L of sweep and cost; 0: the first candidate's L at 99 % energy
  std::vector<double> sweep_values = {};      ///< belt speeds; empty: no bifurcation diagram [m/s]
  SweepMode sweep_mode = SweepMode::kFollow;  ///< kFollow: shared initial states as in S4
  std::size_t sweep_segments = 1;
  /// For orbits; for attractors with blocks of at least a fifth of the limit, over which their mean energy, stick
  /// fraction and slip rate are then taken.
  SettleOptions settle = {};
  /// For each value of the sweep: one block of recorded motion, not audited.
  SettleOptions sweep_settle = {.limit = 5000.0, .flow = {.audit = false}};
  LyapunovOptions lyapunov = {};
  double cost_duration = 10000.0;  ///< simulated time of a timed run; 0: no timing [s]
  int cost_repeats = 5;
  /// Verdict on the full model and every candidate at `chosen` modes, from the end of the full attractor; empty: none.
  std::optional<ModelVerdictOptions> verdict = {};
  ParallelOptions parallel = {};  ///< parallel.progress counts jobs: runs, cells of the tables, swept values
  SweepSink sink = {};            ///< of the sweep
};

/// One row of the energy-share table (the form of S4 Table 3.1) for one basis.
struct ShareRow {
  Eigen::Index modes = 0;
  double energy = 0.0;                    ///< cumulative share of the ensemble [%]
  double start_error = 0.0;               ///< rms distance of the attractor to the basis, of its rms size (as dX) [%]
  Deviation horizon = {};                 ///< over the records of all shared starts; zero if the full model is at rest
  std::optional<Settled> attractor = {};  ///< what the reduced model settles to; empty where it failed
  AttractorDistance distance = {};        ///< to the full model's attractor
  /// Of the reduced model; empty when its motion is not aperiodic or it failed.
  std::optional<LyapunovExponent> lyapunov = {};
  std::string failure = {};  ///< empty, or the first failure met

  /// Aperiodic with an exponent above zero by more than four standard errors: motion without a period may as well be
  /// quasi-periodic or still decaying.
  [[nodiscard]] bool is_chaotic() const;
};

/// One cell of the periodic-orbit table (the form of S4 Table 3.2): one speed, one basis, one L.
struct OrbitRow {
  double speed = 0.0;
  Eigen::Index modes = 0;
  /// Empty where there is no orbit; comparison->same_period tells whether it is the like of the full one.
  std::optional<OrbitComparison> comparison = {};
  std::string failure = {};  ///< why there is none
};

struct CandidateReport {
  std::string name;
  std::vector<ShareRow> shares = {};  ///< by L
  std::vector<OrbitRow> orbits = {};  ///< speed by speed, within it by L
};

struct ValidationReport {
  double speed = 0.0;
  Settled full = {};                              ///< the full model at the table's speed
  AttractorDistance noise = {};                   ///< between two independent full runs: as close as full is to itself
  std::optional<LyapunovExponent> lyapunov = {};  ///< of the full model; empty when its motion is not aperiodic
  std::vector<CandidateReport> candidates = {};
  Eigen::Index left_out_above = 0;  ///< with `grow`: more modes than this were not tried; 0: all were
  Eigen::Index chosen = 0;
  std::optional<PairedSweep> sweep = {};  ///< first candidate at `chosen` modes
  std::optional<BifurcationComparison> bifurcation = {};
  double sweep_wall = 0.0;  ///< both models' sweep; values recalled from an earlier run take no time [s of clock]
  std::optional<VerdictTable> verdict = {};
  std::optional<Cost> cost = {};  ///< first candidate at `chosen` modes
  bool interrupted = false;       ///< then later parts are missing
  bool whole = true;              ///< false: values of the sweep are left to other processes, and all else with them
};

/// Full against reduced for every candidate basis, in parallel where parts are independent; timing runs alone, last.
///
/// Energy-share table at `speed`: the full model settles from `start`; each reduced model settles from the projection
/// of that end state, and both run from `horizon_starts` states of the full attractor, projected (so the initial state
/// is shared). Periodic-orbit table: the full model settles to an orbit at each speed, each reduced model from that
/// orbit's projection, so that of several attractors the like one is met. Exponents are measured from the attractors'
/// ends. Energies are audited on the attractors only. Same bytes for any number of threads, times excepted.
/// @param full   the full model; its belt speed is replaced by each speed in turn
/// @param start  initial state of the full model
/// @throws InvalidInput      for no candidates, L beyond a basis or below 1, shares missing, and what the parts refuse
/// @throws NumericalFailure  if the full model at `speed` fails; other failures are recorded in their rows
[[nodiscard]] ValidationReport validate(const dynamics::HybridSystem& full,
                                        const std::vector<pod::NamedBasis>& candidates, const dynamics::State& start,
                                        const ValidationOptions& options);

/// Numbers of modes to try of 1..most: all up to twelve, else few and growing, with `chosen` among them:
/// 1 2 3 4 6 8 12 16 24 ... most. @param chosen  1..most
[[nodiscard]] std::vector<Eigen::Index> mode_ladder(Eigen::Index most, Eigen::Index chosen);

/// What a settled motion is, in a word. Without a period it is told by its largest exponent: "aperiodic" where that is
/// above zero by more than four standard errors, "quasi-periodic" where it is zero to within them and growth at their
/// end would be less than 1 % from slip to slip, "undecided" otherwise and where none was measured: still settling,
/// a period longer than those looked for, or too short a record.
[[nodiscard]] std::string attractor_word(const Settled& settled, const std::optional<LyapunovExponent>& exponent);

}  // namespace slipmode::diagnostics
