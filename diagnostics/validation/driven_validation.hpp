#pragma once

#include <slipmode/diagnostics/attractors/driven_sweep.hpp>
#include <slipmode/diagnostics/validation/driven_compare.hpp>

#include <string>
#include <utility>
#include <vector>

namespace slipmode::diagnostics {

struct DrivenValidationOptions {
  std::vector<double> values =
      {};  ///< of the swept parameter, not empty (the drive's frequency, as the scene gives it)
  std::vector<Eigen::Index> modes = {};  ///< L to try, those that a basis has; empty: mode_ladder of the basis' size
  SweepMode mode = SweepMode::kIndependent;
  std::size_t segments = 1;
  DrivenOptions driven = {};
  Eigen::Index reading = 0;       ///< row of the readings that is compared
  double cost_parameter = 0.0;    ///< value at which times are taken (the scene's own)
  double cost_cycles = 600.0;     ///< simulated by a timed run; 0: no timing
  int cost_repeats = 5;           ///< times are medians of so many runs
  ParallelOptions parallel = {};  ///< parallel.progress counts values of all sweeps
  DrivenSink sink = {};  ///< points of all sweeps: 0 full, 1 full again, 2 … reduced, in order of candidates, L
};

/// Time of a run of cost_cycles, and of making the model able to run [s of clock].
struct DrivenCost {
  double wall = kNone, cpu = kNone;  ///< medians; NaN where nothing was timed
  double setup = kNone;              ///< projection and modal data: the first run less the median
};

/// One basis at one L.
struct DrivenRow {
  Eigen::Index modes = 0;
  std::vector<DrivenPoint> points = {};
  DrivenAgreement agreement = {};
  double trusted_share = 0.0;  ///< of the values: those where the distance is within what is trusted (see trusted_at)
  /// Longest run of trusted values, first to last; both NaN without one.
  std::pair<double, double> band = {kNone, kNone};
  std::vector<AmplitudePeak> peaks = {};
  DrivenCost cost = {};
  std::string failure = {};  ///< empty, or why there is no such model
};

struct DrivenCandidateReport {
  std::string name;
  std::vector<DrivenRow> rows = {};  ///< by L
  /// The smallest L from which on every larger one tried is trusted at 90 % of the values or more; 0: none is.
  Eigen::Index trusted_from = 0;
};

struct DrivenValidationReport {
  std::vector<DrivenPoint> full = {};
  std::vector<DrivenPoint> again = {};  ///< the full model from another start
  DrivenAgreement noise = {};           ///< between these: as close as full is to itself
  std::vector<AmplitudePeak> peaks = {};
  DrivenCost cost = {};  ///< of the full model
  std::vector<DrivenCandidateReport> candidates = {};
  double sweeps_wall = 0.0;  ///< of all sweeps; values recalled from an earlier run take no time [s of clock]
  bool interrupted = false;  ///< then later parts are missing
  bool whole = true;         ///< false: values are left to other processes, and all that is made of them
};

/// How many sweeps a validation makes of these: full, full again, and each reduced model.
[[nodiscard]] std::size_t driven_validation_sweeps(const std::vector<pod::NamedBasis>& candidates,
                                                   const DrivenValidationOptions& options);

/// Whether a reduced model is trusted at a value: its distance to the full model is at most a tenth of the reading's
/// root mean square, or twice that between two full runs, whichever is larger.
[[nodiscard]] bool trusted_at(double distance, double noise);

/// A full model against reduced ones for every candidate and L, over the swept values: section points, labels, periods,
/// peaks of the amplitude. Every sweep runs in parallel; timing runs alone, last. Same bytes for any number of threads,
/// times excepted.
/// @param full   the full model; its drive is replaced by `drive` at each value
/// @param start  of the full model; reduced ones start from its projection
/// @param other  start of the second full sweep, which shows the sampling noise
/// @throws InvalidInput  for no values or candidates, a reading that is not there, and what the parts refuse
[[nodiscard]] DrivenValidationReport validate_driven(const DrivenCase& full, const DriveAt& drive,
                                                     const std::vector<pod::NamedBasis>& candidates,
                                                     const dynamics::State& start, const dynamics::State& other,
                                                     const DrivenValidationOptions& options);

}  // namespace slipmode::diagnostics
