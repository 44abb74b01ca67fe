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

constexpr Eigen::Index kSweptExponents = 4;
/// Time measured at each value, of that of a single spectrum.
constexpr double kSweptShare = 0.25;

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

std::vector<SweptModel> swept_models(const scene::Scene& scene, const Over& over,
                                     const std::vector<results::StoreReader>& bases, Eigen::Index modes) {
  check_values(scene, over.key, over.values);
  if (bases.size() > 1)
    throw InvalidInput(
        fmt::format("over {}: expected one basis at most beside the full model, found {}", over.key, bases.size()));
  const Family full(scene, {over.key});
  std::vector<SweptModel> models = {{.title = full.title(), .role = "full", .family = full}};
  const Subjects subjects = subjects_of(scene, bases, modes);
  if (subjects.bases.empty()) return models;
  const pod::NamedBasis& basis = subjects.bases.front();
  models.push_back({.title = fmt::format("reduced model, {}", basis.name),
                    .role = "reduced",
                    .family = Family(scene, {over.key}, basis)});
  return models;
}

ExponentSweepOptions exponent_sweep_options(const scene::Scene& scene, const std::vector<SweptModel>& models,
                                            const ExponentRequest& request, bool follow, const RunOptions& run) {
  ExponentSweepOptions options{.tangent = tangent_options(scene, models.front().family.own(), request, run),
                               .follow = follow};
  if (request.exponents == 0) options.tangent.exponents = kSweptExponents;
  if (!request.duration) options.tangent.duration *= kSweptShare;
  return options;
}

std::string command_of(const Over& over, const std::vector<SweptModel>& models, const ExponentSweepOptions& options) {
  const diagnostics::TangentOptions& tangent = options.tangent;
  return command_text("diagnose", {over},
                      fmt::format("{} --exponents {} --transient {} --duration {} --renormalise {} {}",
                                  options.follow ? " --follow" : "", tangent.exponents, tangent.transient,
                                  tangent.duration, tangent.interval, models.back().title));
}

std::string identity_of(const std::vector<SweptModel>& models) {
  const std::optional<pod::NamedBasis>& basis = models.back().family.basis();
  return basis ? identity_of(basis->basis) : "";
}

Pieces pieces(const std::vector<double>& values, const ExponentSweepOptions& options) {
  return options.follow ? chains(1, "without --follow") : Pieces{values.size(), "values"};
}

std::vector<ExponentSweep> exponent_sweeps(const std::vector<SweptModel>& models, const std::vector<double>& values,
                                           const ExponentSweepOptions& options, const RunOptions& run) {
  std::vector<ExponentSweep> out(models.size());
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (models[m].family.own().drive().belt() == nullptr) continue;
    out[m].diagram = diagram_of(models[m].family, static_cast<int>(m), values, options, run);
  }
  results::ExponentSink sink;
  if (options.journal != nullptr) sink = results::exponent_sink(*options.journal);
  for (std::size_t m = 0; m < models.size(); ++m) {
    const dynamics::State start = models[m].family.start();
    std::vector<const diagnostics::SweepPoint*> settled(values.size(), nullptr);
    for (const diagnostics::SweepPoint& point : out[m].diagram) settled[point.index] = &point;
    const auto settle = [&](std::size_t i, int, const std::monostate&) {
      return exponents_at(models[m].family, start, settled[i], values[i], options.tangent);
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

void store(results::StoreWriter& writer, const std::vector<SweptModel>& models,
           const std::vector<ExponentSweep>& sweeps) {
  const results::Units units = results::Units::of(models.front().family.scene().units);
  for (std::size_t m = 0; m < models.size(); ++m) {
    const auto& [title, role, family] = models[m];
    if (!sweeps[m].diagram.empty())
      results::store_sweep(writer, "sweep/" + role, title, family.axis(), units, sweeps[m].diagram);
    results::store_exponent_sweep(writer, "exponents/" + role, title, family.axis(), units, sweeps[m].points);
  }
}

}  // namespace slipmode::studies
