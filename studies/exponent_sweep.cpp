#include <slipmode/studies/exponent_sweep.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/scene/solver_options.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <utility>
#include <variant>

namespace slipmode::studies {
namespace {

using results::LeadingExponents;

/// The diagram of one model, its points kept under the model's number.
std::vector<diagnostics::SweepPoint> diagram_of(const Family& family, int number, const std::vector<double>& values,
                                                const ExponentSweepOptions& options, const RunOptions& run) {
  diagnostics::SweepOptions sweeping{.mode = options.follow ? SweepMode::kFollow : SweepMode::kIndependent,
                                     .model = number,
                                     .settle = scene::sweep_settle_options(family.scene()),
                                     .parallel = run.parallel("diagram")};
  if (options.journal != nullptr) sweeping.sink = results::journal_sink(*options.journal);
  sweeping.sink.for_all = true;  // exponents are measured where the motion has settled
  diagnostics::SweepResult result = diagnostics::sweep(family.model(), values, family.start(), sweeping);
  if (result.interrupted) throw Interrupted();
  return std::move(result.points);
}

/// @param start  where the family's motions begin, for a value that has not settled elsewhere
LeadingExponents exponents_at(const Family& family, const dynamics::State& start,
                              const diagnostics::SweepPoint* settled, double value,
                              diagnostics::TangentOptions tangent) {
  if (settled != nullptr && !settled->ok()) throw NumericalFailure(settled->failure, 0.0, {}, 0.0);
  if (settled != nullptr) tangent.transient = 0.0;
  const dynamics::HybridSystem system = family.at({value});
  tangent.exponents = std::min(tangent.exponents, 2 * system.size() + system.internal_size());
  try {
    const diagnostics::LyapunovSpectrum spectrum =
        diagnostics::lyapunov_spectrum(system, settled != nullptr ? settled->settled.end : start, tangent);
    return {.nats = spectrum.nats, .error = spectrum.error, .ended = spectrum.failure};
  } catch (const NumericalFailure& failure) {
    throw NumericalFailure(fmt::format("at time {:g}: {}", failure.time, failure.what()), failure.time, failure.state,
                           failure.residual);
  }
}

}  // namespace

Pieces pieces(const std::vector<double>& values, const ExponentSweepOptions& options) {
  return options.follow ? chains(1, "without --follow") : Pieces{values.size(), "values"};
}

std::vector<ExponentSweep> exponent_sweeps(const std::vector<Family>& families, const std::vector<double>& values,
                                           const ExponentSweepOptions& options, const RunOptions& run) {
  std::vector<ExponentSweep> out(families.size());
  for (std::size_t m = 0; m < families.size(); ++m) {
    if (families[m].own().drive().belt() == nullptr) continue;
    out[m].diagram = diagram_of(families[m], static_cast<int>(m), values, options, run);
  }
  results::ExponentSink sink;
  if (options.journal != nullptr) sink = results::exponent_sink(*options.journal);
  for (std::size_t m = 0; m < families.size(); ++m) {
    const dynamics::State start = families[m].start();
    std::vector<const diagnostics::SweepPoint*> settled(values.size(), nullptr);
    for (const diagnostics::SweepPoint& point : out[m].diagram) settled[point.index] = &point;
    const auto settle = [&](std::size_t i, int, const std::monostate&) {
      return exponents_at(families[m], start, settled[i], values[i], options.tangent);
    };
    auto found =
        SweepRunner<LeadingExponents, std::monostate>(
            {.settle = settle, .carry = [](const auto&) { return std::monostate(); }, .leader = static_cast<int>(m)},
            values, {}, SweepMode::kIndependent, 1, run.parallel("exponents"), sink)
            .run_alone();
    if (found.interrupted) throw Interrupted();
    out[m].points = std::move(found.points);
  }
  return out;
}

}  // namespace slipmode::studies
