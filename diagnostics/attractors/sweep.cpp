#include <slipmode/diagnostics/attractors/sweep.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <cmath>

namespace slipmode::diagnostics {

namespace {

constexpr double kMaxValues = 1e7;

using Runner = SweepRunner<Settled, dynamics::State>;

Runner runner(SweepWork<Settled, dynamics::State> work, const std::vector<double>& values, const dynamics::State& start,
              const SweepOptions& options) {
  return {std::move(work), values, start, options.mode, options.segments, options.parallel, options.sink};
}

Settled settle_at(const Model& model, double value, const dynamics::State& start, const SweepOptions& options) {
  SettleOptions settling = options.settle;
  settling.stop = options.parallel.stop;
  Settled settled = settle(model.system(value), start, settling);
  settled.mean_energy += energy_offset_at(model, value);
  return settled;
}

}  // namespace

std::vector<double> sweep_values(double from, double to, double step) {
  const double range = to - from;
  if (!std::isfinite(range) || !std::isfinite(step) || (step == 0.0 && range != 0.0)) {
    throw InvalidInput(
        fmt::format("sweep range: expected finite numbers and a step other than 0, found {}:{}:{}", from, to, step));
  }
  if (range == 0.0) return {from};
  const double count = std::floor(std::abs(range / step) + 1e-3);
  if (count >= kMaxValues) {
    throw InvalidInput(fmt::format("sweep range: expected at most {} values, found {} in {}:{}:{}", kMaxValues,
                                   count + 1, from, to, step));
  }
  std::vector<double> values;
  const double signed_step = std::copysign(step, range);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(count); ++i) {
    values.push_back(from + static_cast<double>(i) * signed_step);
  }
  return values;
}

SweepResult sweep(const Model& model, const std::vector<double>& values, const dynamics::State& start,
                  const SweepOptions& options) {
  return runner({.settle = [&](std::size_t i, int,
                               const dynamics::State& from) { return settle_at(model, values[i], from, options); },
                 .carry = [](const Settled& settled) { return settled.end; },
                 .leader = options.model},
                values, start, options)
      .run_alone();
}

PairedSweep paired_sweep(const Model& full, const Model& reduced, const std::vector<double>& values,
                         const dynamics::State& start, const SweepOptions& options) {
  if (!reduced.basis) throw InvalidInput("paired sweep: expected a reduced model with its basis, found none");
  auto run = runner({.settle =
                         [&](std::size_t i, int tag, const dynamics::State& from) {
                           return settle_at(tag == 0 ? full : reduced, values[i], from, options);
                         },
                     .carry = [](const Settled& settled) { return settled.end; },
                     .leader = 1,
                     .follow = [&](const dynamics::State& leading) { return lifted(reduced, leading); }},
                    values, start, options);
  const bool finished = run.run();
  PairedSweep result;
  result.reduced = run.take_leader();
  result.full = run.take_follower();
  result.interrupted = !finished;
  return result;
}

}  // namespace slipmode::diagnostics
