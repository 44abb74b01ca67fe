#include <slipmode/studies/simulation.hpp>

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

}  // namespace slipmode::studies
