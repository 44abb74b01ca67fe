#include <slipmode/studies/ensemble.hpp>

#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/studies/family.hpp>

#include <utility>

namespace slipmode::studies {
namespace {

diagnostics::Model ensemble_model(const scene::Scene& scene) {
  if (scene.drive.is_constant()) return Family(scene, {"drive.speed"}).model();
  if (scene.drive.shaker() != nullptr) return Family(scene, {"drive.frequency"}).model();
  return {.system = [family = Family(scene)](double) { return family.own(); }};
}

/// One run after the other, in order.
void append(diagnostics::EnsembleRun& all, diagnostics::EnsembleRun part) {
  const Eigen::Index before = all.ensemble.snapshots.cols();
  Eigen::MatrixXd joined(part.ensemble.snapshots.rows(), before + part.ensemble.snapshots.cols());
  if (before > 0) joined.leftCols(before) = all.ensemble.snapshots;
  joined.rightCols(part.ensemble.snapshots.cols()) = part.ensemble.snapshots;
  all.ensemble.snapshots = std::move(joined);
  for (const Eigen::Index begin : part.ensemble.run_begin) all.ensemble.run_begin.push_back(before + begin);
  for (auto& member : part.members) all.members.push_back(std::move(member));
}

}  // namespace

diagnostics::EnsembleRun ensemble(const scene::Scene& scene, const RunOptions& run) {
  const bool shaken = scene.drive.shaker() != nullptr;
  std::vector<double> parameters = shaken ? scene.ensemble.frequencies : scene.ensemble.speeds;
  if (parameters.empty()) parameters.push_back(scene::drive_parameter(scene));
  const diagnostics::Model model = ensemble_model(scene);
  const std::vector<dynamics::State> starts = scene::ensemble_states(scene, scene::build_system(scene));
  const ParallelOptions parallel = run.parallel("ensemble");
  const auto run_at = [&](const std::vector<double>& values, const scene::TimeSpec& time) {
    return diagnostics::run_ensemble(model, values, starts,
                                     {.duration = time.duration,
                                      .transient = time.transient,
                                      .sample = time.sample,
                                      .flow = scene.flow,
                                      .parallel = parallel});
  };
  if (!shaken) return run_at(parameters, scene.time);
  diagnostics::EnsembleRun all;  // a time in cycles is another one at each frequency
  for (const double frequency : parameters) append(all, run_at({frequency}, scene::time_at(scene, frequency)));
  return all;
}

results::Content content_of(const scene::Scene& scene,
                            const std::shared_ptr<const diagnostics::EnsembleRun>& ensemble) {
  const Eigen::MatrixXd& snapshots = ensemble->ensemble.snapshots;
  return {
      .kind = results::FileKind::kEnsemble,
      .unit_system = scene.units,
      .write = [scene, ensemble](results::StoreWriter& writer) { results::store_ensemble(writer, scene, *ensemble); },
      .shared = {{ensemble, {snapshots.data(), static_cast<std::size_t>(snapshots.size())}}}};
}

}  // namespace slipmode::studies
