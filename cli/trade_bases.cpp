#include "cli/trade_bases.hpp"

#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/shaken_bases.hpp"
#include "cli/shaken_model.hpp"
#include "cli/steps.hpp"
#include "cli/validation_setup.hpp"

#include <ctime>
#include <optional>

namespace slipmode::cli {
namespace {

using trade::OfferedBasis;

/// Processor time of a piece of work, of all its threads [s].
template <class Work>
double processor_time(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

std::vector<OfferedBasis> shaken(const Session& session, const scene::Scene& scene,
                                 const dynamics::HybridSystem& system) {
  std::optional<ShakenModes> made;
  double making = 0.0;
  const auto ensemble = [&]() -> const ShakenModes& {
    if (!made) {
      making = processor_time(
          [&] { made = shaken_modes(scene, system.structure(), run_scene_ensemble(session, scene, system).ensemble); });
    }
    return *made;
  };
  std::vector<OfferedBasis> bases;
  for (const scene::BasisChoice word : scene.shaken.bases) {
    OfferedBasis offered{.choice = word, .basis = {}};
    offered.seconds = processor_time([&] { offered.basis = shaken_basis(word, scene, system, ensemble); });
    const bool from_motion = word != scene::BasisChoice::kLnm && word != scene::BasisChoice::kLnmStatic;
    if (from_motion) offered.seconds = making;  // whichever basis was made first
    bases.push_back(std::move(offered));
  }
  return bases;
}

std::vector<OfferedBasis> on_belt(const Session& session, const scene::Scene& scene,
                                  const dynamics::HybridSystem& system) {
  std::optional<pod::PodResult> result;
  double making = 0.0;
  try {
    making = processor_time([&] { result = pod::pod(run_scene_ensemble(session, scene, system).ensemble); });
  } catch (const InvalidInput&) {
    const double modes = processor_time([&] { (void)rom::lnm_basis(system.structure(), system.size()); });
    return {{.choice = scene::BasisChoice::kLnm,
             .basis = rom::lnm_basis(system.structure(), system.size()),
             .seconds = modes}};
  }
  std::vector<OfferedBasis> bases;
  for (auto& candidate : pom_and_lnm(scene, system.structure(), *result)) {
    bases.push_back({.choice = candidate.name == "POM" ? scene::BasisChoice::kPom : scene::BasisChoice::kLnm,
                     .basis = std::move(candidate.basis),
                     .seconds = making});
  }
  return bases;
}

}  // namespace

std::vector<OfferedBasis> offered_bases(const Session& session, const scene::Scene& scene) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  if (system.size() < 2) return {};
  return is_shaken(scene) ? shaken(session, scene, system) : on_belt(session, scene, system);
}

}  // namespace slipmode::cli
