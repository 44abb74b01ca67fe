#include <slipmode/studies/reduction.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/driven.hpp>
#include <slipmode/studies/bases.hpp>

#include <fmt/format.h>

namespace slipmode::studies {

InvalidInput refused_modes(const std::string& source, Eigen::Index modes, const InvalidInput& refusal) {
  return InvalidInput(fmt::format("{}: --modes {}: {}", source, modes, refusal.what()));
}

void require_modes(const scene::Scene& scene, Eigen::Index modes, const std::string& source) {
  if (modes < 0) throw InvalidInput(fmt::format("modes = {}: expected 1 or more, or 0 for all there are", modes));
  if (modes > 0 && is_shaken(scene))
    throw InvalidInput(fmt::format("modes = {}: under a shaker all are kept, 'reduce' takes as many as wanted", modes));
  if (modes > scene.size()) {
    const std::string why =
        fmt::format("the scene has {} degrees of freedom; expected 1 to {}, or 0 for all modes there are", scene.size(),
                    scene.size());
    throw refused_modes(source, modes, InvalidInput(why));
  }
}

MotionModes motion_modes(const results::StoreReader& motion, Eigen::Index modes) {
  const pod::Ensemble ensemble = results::load_snapshots(motion);
  MotionModes found = motion_modes(results::load_scene_of(motion), ensemble, modes, motion.path().string());
  found.provenance = results::load_provenance(motion);
  found.provenance.command = "slipmode pod";
  return found;
}

MotionModes motion_modes(const scene::Scene& scene, const pod::Ensemble& snapshots, Eigen::Index modes,
                         const std::string& source) {
  require_modes(scene, modes, source);
  MotionModes found{.scene = scene,
                    .provenance = results::provenance_of(scene, "slipmode pod"),
                    .dofs = snapshots.snapshots.rows(),
                    .snapshots = snapshots.snapshots.cols(),
                    .pod = {},
                    .shaken = {}};
  if (!is_shaken(scene)) {
    try {
      found.pod = pod::pod(snapshots, {.choice = {.modes = modes, .energy = 1.0}});
    } catch (const InvalidInput& refusal) {
      throw refused_modes(source, modes, refusal);
    }
    return found;
  }
  found.shaken = shaken_modes(scene, scene::build_system(scene).structure(), snapshots);
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
  if (modes < 0)
    throw InvalidInput(fmt::format("modes = {}: expected 1 or more, or 0 for as many as [reduction] says", modes));
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
