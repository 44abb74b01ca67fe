#include <slipmode/studies/reduction.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/shaken.hpp>
#include <slipmode/studies/bases.hpp>

#include <fmt/format.h>

namespace slipmode::studies {
namespace {

/// The decomposition knows numbers only: a refusal is told with the file and the option it belongs to.
pod::PodResult decompose(const pod::Ensemble& ensemble, Eigen::Index modes, const std::string& file) {
  try {
    return pod::pod(ensemble, {.choice = {.modes = modes, .energy = 1.0}});
  } catch (const InvalidInput& refusal) {
    throw InvalidInput(fmt::format("{}: --modes {}: {}", file, modes, refusal.what()));
  }
}

void check_modes(Eigen::Index modes, const char* otherwise) {
  if (modes < 0) throw InvalidInput(fmt::format("modes = {}: expected 1 or more, or 0 for {}", modes, otherwise));
}

}  // namespace

MotionModes motion_modes(const results::StoreReader& motion, Eigen::Index modes) {
  check_modes(modes, "all there are");
  MotionModes found{.scene = {}, .provenance = results::load_provenance(motion), .pod = {}, .shaken = {}};
  const pod::Ensemble ensemble = results::load_snapshots(motion);
  found.scene = results::load_scene_of(motion);
  found.provenance.command = "slipmode pod";
  found.dofs = ensemble.snapshots.rows();
  found.snapshots = ensemble.snapshots.cols();
  if (!is_shaken(found.scene)) {
    found.pod = decompose(ensemble, modes, motion.path().string());
    return found;
  }
  if (modes > 0)
    throw InvalidInput(fmt::format("modes = {}: under a shaker all are kept, 'reduce' takes as many as wanted", modes));
  found.shaken = shaken_modes(found.scene, scene::build_system(found.scene).structure(), ensemble);
  return found;
}

results::Content content_of(const std::shared_ptr<const MotionModes>& modes) {
  return {.kind = results::FileKind::kPod,
          .unit_system = modes->scene.units,
          .write = [modes](results::StoreWriter& writer) {
            results::save(writer, modes->provenance);
            if (modes->pod) results::save(writer, results::kPodGroup, *modes->pod);
            if (modes->shaken) results::save(writer, *modes->shaken);
          }};
}

Reduction reduce(const scene::Scene& scene, const dynamics::HybridSystem& full, const pod::NamedBasis& source,
                 const std::string& name, Eigen::Index modes) {
  check_modes(modes, "as many as [reduction] says");
  pod::ModeChoice choice = scene.reduction.choice;
  if (modes > 0) choice.modes = modes;
  if (choice.modes == 0 && source.captured.size() == 0) {  // LNMs have no energies of their own
    throw InvalidInput(
        fmt::format("basis '{}' has no energy shares to choose by; give modes or reduction.modes", name));
  }
  const Eigen::Index taken =
      chosen_modes(scene, choice, source.captured, source.basis.modes(), fmt::format("basis '{}'", name));
  const pod::Basis basis = source.basis.truncated(taken);
  return {.full = full,
          .model = {.system = rom::reduce(full, basis), .basis = basis},
          .captured = source.captured.size() >= taken ? source.captured[taken - 1] : kNone};
}

results::Content content_of(const scene::Scene& scene, const std::shared_ptr<const Reduction>& reduction) {
  return {.kind = results::FileKind::kReduced,
          .unit_system = scene.units,
          .write = [scene, reduction](results::StoreWriter& writer) {
            const results::ReducedModel& model = reduction->model;
            results::save(
                writer, results::provenance_of(scene, fmt::format("slipmode reduce --modes {}", model.basis.modes())));
            results::save(writer, results::kReducedGroup, model);
          }};
}

}  // namespace slipmode::studies
