#include "cli/shaken_bases.hpp"

#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/mode_shares.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/json_values.hpp"
#include "cli/steps.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

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
  pod::Ensemble readings = with_snapshots(snapshots, sensor_readings(scene, beam, snapshots.snapshots));
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

Json rows_of(const Eigen::MatrixXd& table) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < table.rows(); ++i) {
    const Eigen::VectorXd row = table.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

std::string share_table(const std::string& name, const Eigen::MatrixXd& shares) {
  std::vector<std::string> header = {name};
  for (Eigen::Index k = 0; k < shares.cols(); ++k) header.push_back(fmt::format("LNM {}", k + 1));
  TextTable table(header);
  for (Eigen::Index i = 0; i < shares.rows(); ++i) {
    std::vector<std::string> row = {fmt::format("{}", i + 1)};
    for (Eigen::Index k = 0; k < shares.cols(); ++k) row.push_back(fixed(100.0 * shares(i, k), 2));
    table.add(std::move(row));
  }
  return table.str();
}

}  // namespace

Eigen::MatrixXd sensor_readings(const scene::Scene& scene, const fem::Beam& beam, const Eigen::MatrixXd& q) {
  const Eigen::MatrixXd exact = scene::sensor_array(scene, beam).readings(q);
  return scene.sensors->noise > 0.0 ? pod::with_noise(exact, scene::sensor_noise(scene)) : exact;
}

void store_sensors(results::StoreWriter& writer, const scene::Scene& scene, const Eigen::MatrixXd& q) {
  const bool strain = scene.sensors->kind == pod::SensorKind::kStrain;
  writer.describe_group("sensors", "what the scene's sensors read, noise included");
  writer.write("sensors/x", scene.sensors->x, {"m", "places, from the clamp"});
  writer.write("sensors/kind", std::string(strain ? "strain" : "displacement"), {"", "what they read"});
  writer.write_columns("sensors/readings", sensor_readings(scene, scene::build_beam(scene), q),
                       {strain ? "1" : "m", "time x sensor"});
}

ShakenModes shaken_modes(const scene::Scene& scene, const fem::Structure& structure, const pod::Ensemble& snapshots) {
  ShakenModes modes{
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

void save(results::StoreWriter& writer, const ShakenModes& modes) {
  results::save(writer, results::kPodGroup, modes.mass_pom);
  writer.write("pod/lnm_shares", modes.mass_shares, {"1", "mode x LNM: share of each LNM, mass metric"});
  if (!modes.pomf) return;
  const std::string group = kPomfGroup;
  writer.describe_group(group, "proper orthogonal modal functions from the sensors");
  results::save(writer, group + "/basis", modes.pomf->basis);
  writer.write(group + "/sensor_shares", modes.pomf->discrete.shares, {"1", "energy share of each POM at the sensors"});
  writer.write(group + "/mass_shares", modes.pomf->mass_shares, {"1", "share of each POMF in the fitted motion"});
  writer.write(group + "/lnm_shares", modes.pomf_shares, {"1", "POMF x LNM: share of each LNM, mass metric"});
  writer.write(group + "/condition", modes.pomf->condition, {"1", "how much the fit magnifies noise, at worst"});
}

std::string text_of(const ShakenModes& modes) {
  const auto line = [](const std::string& what, const Eigen::VectorXd& shares) {
    std::string out = what + ":";
    for (Eigen::Index i = 0; i < std::min(kShownModes, shares.size()); ++i) {
      out += fmt::format(" {:.4f}", 100.0 * shares[i]);
    }
    return out + " %\n";
  };
  std::string out = line("energy of POMs of all degrees of freedom, mass metric", modes.mass_pom.shares);
  if (modes.pomf) {
    out += line("energy of POMs at the sensors", modes.pomf->discrete.shares);
    out += line("energy of POMFs", modes.pomf->mass_shares);
    out += fmt::format("share of linear natural modes in each POMF [%]\n{}", share_table("POMF", modes.pomf_shares));
  }
  return out + fmt::format("share of linear natural modes in each POM of the mass metric [%]\n{}",
                           share_table("mass POM", modes.mass_shares));
}

Json json_of(const ShakenModes& modes) {
  Json out = {{"mass_pom",
               {{"shares", results::values_of(modes.mass_pom.shares)}, {"lnm_shares", rows_of(modes.mass_shares)}}}};
  if (!modes.pomf) return out;
  out["pomf"] = {{"sensor_shares", results::values_of(modes.pomf->discrete.shares)},
                 {"mass_shares", results::values_of(modes.pomf->mass_shares)},
                 {"lnm_shares", rows_of(modes.pomf_shares)},
                 {"condition", modes.pomf->condition}};
  return out;
}

pod::Basis shaken_basis(scene::BasisChoice word, const scene::Scene& scene, const dynamics::HybridSystem& system,
                        const std::function<const ShakenModes&()>& ensemble) {
  const Eigen::Index n = system.size();
  const auto contacts = static_cast<Eigen::Index>(system.contacts().size());
  switch (word) {
    case scene::BasisChoice::kLnm:
      return rom::lnm_basis(system.structure(), std::min(n, kMostModes));
    case scene::BasisChoice::kLnmStatic:
      return rom::lnm_static_basis(system, std::min(n - contacts, kMostModes));
    case scene::BasisChoice::kPomf:
      if (const ShakenModes& modes = ensemble(); modes.pomf) return modes.pomf->basis;
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

std::vector<diagnostics::DrivenCandidate> shaken_candidates(const scene::Scene& scene,
                                                            const dynamics::HybridSystem& system,
                                                            const std::function<const ShakenModes&()>& ensemble) {
  std::vector<diagnostics::DrivenCandidate> candidates;
  for (const scene::BasisChoice word : scene.shaken.bases) {
    candidates.push_back({.name = scene::to_string(word), .basis = shaken_basis(word, scene, system, ensemble)});
  }
  return candidates;
}

std::vector<diagnostics::DrivenCandidate> load_shaken_candidates(const scene::Scene& scene,
                                                                 const dynamics::HybridSystem& system,
                                                                 const std::string& file) {
  const results::StoreReader store(file);
  if (store.has(results::kReducedGroup)) {
    const pod::Basis basis = results::load_basis(store, std::string(results::kReducedGroup) + "/basis", system.size());
    return {{.name = std::string(pod::to_string(basis.kind)), .basis = basis}};
  }
  ShakenModes modes;
  if (store.has(results::kPodGroup)) {
    modes.mass_pom = results::load_pod(store, results::kPodGroup, system.size());
    if (store.has(kPomfGroup)) {
      modes.pomf.emplace();
      modes.pomf->basis = results::load_basis(store, std::string(kPomfGroup) + "/basis", system.size());
    }
  } else {
    const pod::Ensemble ensemble = load_snapshots(store);
    if (ensemble.snapshots.rows() != system.size()) {
      store.fail(results::kEnsembleGroup, fmt::format("expected {} degrees of freedom as in the scene, found {}",
                                                      system.size(), ensemble.snapshots.rows()));
    }
    modes = shaken_modes(scene, system.structure(), ensemble);
  }
  return shaken_candidates(scene, system, [&]() -> const ShakenModes& { return modes; });
}

}  // namespace slipmode::cli
