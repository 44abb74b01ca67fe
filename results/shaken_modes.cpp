#include <slipmode/results/shaken_modes.hpp>

#include <slipmode/results/records.hpp>

#include <string>

namespace slipmode::results {

void save(StoreWriter& writer, const ShakenModes& modes) {
  save(writer, kPodGroup, modes.mass_pom);
  writer.write("pod/lnm_shares", modes.mass_shares, {"1", "mode x LNM: share of each LNM, mass metric"});
  if (!modes.pomf) return;
  const std::string group = kPomfGroup;
  writer.describe_group(group, "proper orthogonal modal functions from the sensors");
  save(writer, group + "/basis", modes.pomf->basis);
  writer.write(group + "/sensor_shares", modes.pomf->discrete.shares, {"1", "energy share of each POM at the sensors"});
  writer.write(group + "/mass_shares", modes.pomf->mass_shares, {"1", "share of each POMF in the fitted motion"});
  writer.write(group + "/lnm_shares", modes.pomf_shares, {"1", "POMF x LNM: share of each LNM, mass metric"});
  writer.write(group + "/condition", modes.pomf->condition, {"1", "how much the fit magnifies noise, at worst"});
}

ShakenModes load_shaken_modes(const StoreReader& store, Eigen::Index n) {
  ShakenModes modes;
  modes.mass_pom = load_pod(store, kPodGroup, n);
  if (store.has(kPomfGroup)) {
    modes.pomf.emplace();
    modes.pomf->basis = load_basis(store, std::string(kPomfGroup) + "/basis", n);
  }
  return modes;
}

}  // namespace slipmode::results
