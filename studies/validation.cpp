#include <slipmode/studies/validation.hpp>

#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/driven_validation_store.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/validation_store.hpp>
#include <slipmode/scene/shaken.hpp>
#include <slipmode/scene/solver_options.hpp>
#include <slipmode/studies/portraits.hpp>
#include <slipmode/studies/result_file.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <string>

namespace slipmode::studies {
namespace {

/// Names the models compared to the last bit.
ResultFile file_of(const std::filesystem::path& path, const scene::Scene& scene,
                   const std::vector<pod::NamedBasis>& bases) {
  std::string identity;
  for (const pod::NamedBasis& basis : bases) identity += fmt::format("{} {}\n", basis.name, identity_of(basis.basis));
  return {path, scene, results::FileKind::kValidation, "slipmode validate", identity};
}

diagnostics::DrivenValidationOptions options_of(const scene::Scene& scene) {
  const auto& spec = scene.shaken;
  diagnostics::DrivenValidationOptions options;
  options.values = spec.frequencies ? spec.frequencies->values() : std::vector{scene::drive_parameter(scene)};
  options.modes.assign(spec.modes.begin(), spec.modes.end());
  options.mode =
      spec.follow == scene::ShakenValidationSpec::Follow::kNone ? SweepMode::kIndependent : SweepMode::kFollow;
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
  options.orbit_speeds = spec.orbits;
  options.orbit_tolerance = spec.orbit_tolerance;
  options.chosen = bases.size() == 1 ? available
                                     : pod::chosen_modes(scene.reduction.choice, first.captured, available,
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

diagnostics::ValidationReport validate(const scene::Scene& scene, const std::vector<pod::NamedBasis>& bases,
                                       diagnostics::ValidationOptions options, const std::filesystem::path& file,
                                       const RunOptions& run) {
  const dynamics::HybridSystem full = scene::build_system(scene);
  ResultFile result = file_of(file, scene, bases);
  options.parallel = run.parallel("validate");
  options.sink = results::journal_sink(result.journal());
  diagnostics::ValidationReport report = diagnostics::validate(full, bases, scene::initial_state(scene, full), options);
  if (report.interrupted) throw Interrupted();
  result.finish([&](results::StoreWriter& writer) {
    const results::Units units = results::Units::of(scene.units);
    results::store_validation(writer, report, scene);
    results::store_portraits(writer, "portraits/levels", level_portraits(full, bases.front(), report), units);
    results::store_portraits(writer, "portraits/orbits", orbit_portraits(full, bases.front(), report), units);
  });
  return report;
}

diagnostics::DrivenValidationReport validate_shaken(const scene::Scene& scene,
                                                    const std::vector<pod::NamedBasis>& bases,
                                                    const std::filesystem::path& file, const RunOptions& run) {
  const diagnostics::DrivenCase full = scene::shaken_case(scene);
  ResultFile result = file_of(file, scene, bases);
  auto options = options_of(scene);
  options.parallel = run.parallel("validate");
  options.sink = results::driven_journal_sink(result.journal());
  diagnostics::DrivenValidationReport report = diagnostics::validate_driven(
      full, scene::drive_over_frequency(scene), bases, scene::initial_state(scene, full.system),
      scene::second_start(scene, full.system), options);
  if (report.interrupted) throw Interrupted();
  result.finish([&](results::StoreWriter& writer) { results::store_driven_validation(writer, report, scene); });
  return report;
}

}  // namespace slipmode::studies
