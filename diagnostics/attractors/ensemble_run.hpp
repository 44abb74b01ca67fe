#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/diagnostics/model.hpp>
#include <slipmode/pod/ensemble.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace slipmode::diagnostics {

/// Random initial states about a centre: every q_i and v_i gets `spread` times a standard normal number.
struct RandomStateOptions {
  Eigen::Index count = 1;
  double spread = 0.1;     ///< standard deviation, ≥ 0 [m and m/s]
  std::uint64_t seed = 1;  ///< state k draws from Random::stream(seed, k): first q_1..q_n, then v_1..v_n
  enum class Centre { kEquilibrium, kRest } centre = Centre::kEquilibrium;
};

/// @throws InvalidInput  for count < 1, a negative or non-finite spread, and as sliding_equilibrium for kEquilibrium
[[nodiscard]] std::vector<dynamics::State> random_states(const dynamics::HybridSystem& system,
                                                         const RandomStateOptions& options);

/// What one run of an ensemble did.
struct EnsembleMember {
  double parameter = 0.0;
  Eigen::Index start = 0;    ///< which of the initial states
  Eigen::Index columns = 0;  ///< snapshots it gave; 0 if it failed
  dynamics::EnergyAudit audit = {};
  dynamics::FlowStatistics statistics = {};
  std::string failure = {};  ///< empty, or why it failed
};

/// One run, as a sink keeps it: SweptValue::index is its place among the members, and says which start.
struct MemberRun {
  Eigen::MatrixXd snapshots;  ///< n x T
  dynamics::EnergyAudit audit = {};
  dynamics::FlowStatistics statistics = {};
};
using EnsembleSink = SinkOf<MemberRun>;

struct EnsembleOptions {
  double duration = 20000.0;  ///< length of each run, transient included [s]
  double transient = 1000.0;  ///< dropped at the start of each run [s]
  double sample = 0.5;        ///< snapshot interval, > 0 [s]
  dynamics::FlowOptions flow = {};
  ParallelOptions parallel = {};
  /// Only this part of I/N of the members is run, those numbered M (I − 1)/N … M I/N − 1 of M, and may fail as a whole;
  /// I from 1 to N.
  std::size_t part = 1, parts = 1;
  int model = 0;           ///< SweptValue::model of the members: tells apart ensembles that share a sink
  EnsembleSink sink = {};  ///< of a study that is resumed, or shared with other processes; not of a part
};

struct EnsembleRun {
  pod::Ensemble ensemble;               ///< n x T, member after member
  std::vector<EnsembleMember> members;  ///< parameter by parameter, within it start by start

  /// The one with the largest energy residual of the members that went well; null where none did.
  [[nodiscard]] const EnsembleMember* worst() const;
  /// That residual; 0 where there is none.
  [[nodiscard]] double worst_audit() const;
  /// What these counted together; no stick times.
  [[nodiscard]] dynamics::FlowStatistics total() const;
};

/// Ends with what an ensemble ends with of which every member failed. @param first  why the first did
/// @throws NumericalFailure
[[noreturn]] void fail_all(const std::string& first);

/// Runs every initial state at every parameter value and concatenates the snapshots.
///
/// A member that fails (NumericalFailure) is recorded and gives no snapshots. Same bytes for any number of threads.
/// Members that the sink leaves to other processes, and does not know afterwards, are not among the result's.
/// @throws InvalidInput      for no starts or parameters, sample ≤ 0, transient outside [0, duration), part outside 1 …
/// parts
/// @throws NumericalFailure  if every member failed (the first one's), unless some were left to others
/// @throws Interrupted       if the stop flag was set
[[nodiscard]] EnsembleRun run_ensemble(const Model& model, const std::vector<double>& parameters,
                                       const std::vector<dynamics::State>& starts, const EnsembleOptions& options);

}  // namespace slipmode::diagnostics
