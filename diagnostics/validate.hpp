#pragma once

#include "core/parallel.hpp"
#include "diagnostics/compare.hpp"
#include "diagnostics/lyapunov.hpp"
#include "diagnostics/sweep.hpp"
#include "pod/basis.hpp"
#include "pod/ensemble.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::diagnostics {

/// A basis to be judged, with as many vectors as shall be tried.
struct Candidate {
  std::string name;  ///< "POM", "LNM"
  pod::Basis basis;
  Eigen::VectorXd
      captured;  ///< cumulative energy share of its first L vectors [≥ modes tried]; see pod::captured_energy
};

struct ValidationOptions {
  double speed = 0.2;                     ///< belt speed of the energy-share table (the ensemble's)
  std::vector<Eigen::Index> modes = {};   ///< L to try; empty: 1..basis size
  double horizon = 100.0;                 ///< of the shared-start comparison [s]
  int horizon_starts = 16;                ///< starts on the attractor, averaged
  double horizon_sample = 0.1;            ///< [s]
  std::vector<double> orbit_speeds = {};  ///< belt speeds of the periodic-orbit table
  double orbit_tolerance = 1e-8;          ///< to which orbits must have settled
  Eigen::Index chosen = 0;  ///< L of the bifurcation diagram and of the cost; 0: the first basis at 99 % energy
  std::vector<double> sweep_values = {};  ///< empty: no bifurcation diagram
  std::size_t sweep_segments = 1;
  SettleOptions settle = {};  ///< for attractors and the sweep
  LyapunovOptions lyapunov = {};
  double cost_duration = 10000.0;  ///< simulated time of the timed run; 0: no timing [s]
  int cost_repeats = 5;
  ParallelOptions parallel = {};  ///< parallel.progress counts the parts of the work
  SweepSink sink = {};            ///< for the paired sweep
};

/// One row of the energy-share table (the form of S4 Table 3.1) for one basis.
struct ShareRow {
  Eigen::Index modes = 0;
  double energy = 0.0;               ///< cumulative share of the ensemble [%]
  Deviation horizon;                 ///< from shared starts on the full attractor, root mean square over the starts
  double start_error = 0.0;          ///< part of dX there already at time 0: what the basis cannot represent [%]
  std::optional<Settled> attractor;  ///< motion the reduced model settles to at the table's speed
  AttractorDistance distance;        ///< to the full model's attractor
  LyapunovExponent lyapunov;         ///< of the reduced model; zero fields if its motion is periodic
  std::string failure = {};
};

/// One cell of the periodic-orbit table (the form of S4 Table 3.2): one speed, one basis, one L.
struct OrbitRow {
  double speed = 0.0;
  Eigen::Index modes = 0;
  std::optional<OrbitComparison> comparison;
  std::string failure = {};  ///< why there is none: no periodic motion, another period, a numerical failure
};

struct CandidateReport {
  std::string name;
  std::vector<ShareRow> shares;  ///< by L
  std::vector<OrbitRow> orbits;  ///< by speed, then L
};

/// Time of one run of the same duration, full and reduced, in this process.
struct Cost {
  double duration = 0.0;                         ///< simulated [s]
  double full_wall = 0.0, full_cpu = 0.0;        ///< median of the repeats [s of clock]
  double reduced_wall = 0.0, reduced_cpu = 0.0;  ///< median of the repeats [s of clock]
  double projection_wall = 0.0;                  ///< of rom::reduce [s of clock]
  /// Runs after which ensemble + basis + projection are paid for, given the cost of making the basis;
  /// infinite when the reduced model is not faster.
  [[nodiscard]] double break_even(double basis_wall) const;
};

struct ValidationReport {
  double speed = 0.0;
  Settled full;               ///< the full model at the table's speed
  AttractorDistance noise;    ///< between two independent full runs: as close as full is to itself
  LyapunovExponent lyapunov;  ///< of the full model
  std::vector<CandidateReport> candidates;
  Eigen::Index chosen = 0;
  std::optional<PairedSweep> sweep;  ///< first candidate at `chosen` modes
  std::optional<BifurcationComparison> bifurcation;
  std::optional<Cost> cost;
  bool interrupted = false;  ///< then some parts are missing
};

/// Full against reduced for every candidate basis, in parallel where parts are independent.
/// @param full    the full model; its drive's speed is replaced by each speed in turn
/// @param start   initial state of the full model
/// @throws InvalidInput  for no candidates, bases of the wrong size, L beyond a basis
[[nodiscard]] ValidationReport validate(const dynamics::HybridSystem& full, const std::vector<Candidate>& candidates,
                                        const dynamics::State& start, const ValidationOptions& options);

/// Median wall and CPU time of simulating `duration` without output.
[[nodiscard]] Cost measure_cost(const dynamics::HybridSystem& full, const pod::Basis& basis,
                                const dynamics::State& start, double duration, int repeats,
                                const dynamics::FlowOptions& flow = {});

}  // namespace slipmode::diagnostics
