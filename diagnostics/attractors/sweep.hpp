#pragma once

#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/diagnostics/attractors/settle.hpp>
#include <slipmode/diagnostics/model.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace slipmode::diagnostics {

/// from, from + step, … up to `to` (included when reached within step/1000). The sign of step is taken from to − from.
/// @throws InvalidInput  if step = 0 while from ≠ to, or a value is not finite, or more than 10⁷ values would result
[[nodiscard]] std::vector<double> sweep_values(double from, double to, double step);

using SweepPoint = SweptValue<Settled>;
using SweepSink = SinkOf<Settled>;
using SweepResult = SweepOf<Settled>;

struct SweepOptions {
  SweepMode mode = SweepMode::kIndependent;
  /// Number of chains in kFollow, ≥ 1. Part of the question, not of the machine: results depend on it, and not on the
  /// number of threads. Segment s holds values [s·m/S, (s+1)·m/S).
  std::size_t segments = 1;
  int model = 0;              ///< SweptValue::model of the points of sweep(): tells apart sweeps that share a sink
  SettleOptions settle = {};  ///< settle.stop is ignored: parallel.stop is used
  ParallelOptions parallel = {};
  SweepSink sink = {};
};

/// Sweeps one model over `values` from `start`. A NumericalFailure is recorded in its point; the chain then goes on
/// from the start of the point that failed.
/// @throws InvalidInput  for no values, segments < 1 or more than values, and what the factory or simulate find wrong
[[nodiscard]] SweepResult sweep(const Model& model, const std::vector<double>& values, const dynamics::State& start,
                                const SweepOptions& options);

struct PairedSweep {
  std::vector<SweepPoint> full, reduced;  ///< in the order of the values
  bool interrupted = false;
};

/// Full and reduced side by side with shared initial states (S4 section 3.5.3): at each value both start from the
/// reduced model's end state at the value before, lifted for the full one. So only the reduced chain is sequential;
/// the full model at value k runs beside the reduced one at k + 1. options.mode: kFollow does this (with `segments`
/// chains); kIndependent starts every value from `start`.
/// @param start  in the reduced model's coordinates
/// @throws InvalidInput  as sweep, and if `reduced` has no basis
[[nodiscard]] PairedSweep paired_sweep(const Model& full, const Model& reduced, const std::vector<double>& values,
                                       const dynamics::State& start, const SweepOptions& options);

}  // namespace slipmode::diagnostics
