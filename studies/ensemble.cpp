#include <slipmode/studies/ensemble.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/studies/family.hpp>

#include <fmt/format.h>
#include <utility>

namespace slipmode::studies {
namespace {

diagnostics::Model ensemble_model(const scene::Scene& scene) {
  if (scene.drive.is_constant() || scene.drive.period()) return Family(scene, {drive_key(scene)}).model();
  return {.system = [family = Family(scene)](double) { return family.own(); }};
}

/// One run after the other, in order.
void append(diagnostics::EnsembleRun& all, diagnostics::EnsembleRun part) {
  const Eigen::Index before = all.ensemble.snapshots.cols(), more = part.ensemble.snapshots.cols();
  if (before == 0) {
    all.ensemble.snapshots = std::move(part.ensemble.snapshots);
  } else if (more > 0) {  // a share of the members may have none of these runs
    all.ensemble.snapshots.conservativeResize(Eigen::NoChange, before + more);
    all.ensemble.snapshots.rightCols(more) = part.ensemble.snapshots;
  }
  for (const Eigen::Index begin : part.ensemble.run_begin) all.ensemble.run_begin.push_back(before + begin);
  for (auto& member : part.members) all.members.push_back(std::move(member));
}

std::vector<double> parameters_of(const scene::Scene& scene) {
  const std::string key = drive_key(scene);
  const auto& named = key == "drive.speed"       ? scene.ensemble.speeds
                      : key == "drive.frequency" ? scene.ensemble.frequencies
                                                 : scene.ensemble.omegas;
  return named.empty() ? std::vector{scene::drive_parameter(scene)} : named;
}

/// What all members of an ensemble share.
struct Members {
  std::vector<double> parameters;
  diagnostics::Model model;
  std::vector<dynamics::State> starts;
  Eigen::Index dofs;
  dynamics::FlowOptions flow;

  explicit Members(const scene::Scene& scene)
      : parameters(parameters_of(scene)),
        model(ensemble_model(scene)),
        starts(scene::ensemble_states(scene, scene::build_system(scene))),
        dofs(scene.size()),
        flow(scene.flow) {}

  /// @param options  which part, and how members are kept
  [[nodiscard]] diagnostics::EnsembleRun run(const std::vector<double>& values, const scene::TimeSpec& time,
                                             const ParallelOptions& parallel,
                                             diagnostics::EnsembleOptions options = {}) const {
    options.duration = time.duration;
    options.transient = time.transient;
    options.sample = time.sample;
    options.flow = flow;
    options.parallel = parallel;
    return diagnostics::run_ensemble(model, values, starts, options);
  }

  /// A time in cycles is another one at each frequency.
  [[nodiscard]] diagnostics::EnsembleRun run_all(const scene::Scene& scene, const ParallelOptions& parallel,
                                                 diagnostics::EnsembleOptions options = {}) const {
    if (!scene.drive.period()) return run(parameters, scene.time, parallel, options);
    diagnostics::EnsembleRun all;
    for (const double frequency : parameters) {
      append(all, run({frequency}, scene::time_at(scene, frequency), parallel, options));
      ++options.model;
      options.sink.first_piece += starts.size();
    }
    return all;
  }
};

}  // namespace

diagnostics::EnsembleRun ensemble(const scene::Scene& scene, const RunOptions& run, results::Journal* journal) {
  const Members members(scene);
  const ParallelOptions parallel = run.parallel("ensemble");
  diagnostics::EnsembleOptions options;
  if (journal != nullptr) options.sink = results::ensemble_sink(*journal);
  return members.run_all(scene, parallel, options);
}

Pieces ensemble_pieces(const scene::Scene& scene) {
  return {.count = parameters_of(scene).size() * static_cast<std::size_t>(scene.ensemble.members), .what = "members"};
}

std::optional<dynamics::EnergyAudit> audit_of(const diagnostics::EnsembleRun& ensemble) {
  const diagnostics::EnsembleMember* worst = ensemble.worst();
  return worst == nullptr ? std::nullopt : std::optional(worst->audit);
}

diagnostics::EnsembleRun ensemble_part(const scene::Scene& scene, std::size_t part, std::size_t parts,
                                       const RunOptions& run) {
  if (scene.drive.shaker() != nullptr) {
    throw InvalidInput(fmt::format(
        "{}: drive.kind = \"shaker\": its modes are found by one process; start it without mpirun", scene.source.path));
  }
  const Members members(scene);
  diagnostics::EnsembleRun own = members.run_all(scene, run.parallel("ensemble"), {.part = part, .parts = parts});
  if (own.ensemble.snapshots.cols() == 0) own.ensemble.snapshots.resize(members.dofs, 0);
  return own;
}

results::Content content_of(const scene::Scene& scene,
                            const std::shared_ptr<const diagnostics::EnsembleRun>& ensemble) {
  const Eigen::MatrixXd& snapshots = ensemble->ensemble.snapshots;
  return {.kind = results::FileKind::kEnsemble,
          .unit_system = scene.units,
          .write =
              [scene, ensemble](results::StoreWriter& writer) {
                results::Provenance provenance = results::provenance_of(scene, kEnsembleCommand);
                provenance.audit = audit_of(*ensemble);
                results::save(writer, provenance);
                results::store_ensemble(writer, scene, *ensemble);
              },
          .shared = {{ensemble, {snapshots.data(), static_cast<std::size_t>(snapshots.size())}}}};
}

}  // namespace slipmode::studies
