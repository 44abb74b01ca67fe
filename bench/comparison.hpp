#pragma once

#include "bench/chain_problem.hpp"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace slipmode::bench {

/// One row of the main table: what is run, for how long, and how much faster than each peer it should be.
struct ComparisonCase {
  ChainProblem problem;
  double transient = 2000.0;   ///< from rest to the attractor, by slipmode
  double duration = 1e4;       ///< timed stretch
  double peer_duration = 1e4;  ///< peers' part of it, from its beginning
  double stretch = 100.0;      ///< length of the stretches on which errors are taken: short enough against 1/λ_1
  int stretches = 16;
  double wanted_cvode = 0.0, wanted_odeint = 0.0;  ///< ratios asked for with these kernels; 0: none
  int repeats = 9;                                 ///< of slipmode's timed run; peers are repeated less
  bool setup_counts = false;                       ///< the ratios are those of 10⁴ units with slipmode's set-up
};

/// What one method needs and how wrong it is. Times are CPU seconds of one thread.
struct MethodFigures {
  double tolerance = 0.0;
  double seconds = 0.0;           ///< per unit of simulated time, median
  double error = 0.0;             ///< largest component of Δq, Δq̇ at a stretch's end: the median over stretches
  double worst_error = 0.0;       ///< and the largest: that of the stretch which amplifies errors most
  double event_time_error = 0.0;  ///< largest on the stretches, where the numbers of events agree
  long events = 0;                ///< on all stretches together
  double events_per_unit = 0.0;   ///< on the timed stretch
};

struct Comparison {
  ComparisonCase setting;
  MethodFigures slipmode, cvode, odeint;
  long reference_events = 0;
  double plain_seconds = 0.0;      ///< slipmode's timed run with the energy audit off
  double certified_seconds = 0.0;  ///< with the audit, and the proof that no event is passed
  double audit_residual = 0.0;
  double setup_rows_seconds = 0.0;    ///< frequencies, contact rows and step tables: all a run from rest needs
  double setup_shapes_seconds = 0.0;  ///< the same with mode shapes, for runs from a given state

  [[nodiscard]] double ratio_cvode() const { return cvode.seconds / paid(); }
  [[nodiscard]] double ratio_odeint() const { return odeint.seconds / paid(); }

 private:
  [[nodiscard]] double paid() const {
    return slipmode.seconds + (setting.setup_counts ? 1e-4 * setup_rows_seconds : 0.0);
  }
};

/// Measures one row. Peers run at relative and absolute tolerance 1e-9. slipmode runs at the loosest tolerance of
/// 1e-4, 3e-5, 1e-5, ... at which it finds every event and neither its median nor its worst error exceeds that of
/// either peer, with its energy audit on.
[[nodiscard]] Comparison compare(const ComparisonCase& setting);

/// The smooth stand-in with BDF on the same stretches.
struct TanhFigures {
  ComparisonCase setting;
  double epsilon = 0.0, tolerance = 0.0;
  double stretch = 0.0;  ///< shorter than for the exact law: its error is far larger, and chaos would fill it up
  double seconds = 0.0;  ///< per unit of simulated time
  double error = 0.0;
  double slipmode_seconds = 0.0, cvode_seconds = 0.0;
};

/// @param exact  the comparison of the same case: where the exact law's figures come from
[[nodiscard]] TanhFigures measure_tanh(const Comparison& exact, double epsilon);

void to_json(nlohmann::json& out, const Comparison& row);
void to_json(nlohmann::json& out, const TanhFigures& row);

}  // namespace slipmode::bench
