#include <slipmode/core/numbers.hpp>
#include <slipmode/results/provenance.hpp>

#include <slipmode/results/records.hpp>

#include <utility>

namespace slipmode::results {

namespace {

constexpr const char* kGroup = "provenance";
constexpr const char* kAuditGroup = "provenance/audit";

std::string inside(const char* name) { return std::string(kGroup) + "/" + name; }

}  // namespace

Provenance provenance_of(const scene::Scene& scene, std::string command) {
  Provenance provenance;
  provenance.scene_path = scene.source.path;
  provenance.scene_text = scene.source.text;
  provenance.overrides = scene.source.overrides;
  provenance.command = std::move(command);
  provenance.version = version();
  provenance.git_commit = git_commit();
  provenance.compiler = compiler();
  provenance.seed = scene.ensemble.seed;
  return provenance;
}

void save(StoreWriter& store, const Provenance& provenance) {
  store.describe_group(kGroup, "how this file was made: enough to make it again");
  store.write(inside("scene_path"), provenance.scene_path, {"", "scene file as given"});
  store.write(inside("scene_text"), provenance.scene_text, {"", "scene as read, before overrides (TOML)"});
  store.write(inside("overrides"), provenance.overrides, {"", "path=value, in order"});
  store.write(inside("command"), provenance.command, {"", "command line"});
  store.write(inside("version"), provenance.version, {"", "version of slipmode"});
  store.write(inside("git_commit"), provenance.git_commit, {"", "commit slipmode was built from"});
  store.write(inside("compiler"), provenance.compiler, {"", "compiler slipmode was built with"});
  store.write(inside("seed"), std::to_string(provenance.seed), {"", "seed of the random numbers (unsigned, 64 bit)"});
  if (provenance.audit) save(store, kAuditGroup, *provenance.audit);
}

Provenance load_provenance(const StoreReader& store) {
  Provenance provenance;
  provenance.scene_path = store.text(inside("scene_path"));
  provenance.scene_text = store.text(inside("scene_text"));
  provenance.overrides = store.texts(inside("overrides"));
  provenance.command = store.text(inside("command"));
  provenance.version = store.text(inside("version"));
  provenance.git_commit = store.text(inside("git_commit"));
  provenance.compiler = store.text(inside("compiler"));
  const std::string seed = store.text(inside("seed"));
  const auto number = number_in<decltype(provenance.seed)>(seed);
  if (!number) store.fail(inside("seed"), "'" + seed + "'; expected an unsigned integer");
  provenance.seed = *number;
  if (store.has(kAuditGroup)) provenance.audit = load_audit(store, kAuditGroup);
  return provenance;
}

scene::Scene load_scene_of(const StoreReader& store) {
  const Provenance provenance = load_provenance(store);
  return scene::parse_scene(provenance.scene_text, provenance.overrides, provenance.scene_path);
}

}  // namespace slipmode::results
