#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/studies/bases.hpp>
#include "cli/orbit_report.hpp"
#include "cli/orbit_search.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct OrbitFindArguments {
  OrbitSearchArguments search;
  std::string output;
};

/// The orbit and one period of it, sampled.
void store(const std::string& path, const scene::Scene& scene, const dynamics::HybridSystem& system,
           const orbits::PeriodicOrbit& orbit) {
  constexpr double kSamples = 1000.0;
  const dynamics::Trajectory period = dynamics::simulate(
      system, orbit.start, {.duration = orbit.period, .sample = orbit.period / kSamples, .flow = {.tolerance = 1e-12}});
  results::StoreWriter writer(path, results::FileKind::kOrbit, scene.units);
  results::Provenance provenance = results::provenance_of(scene, "slipmode orbit find");
  provenance.audit = period.audit;
  results::save(writer, provenance);
  results::save(writer, results::kOrbitGroup, orbit);
  results::save(writer, results::kTrajectoryGroup, period);
  writer.commit();
}

Report run(const Session& session, const OrbitFindArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.search.scene);
  const studies::Family model(scene, {}, studies::model_basis(scene, arguments.search.model, session.run_options()));
  const dynamics::HybridSystem& system = model.own();
  const studies::OrbitSearch search = search_of(arguments.search, scene);
  session.check_interrupt();
  const orbits::ShootingResult result = studies::find_orbit(model, search);
  if (!result.converged()) return not_found("orbit find", result);

  const std::vector<orbits::Amplitude> amplitudes = orbits::contact_amplitudes(system, result.orbit);
  Report report;
  report.data = {{"verb", "orbit find"}, {"title", scene.title}, {"model", model.title()}};
  report.data.update(orbit_json(system, result.orbit, amplitudes));
  report.text = fmt::format("{}, {}: {}", scene.title, model.title(), orbit_text(system, result.orbit, amplitudes));
  if (!arguments.output.empty()) {
    store(arguments.output, scene, system, result.orbit);
    report.data["file"] = arguments.output;
    report.text += fmt::format("Orbit: {}\n", arguments.output);
  }
  return report;
}

}  // namespace

Verb add_orbit_find(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("find", "a periodic orbit, its multipliers and what it does");
  const auto arguments = std::make_shared<OrbitFindArguments>();
  add_search_options(*command, arguments->search);
  command->add_option("-o,--output", arguments->output, "also store the orbit and one period of it (HDF5)");
  command->footer(
      "Example:\n  slipmode orbit find datasets/backlash_sdof/scene.toml --json\n"
      "  slipmode orbit find datasets/backlash_sdof/scene.toml --start 1.2,0.1 -o orbit.h5\n"
      "  slipmode orbit find datasets/chain10/scene.toml --set drive.speed=0.45");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
