#include <slipmode/studies/simulation.hpp>

#include <slipmode/core/describe.hpp>
#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>

#include <utility>

namespace slipmode::studies {
namespace {

/// Progress by simulated time.
dynamics::Trajectory watched(const dynamics::HybridSystem& system, const dynamics::State& start,
                             dynamics::SimulateOptions options, const RunOptions& run) {
  const ProgressCallback progress = run.parallel("simulate").progress;
  const double duration = options.duration;
  options.on_event = [&](const dynamics::Event& event, const dynamics::State&) {
    constexpr double kParts = 1000.0;
    if (progress) {
      progress(static_cast<std::size_t>(kParts * (event.time - start.time) / duration),
               static_cast<std::size_t>(kParts));
    }
    return run.stop == nullptr || !run.stop->load();
  };
  dynamics::Trajectory trajectory = dynamics::simulate(system, start, options);
  run.check_interrupt();
  return trajectory;
}

}  // namespace

Simulation simulate(const scene::Scene& scene, const RunOptions& run) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  const dynamics::State start = scene::initial_state(scene, system);
  dynamics::SimulateOptions options = scene::simulate_options(scene);
  try {
    return {watched(system, start, options, run), std::nullopt};
  } catch (const NumericalFailure& failure) {
    // What came before is not lost: the run is done again up to there.
    const double reached = failure.time - start.time - options.sample;
    if (!(reached > options.transient + options.sample)) throw;
    options.duration = reached;
    return {watched(system, start, options, run), failure};
  }
}

results::Content content_of(const scene::Scene& scene, std::shared_ptr<const Simulation> simulation) {
  const dynamics::Trajectory& run = simulation->trajectory;
  results::Content content{.kind = results::FileKind::kTrajectory, .unit_system = scene.units, .write = {}};
  for (const Eigen::MatrixXd* samples : {&run.q, &run.v, &run.contact_q, &run.contact_v, &run.lambda})
    content.shared.push_back({simulation, {samples->data(), static_cast<std::size_t>(samples->size())}});
  content.shared.push_back({simulation, {run.times.data(), static_cast<std::size_t>(run.times.size())}});
  content.write = [scene, simulation = std::move(simulation)](results::StoreWriter& writer) {
    const dynamics::Trajectory& trajectory = simulation->trajectory;
    results::Provenance provenance = results::provenance_of(scene, "slipmode simulate");
    provenance.audit = trajectory.audit;
    results::save(writer, provenance);
    results::save(writer, results::kTrajectoryGroup, trajectory);
    if (scene.sensors) results::store_sensors(writer, scene, trajectory.q);
    if (simulation->failure) {
      writer.write("trajectory/incomplete", describe(*simulation->failure),
                   {"", "the run stopped early: why and where"});
    }
  };
  return content;
}

}  // namespace slipmode::studies
