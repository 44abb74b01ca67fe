#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/attractors/periodicity.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::diagnostics {

/// How long to wait for a steady motion: S4's procedure for its bifurcation diagrams.
struct SettleOptions {
  double transient = 1000.0;  ///< run first, nothing kept [s]
  double block = 5000.0;      ///< then runs of this length, each judged [s]
  double limit = 100000.0;    ///< until the motion is periodic or so much time has passed, transient not counted [s]
  /// Share of the limit that is waited longer where it leaves a motion undecided and slips come often enough that there
  /// will be enough of them by then.
  double patience = 0.0;
  PeriodOptions period = {};
  int max_slips = 1000;      ///< slip states reported when the motion is not periodic: the last ones
  int energy_samples = 512;  ///< equally spaced, over a period or the last block; 0: no mean energy is taken
  dynamics::FlowOptions flow = {};
  const StopFlag* stop = nullptr;  ///< polled between blocks
};

/// The motion a start settles to.
struct Settled {
  PeriodResult period;
  std::vector<SlipState> slips;  ///< the last p ones of a periodic motion, else the last max_slips
  double stick_fraction = 0.0;   ///< share of the last block in stick, mean over contacts whose law sticks
  /// Of HybridSystem::energy, over one period of a periodic motion, else over the last block (over one more where the
  /// waiting ended before the limit); NaN without samples [J].
  double mean_energy = 0.0;
  double slip_rate = 0.0;       ///< slips of all contacts per unit of time in the last block [1/s]
  double time = 0.0;            ///< simulated in all, transient included [s]
  std::int64_t events = 0;      ///< in all
  double audit_residual = 0.0;  ///< largest energy residual of the blocks; NaN where flow.audit is off
  dynamics::State end;          ///< state at the end of the last block
};

/// Runs `start`, handed on, until it is seen to be periodic, stuck or sliding for a whole block, or the limit is
/// reached. A period in doubt (PeriodResult::doubt) is waited for as well. Slips of earlier blocks are kept while they
/// may help to see a long period (as at very low belt speed).
/// @throws InvalidInput      for block ≤ 0, transient < 0, limit < block, patience < 0, and as simulate
/// @throws NumericalFailure  as simulate
/// @throws Interrupted       if the stop flag was set
[[nodiscard]] Settled settle(const dynamics::HybridSystem& system, const dynamics::State& start,
                             const SettleOptions& options = {});

/// A periodic orbit met by waiting, from one of its slip states.
struct Orbit {
  int period = 0;                            ///< slips per period
  double T = 0.0;                            ///< [s]
  std::vector<dynamics::State> states = {};  ///< full state at each of its `period` slips of the section contact
  std::vector<double> displacements = {};    ///< contact displacement at each of them [m]
  double mismatch = 0.0;                     ///< largest |state after T − state| over the period's slips, relative
};

/// Runs until periodic with settling.period.tolerance (choose a tight one, 1e-9) and takes one period's slip states.
/// No energy is audited or averaged: an orbit has room for neither.
/// @throws NumericalFailure  if the motion is not periodic within the limit, saying what it was instead
[[nodiscard]] Orbit settle_to_orbit(const dynamics::HybridSystem& system, const dynamics::State& start,
                                    const SettleOptions& settling);

}  // namespace slipmode::diagnostics
