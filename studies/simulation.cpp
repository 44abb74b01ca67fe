#include <slipmode/studies/simulation.hpp>

#include <slipmode/core/describe.hpp>
#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/studies/command.hpp>

#include <utility>

namespace slipmode::studies {
namespace {

/// Progress by simulated time.
dynamics::Trajectory watched(const Family& model, const dynamics::State& start, dynamics::SimulateOptions options,
                             const RunOptions& run) {
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
  dynamics::Trajectory trajectory = dynamics::simulate(model.own(), start, options);
  run.check_interrupt();
  if (!model.basis()) return trajectory;
  const pod::Basis& basis = model.basis()->basis;
  trajectory.final_state = rom::lift(basis, trajectory.final_state);
  trajectory.q = basis.vectors * trajectory.q;
  if (basis.mean.size() > 0) trajectory.q.colwise() += basis.mean;
  trajectory.v = basis.vectors * trajectory.v;
  return trajectory;
}

}  // namespace

Simulation simulate(const Family& model, const RunOptions& run) {
  const dynamics::State start = model.start();
  dynamics::SimulateOptions options = scene::simulate_options(model.scene());
  try {
    return {watched(model, start, options, run), std::nullopt};
  } catch (const NumericalFailure& failure) {
    // What came before is not lost: the run is done again up to there.
    const double reached = failure.time - start.time - options.sample;
    if (!(reached > options.transient + options.sample)) throw;
    options.duration = reached;
    return {watched(model, start, options, run), failure};
  }
}

results::Content content_of(const scene::Scene& scene, std::shared_ptr<const Simulation> simulation,
                            const std::string& model_word) {
  const dynamics::Trajectory& run = simulation->trajectory;
  results::Content content{.kind = results::FileKind::kTrajectory, .unit_system = scene.units, .write = {}};
  for (const Eigen::MatrixXd* samples : {&run.q, &run.v, &run.contact_q, &run.contact_v, &run.lambda})
    content.shared.push_back({simulation, {samples->data(), static_cast<std::size_t>(samples->size())}});
  content.shared.push_back({simulation, {run.times.data(), static_cast<std::size_t>(run.times.size())}});
  content.write = [scene,
                   command = std::string("slipmode simulate") +
                             (scene::has_section(scene, "ensemble") ? " --single" : "") + model_option(model_word),
                   simulation = std::move(simulation)](results::StoreWriter& writer) {
    const dynamics::Trajectory& trajectory = simulation->trajectory;
    results::Provenance provenance = results::provenance_of(scene, command);
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
