#include <slipmode/studies/bases.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/diagnostics/model.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/mode_shares.hpp>
#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/reduced_file.hpp>
#include <slipmode/rom/candidates.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/driven.hpp>
#include <slipmode/studies/ensemble.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <ctime>
#include <utility>

namespace slipmode::studies {
namespace {

using results::FileKind;

constexpr Eigen::Index kShownModes = 6;
/// Natural modes beyond this many are known badly by any mesh, and no reduced model is asked to have them.
constexpr Eigen::Index kMostModes = 40;

pod::Ensemble with_snapshots(const pod::Ensemble& like, Eigen::MatrixXd snapshots) {
  return {.snapshots = std::move(snapshots), .run_begin = like.run_begin};
}

/// Displacements at the sensors' own places.
pod::Ensemble sensor_displacements(const scene::Scene& scene, const fem::Beam& beam, const pod::SensorArray& places,
                                   const pod::Ensemble& snapshots) {
  const pod::SensorArray sensors = scene::sensor_array(scene, beam);
  pod::Ensemble readings = with_snapshots(snapshots, scene::sensor_readings(scene, beam, snapshots.snapshots));
  if (sensors.all(pod::SensorKind::kDisplacement)) return readings;
  const Eigen::Index asked = scene.reduction.functions;
  const Eigen::Index functions = asked > 0 ? asked : sensors.size();
  const pod::ModalFit fit(sensors, scene.reduction.fit == pod::FitFamily::kPolynomials
                                       ? pod::polynomial_functions(beam, functions)
                                       : pod::natural_functions(beam, functions));
  return pod::converted(readings, fit, places);
}

Eigen::MatrixXd lnm_shares(const pod::Basis& basis, const fem::Structure& structure, Eigen::Index lnms) {
  return pod::mode_shares(basis, fem::natural_modes(structure, lnms), structure.M());
}

/// What an ensemble of the scene says, read from a file that holds one.
pod::Ensemble snapshots_for(const results::StoreReader& store, Eigen::Index size) {
  pod::Ensemble ensemble = results::load_snapshots(store);
  if (ensemble.snapshots.rows() != size) {
    store.fail(results::kEnsembleGroup, fmt::format("expected {} degrees of freedom as in the scene, found {}", size,
                                                    ensemble.snapshots.rows()));
  }
  return ensemble;
}

pod::NamedBasis kept_basis(const results::StoreReader& store, const std::string& group, Eigen::Index n) {
  const pod::Basis basis = results::load_basis(store, group, n);
  const bool known = basis.energy.size() == basis.modes();
  return {.name = basis.kind == pod::BasisKind::kPom   ? "POM"
                  : basis.kind == pod::BasisKind::kLnm ? "LNM"
                                                       : std::string(pod::to_string(basis.kind)),
          .basis = basis,
          .captured = known ? pod::cumulative(basis.energy) : Eigen::VectorXd::Constant(basis.modes(), kNone)};
}

/// What models are reduced by, or what that is made of.
constexpr std::array kWithBases{FileKind::kPod,   FileKind::kEnsemble,   FileKind::kReduced,
                                FileKind::kBasis, FileKind::kTrajectory, FileKind::kOrbit};

/// Where a reduced model, or a basis alone, has its vectors.
std::string basis_group(FileKind kind) {
  return kind == FileKind::kReduced ? std::string(results::kReducedGroup) + "/basis" : results::kBasisGroup;
}

std::vector<pod::NamedBasis> load_plain_bases(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                              const results::StoreReader& store) {
  const Eigen::Index n = full.size();
  const FileKind kind = results::require_kind(store, kWithBases);
  if (kind == FileKind::kReduced || kind == FileKind::kBasis) return {kept_basis(store, basis_group(kind), n)};
  return plain_bases(
      scene, full,
      kind == FileKind::kPod ? results::load_pod(store, results::kPodGroup, n) : pod::pod(snapshots_for(store, n)));
}

std::vector<pod::NamedBasis> load_shaken_bases(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                               const results::StoreReader& store) {
  const FileKind kind = results::require_kind(store, kWithBases);
  if (kind == FileKind::kReduced || kind == FileKind::kBasis) {
    const pod::Basis basis = results::load_basis(store, basis_group(kind), full.size());
    return {{.name = std::string(pod::to_string(basis.kind)), .basis = basis}};
  }
  const results::ShakenModes modes = kind == FileKind::kPod
                                         ? results::load_shaken_modes(store, full.size())
                                         : shaken_modes(scene, full.structure(), snapshots_for(store, full.size()));
  return shaken_bases(scene, full, [&]() -> const results::ShakenModes& { return modes; });
}

/// As asked, else all of a reduced model's, else as [reduction] chooses by the energies there are.
Eigen::Index modes_taken(const scene::Scene& scene, const pod::NamedBasis& choice, const std::string& file,
                         bool is_reduced, Eigen::Index asked) {
  const Eigen::Index available = choice.basis.modes();
  if (asked > available)
    throw InvalidInput(fmt::format("--modes {}: '{}' has {} {}s", asked, file, available, choice.name));
  if (asked > 0) return asked;
  if (is_reduced) return available;
  if (choice.captured.size() == 0 && scene.reduction.choice.modes == 0)
    throw InvalidInput(fmt::format("'{}' leaves the number of {}s open; say how many with --modes", file, choice.name));
  return chosen_modes(scene, scene.reduction.choice, choice.captured, available,
                      fmt::format("the {}s of '{}'", choice.name, file));
}

/// Processor time of a piece of work, of all its threads [s].
template <class Work>
double processor_time(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

std::vector<trade::OfferedBasis> offered_shaken(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                                const RunOptions& run) {
  std::optional<results::ShakenModes> made;
  double making = 0.0;
  const auto motion = [&]() -> const results::ShakenModes& {
    if (!made) {
      making = processor_time([&] { made = shaken_modes(scene, system.structure(), ensemble(scene, run).ensemble); });
    }
    return *made;
  };
  std::vector<trade::OfferedBasis> bases;
  for (const scene::BasisChoice word : scene.driven.bases) {
    trade::OfferedBasis offered{.choice = word, .basis = {}};
    offered.seconds = processor_time([&] { offered.basis = shaken_basis(word, scene, system, motion); });
    const bool from_motion = word != scene::BasisChoice::kLnm && word != scene::BasisChoice::kLnmStatic;
    if (from_motion) offered.seconds = making;  // whichever basis was made first
    bases.push_back(std::move(offered));
  }
  return bases;
}

std::vector<trade::OfferedBasis> offered_plain(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                               const RunOptions& run) {
  std::optional<pod::PodResult> result;
  double making = 0.0;
  try {
    making = processor_time([&] { result = pod::pod(ensemble(scene, run).ensemble); });
  } catch (const InvalidInput&) {
    trade::OfferedBasis lnm{.choice = scene::BasisChoice::kLnm, .basis = {}};
    lnm.seconds = processor_time([&] { lnm.basis = diagnostics::lnms_at_rest(system, system.size()); });
    return {lnm};
  }
  std::vector<trade::OfferedBasis> bases;
  for (auto& offered : plain_bases(scene, system, *result)) {
    bases.push_back({.choice = offered.name == "POM"   ? scene::BasisChoice::kPom
                               : offered.name == "LNM" ? scene::BasisChoice::kLnm
                                                       : scene::BasisChoice::kLnmStatic,
                     .basis = std::move(offered.basis),
                     .seconds = making});
  }
  return bases;
}

/// L of "pomf:3"; empty where the text is no such thing.
std::optional<Eigen::Index> mode_count(const std::string& model) {
  const std::size_t colon = model.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const auto modes = number_in<Eigen::Index>(std::string_view(model).substr(colon + 1));
  return modes.value_or(0) >= 1 ? modes : std::nullopt;
}

/// "pomf:3": a basis of the scene's own words, made as its ensemble says.
std::optional<pod::NamedBasis> worded_basis(const scene::Scene& scene, const std::string& model,
                                            const RunOptions& run) {
  const std::string word = model.substr(0, model.find(':'));
  const std::optional<Eigen::Index> modes = mode_count(model);
  for (const auto choice : {scene::BasisChoice::kPom, scene::BasisChoice::kLnm, scene::BasisChoice::kPomf,
                            scene::BasisChoice::kMassPom, scene::BasisChoice::kLnmStatic}) {
    if (scene::to_string(choice) != word || !modes) continue;
    const dynamics::HybridSystem system = scene::build_system(scene);
    std::optional<results::ShakenModes> made;
    const pod::Basis basis = shaken_basis(choice, scene, system, [&]() -> const results::ShakenModes& {
      made = shaken_modes(scene, system.structure(), ensemble(scene, run).ensemble);
      return *made;
    });
    if (*modes > basis.modes()) {
      throw InvalidInput(
          fmt::format("--model {}: there are {} such modes; valid: 1 to {}", model, basis.modes(), basis.modes()));
    }
    return pod::NamedBasis{.name = word, .basis = basis.truncated(*modes)};
  }
  return std::nullopt;
}

}  // namespace

Eigen::Index chosen_modes(const scene::Scene& scene, const pod::ModeChoice& choice, const Eigen::VectorXd& captured,
                          Eigen::Index available, const std::string& source) {
  const Eigen::Index wanted = pod::chosen_modes(choice, captured, available, source);
  const auto contacts = static_cast<Eigen::Index>(scene.contacts.size());
  return choice.modes > 0 ? wanted : std::min(available, std::max(wanted, contacts));
}

results::ShakenModes shaken_modes(const scene::Scene& scene, const fem::Structure& structure,
                                  const pod::Ensemble& snapshots) {
  results::ShakenModes modes{
      .mass_pom = pod::mass_pod(snapshots, structure.M()), .pomf = {}, .pomf_shares = {}, .mass_shares = {}};
  const Eigen::Index lnms =
      std::min(scene.sensors ? static_cast<Eigen::Index>(scene.sensors->x.size()) : kShownModes, scene.size());
  const Eigen::Index shown = std::min(lnms, modes.mass_pom.basis.modes());
  modes.mass_shares = lnm_shares(modes.mass_pom.basis.truncated(shown), structure, lnms);
  if (!scene.sensors) return modes;
  const fem::Beam beam = scene::build_beam(scene);
  const pod::SensorArray places(beam, pod::sensors_at(pod::SensorKind::kDisplacement, scene.sensors->x));
  modes.pomf = pod::pomfs(beam, places, sensor_displacements(scene, beam, places, snapshots),
                          {.family = scene.reduction.fit, .functions = scene.reduction.functions});
  modes.pomf_shares = lnm_shares(modes.pomf->basis, structure, lnms);
  return modes;
}

pod::Basis shaken_basis(scene::BasisChoice word, const scene::Scene& scene, const dynamics::HybridSystem& system,
                        const std::function<const results::ShakenModes&()>& ensemble) {
  const Eigen::Index n = system.size();
  const auto contacts = static_cast<Eigen::Index>(system.contacts().size());
  switch (word) {
    case scene::BasisChoice::kLnm:
      return rom::lnm_basis(system.structure(), std::min(n, kMostModes));
    case scene::BasisChoice::kLnmStatic:
      return rom::lnm_static_basis(system, std::min(n - contacts, kMostModes));
    case scene::BasisChoice::kPomf:
      if (const results::ShakenModes& modes = ensemble(); modes.pomf) return modes.pomf->basis;
      throw InvalidInput("basis \"pomf\": the scene has no sensors to make modal functions from; add [sensors]");
    case scene::BasisChoice::kPom:
      if (scene.beam() == nullptr) break;  // equal masses: the mass metric weighs all alike
      throw InvalidInput(
          "basis \"pom\": on a beam it would weigh displacements and rotations alike; valid: \"mass-pom\"");
    case scene::BasisChoice::kMassPom:
      break;
  }
  return ensemble().mass_pom.basis;
}

std::vector<pod::NamedBasis> shaken_bases(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                          const std::function<const results::ShakenModes&()>& motion) {
  std::vector<pod::NamedBasis> bases;
  for (const scene::BasisChoice word : scene.driven.bases) {
    bases.push_back({.name = scene::to_string(word), .basis = shaken_basis(word, scene, system, motion)});
  }
  return bases;
}

std::vector<pod::NamedBasis> plain_bases(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                         const pod::PodResult& result) {
  std::vector<pod::NamedBasis> bases = rom::pom_and_lnm(system.structure(), result);
  if (scene.reduction.basis == scene::BasisChoice::kLnm) std::swap(bases[0], bases[1]);
  const auto contacts = static_cast<Eigen::Index>(system.contacts().size());
  if (!scene.force || contacts >= system.size()) return bases;
  try {
    bases.push_back(rom::lnm_and_static(system, result));
  } catch (const InvalidInput&) {
    return bases;  // a structure that floats, or contacts side by side: there are no such modes
  }
  return bases;
}

std::vector<pod::NamedBasis> load_bases(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                        const results::StoreReader& store) {
  return is_shaken(scene) ? load_shaken_bases(scene, full, store) : load_plain_bases(scene, full, store);
}

std::vector<pod::NamedBasis> load_chosen_bases(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                               const results::StoreReader& store, Eigen::Index modes) {
  const std::string file = store.path().string();
  const bool is_reduced = results::kind_of(store) == FileKind::kReduced;
  std::vector<pod::NamedBasis> chosen;
  for (const pod::NamedBasis& basis : load_bases(scene, full, store)) {
    const Eigen::Index taken = modes_taken(scene, basis, file, is_reduced, modes);
    chosen.push_back({.name = fmt::format("{} {}s", taken, basis.name), .basis = basis.basis.truncated(taken)});
  }
  return chosen;
}

pod::NamedBasis load_basis(const scene::Scene& scene, const dynamics::HybridSystem& full, const std::string& source) {
  if (is_shaken(scene)) {
    const auto no_ensemble = []() -> const results::ShakenModes& {
      throw InvalidInput("natural modes need no ensemble");
    };
    for (const auto word : {scene::BasisChoice::kLnm, scene::BasisChoice::kLnmStatic}) {
      if (source == scene::to_string(word))
        return {.name = source, .basis = shaken_basis(word, scene, full, no_ensemble)};
    }
  }
  if (source == "lnm") return {.name = "LNM", .basis = diagnostics::lnms_at_rest(full, full.size())};
  return load_basis(scene, full, results::StoreReader(source));
}

pod::NamedBasis load_basis(const scene::Scene& scene, const dynamics::HybridSystem& full,
                           const results::StoreReader& store) {
  const Eigen::Index n = full.size();
  const FileKind kind = results::require_kind(store, std::array{FileKind::kPod, FileKind::kReduced, FileKind::kBasis});
  if (kind == FileKind::kPod) {
    if (is_shaken(scene)) {  // such a POD holds several bases: the one that reduction.basis names is taken
      scene::Scene one = scene;
      one.driven.bases = {scene.reduction.basis};
      pod::NamedBasis found = load_shaken_bases(one, full, store).front();
      found.captured = pod::cumulative(found.basis.energy);
      return found;
    }
    const pod::PodResult result = results::load_pod(store, results::kPodGroup, n);
    if (scene.reduction.basis == scene::BasisChoice::kLnm) return plain_bases(scene, full, result).front();
    return {.name = "POM", .basis = result.basis, .captured = pod::cumulative(result.shares)};
  }
  return kept_basis(store, basis_group(kind), n);
}

std::optional<pod::NamedBasis> model_basis(const scene::Scene& scene, const std::string& model, const RunOptions& run) {
  if (model == "full") return std::nullopt;
  if (const auto file = results::reduced_file(model)) {
    return pod::NamedBasis{.name = "", .basis = results::reduced_basis(results::StoreReader(*file), scene.size())};
  }
  if (!is_shaken(scene)) {
    throw InvalidInput(fmt::format("--model {}: expected full, or rom:FILE with a result of 'slipmode reduce'", model));
  }
  if (auto basis = worded_basis(scene, model, run)) return basis;
  throw InvalidInput(
      fmt::format("--model {}: expected full, rom:FILE with a result of 'slipmode reduce', or BASIS:L with pomf, lnm, "
                  "lnm+static or mass-pom, e.g. pomf:3",
                  model));
}

std::vector<trade::OfferedBasis> offered_bases(const scene::Scene& scene, const RunOptions& run) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  if (system.size() < 2) return {};
  return is_shaken(scene) ? offered_shaken(scene, system, run) : offered_plain(scene, system, run);
}

}  // namespace slipmode::studies
