#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/attractors/model.hpp>
#include <slipmode/diagnostics/attractors/settle.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::diagnostics {

/// from, from + step, … up to `to` (included when reached within step/1000). The sign of step is taken from to − from.
/// @throws InvalidInput  if step = 0 while from ≠ to, or a value is not finite, or more than 10⁷ values would result
[[nodiscard]] std::vector<double> sweep_values(double from, double to, double step);

enum class SweepMode {
  kIndependent,  ///< every value starts from the same state
  /// Every value starts from the end state of the one before it. A chain is sequential: `segments` chains run side by
  /// side, each from the common start, so one segment is the sequential sweep of the literature.
  kFollow,
};

/// One value of a sweep, finished. Result: what is kept of the motion there (Settled, DrivenMotion).
template <class Result>
struct SweptValue {
  std::size_t index = 0;  ///< into the values
  int model = 0;          ///< 0: the only or the full model, 1: the reduced model of a paired sweep
  double parameter = 0.0;
  Result settled = {};       ///< empty where it failed; settled.end is in the model's own coordinates
  std::string failure = {};  ///< empty, or why the value failed; the sweep went on

  [[nodiscard]] bool ok() const { return failure.empty(); }
};
using SweepPoint = SweptValue<Settled>;

/// Where finished values go at once and where earlier ones come from, so that a sweep can be resumed.
/// Calls come one at a time (never two at once), from any thread, in the order in which values finish.
template <class Result>
struct SinkOf {
  /// The point finished in an earlier run, if there is one. Must give back settled.end to the last bit: following
  /// values start there. Asked once per (index, model) before anything runs. Empty function: nothing to resume.
  std::function<std::optional<SweptValue<Result>>(std::size_t index, int model)> recall = {};
  /// Keeps a point just finished. An exception thrown here ends the sweep. Empty function: nothing kept.
  std::function<void(const SweptValue<Result>&)> store = {};
};
using SweepSink = SinkOf<Settled>;

struct SweepOptions {
  SweepMode mode = SweepMode::kIndependent;
  /// Number of chains in kFollow, ≥ 1. Part of the question, not of the machine: results depend on it, and not on the
  /// number of threads. Segment s holds values [s·m/S, (s+1)·m/S).
  std::size_t segments = 1;
  SettleOptions settle = {};  ///< settle.stop is ignored: parallel.stop is used
  ParallelOptions parallel = {};
  SweepSink sink = {};
};

struct SweepResult {
  std::vector<SweepPoint> points;  ///< in the order of the values; those finished, when interrupted
  bool interrupted = false;
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
