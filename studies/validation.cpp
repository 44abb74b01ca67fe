#include <slipmode/studies/validation.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/driven_validation_store.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/validation_store.hpp>
#include <slipmode/scene/driven.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/scene/solver_options.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/portraits.hpp>
#include <slipmode/studies/result_file.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <string>

namespace slipmode::studies {
namespace {

/// Where a comparison goes, and which share of it is computed.
struct Target {
  const std::filesystem::path& path;
  const Division& division;
};

/// Names the models compared to the last bit.
ResultFile file_of(const Target& target, const scene::Scene& scene, const std::vector<pod::NamedBasis>& bases,
                   const ValidationRequest& request, const Pieces& pieces) {
  std::string identity;
  for (const pod::NamedBasis& basis : bases) identity += fmt::format("{} {}\n", basis.name, identity_of(basis.basis));
  const std::string command =
      fmt::format("slipmode validate{}{}", request.sweep ? "" : " --no-sweep", request.verdict ? " --verdict" : "");
  return {target.path, scene, results::FileKind::kValidation, command, identity, target.division, pieces};
}

diagnostics::DrivenValidationOptions options_of(const scene::Scene& scene) {
  const auto& spec = scene.driven;
  diagnostics::DrivenValidationOptions options;
  const auto& swept = spec.frequencies ? spec.frequencies : spec.omegas;
  options.values = swept ? swept->values() : std::vector{scene::drive_parameter(scene)};
  options.modes.assign(spec.modes.begin(), spec.modes.end());
  options.mode =
      spec.follow == scene::DrivenValidationSpec::Follow::kNone ? SweepMode::kIndependent : SweepMode::kFollow;
  options.driven = scene::driven_options(scene);
  options.cost_parameter = scene::drive_parameter(scene);
  options.cost_cycles = spec.cost_cycles;
  options.cost_repeats = spec.cost_repeats;
  return options;
}

}  // namespace

diagnostics::ValidationOptions validation_options(const scene::Scene& scene,
                                                  const std::vector<pod::NamedBasis>& bases) {
  constexpr double kHorizonSamples = 1000.0, kIntervalsInHorizon = 5.0;
  const auto& spec = scene.validation;
  const pod::NamedBasis& first = bases.front();
  Eigen::Index available = first.basis.modes();
  for (const auto& other : bases) available = std::min(available, other.basis.modes());

  diagnostics::ValidationOptions options;
  options.speed = scene.drive.velocity(0.0);
  options.modes.assign(spec.modes.begin(), spec.modes.end());
  if (bases.size() == 1) options.modes = {available};
  options.horizon = spec.horizon;
  options.horizon_gap = 2.0 * spec.horizon;
  options.sample = spec.horizon / kHorizonSamples;
  options.horizon_starts = spec.horizon_starts;
  if (scene.ensemble.spread > 0.0) options.start_spread = scene.ensemble.spread;
  options.orbit_speeds = spec.orbits;
  options.orbit_tolerance = spec.orbit_tolerance;
  options.chosen = bases.size() == 1 ? available
                                     : chosen_modes(scene, scene.reduction.choice, first.captured, available,
                                                    fmt::format("the ensemble's {} basis", first.name));
  options.grow = options.modes.empty();
  if (options.grow) options.modes = diagnostics::mode_ladder(available, options.chosen);
  options.sweep_values = spec.speeds.values();
  options.sweep_segments = static_cast<std::size_t>(spec.segments);
  options.settle = scene::settle_options(scene);
  options.sweep_settle = scene::sweep_settle_options(scene);
  options.lyapunov.duration = spec.lyapunov_duration;
  options.lyapunov.transient = spec.transient;
  options.lyapunov.interval = spec.horizon / kIntervalsInHorizon;
  options.lyapunov.seed = scene.ensemble.seed;
  options.lyapunov.flow = scene::uncertified(scene.flow);
  options.cost_duration = spec.cost_duration;
  options.cost_repeats = spec.cost_repeats;
  return options;
}

namespace {

/// What a share of it keeps: its values alone.
Validation share_of(const scene::Scene& scene, ResultFile& file) {
  results::Content content = file.finish([](results::StoreWriter&) {});
  return {.scene = scene, .values = file.progress(), .belt = {}, .driven = {}, .content = std::move(content)};
}

Validation validate_belt(const scene::Scene& scene, const std::vector<pod::NamedBasis>& bases,
                         const ValidationRequest& request, const Target& target, const RunOptions& run) {
  const dynamics::HybridSystem full = scene::build_system(scene);
  diagnostics::ValidationOptions options = validation_options(scene, bases);
  if (!request.sweep) options.sweep_values.clear();
  if (request.verdict) options.verdict = scene::verdict_options(scene);
  const bool sweeps = !options.sweep_values.empty();
  ResultFile file =
      file_of(target, scene, bases, request, chains(sweeps ? options.sweep_segments : 0, "with validation.segments"));
  options.parallel = run.parallel("validate");
  if (file.journal() != nullptr) options.sink = results::journal_sink(*file.journal());
  const auto report = std::make_shared<const diagnostics::ValidationReport>(
      diagnostics::validate(full, bases, scene::initial_state(scene, full), options));
  if (report->interrupted) throw Interrupted();
  if (!report->whole) return share_of(scene, file);
  const auto levels = level_portraits(full, bases.front(), *report, scene.validation.horizon);
  const auto orbits = orbit_portraits(full, bases.front(), *report);
  const auto write = [report, scene, levels, orbits](results::StoreWriter& writer) {
    const results::Units units = results::Units::of(scene.units);
    results::store_validation(writer, *report, scene);
    results::store_portraits(writer, "portraits/levels", levels, units);
    results::store_portraits(writer, "portraits/orbits", orbits, units);
  };
  results::Content content = file.finish(write);
  return {.scene = scene, .values = file.progress(), .belt = report, .driven = {}, .content = std::move(content)};
}

Validation validate_driven(const scene::Scene& scene, const std::vector<pod::NamedBasis>& bases,
                           const ValidationRequest& request, const Target& target, const RunOptions& run) {
  const diagnostics::DrivenCase full = scene::driven_case(scene);
  auto options = options_of(scene);
  const std::size_t sweeps = driven_validation_sweeps(bases, options);
  const bool follows = options.mode == SweepMode::kFollow;
  ResultFile file = file_of(target, scene, bases, request,
                            follows ? chains(sweeps * options.segments, "with more numbers of modes")
                                    : Pieces{sweeps * options.values.size(), "values of all sweeps"});
  options.parallel = run.parallel("validate");
  if (file.journal() != nullptr) options.sink = results::driven_journal_sink(*file.journal());
  const auto report = std::make_shared<const diagnostics::DrivenValidationReport>(diagnostics::validate_driven(
      full, scene::drive_over_own_key(scene), bases, scene::initial_state(scene, full.system),
      scene::second_start(scene, full.system), options));
  if (report->interrupted) throw Interrupted();
  if (!report->whole) return share_of(scene, file);
  const auto write = [report, scene](results::StoreWriter& writer) {
    results::store_driven_validation(writer, *report, scene);
  };
  results::Content content = file.finish(write);
  return {.scene = scene, .values = file.progress(), .belt = {}, .driven = report, .content = std::move(content)};
}

}  // namespace

Validation validate(const scene::Scene& scene, const results::StoreReader& bases, const ValidationRequest& request,
                    const std::filesystem::path& file, const RunOptions& run, const Division& division) {
  scene::Scene own = scene::with_own_times(scene);
  const std::vector<pod::NamedBasis> found = load_bases(own, scene::build_system(own), bases);
  const bool is_reduced = results::kind_of(bases) == results::FileKind::kReduced;  // its own size is the one to judge
  if (is_driven(own) && is_reduced) own.driven.modes = {static_cast<int>(found.front().basis.modes())};
  return validate(own, found, request, file, run, division);
}

Validation validate(const scene::Scene& scene, const std::vector<pod::NamedBasis>& bases,
                    const ValidationRequest& request, const std::filesystem::path& file, const RunOptions& run,
                    const Division& division) {
  const Target target{file, division};
  if (!is_driven(scene)) return validate_belt(scene, bases, request, target, run);
  if (request.verdict)
    throw InvalidInput(
        "verdict: expected a belt, found a shaker or a force; there 'slipmode diagnose SCENE FILE --verdict', in "
        "Python exponents, does it");
  scene::Scene own = scene;
  if (!request.sweep) {
    own.driven.frequencies.reset();
    own.driven.omegas.reset();
  }
  return validate_driven(own, bases, request, target, run);
}

}  // namespace slipmode::studies
