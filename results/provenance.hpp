#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::results {

/// slipmode's version, for example "0.1.0".
[[nodiscard]] std::string version();
/// Commit the library was built from, with "-dirty" when tracked files differed; "v" and the version when it was built
/// from sources that do not know their commit.
[[nodiscard]] std::string git_commit();
/// Compiler and its version, for example "GNU 12.2.0".
[[nodiscard]] std::string compiler();

/// Where a result came from: enough to make it again.
struct Provenance {
  std::string scene_path;
  std::string scene_text;              ///< as read, before overrides
  std::vector<std::string> overrides;  ///< "drive.speed=0.25", in order
  std::string command;                 ///< the verb and its arguments; empty when used as a library
  std::string version, git_commit, compiler;
  std::uint64_t seed = 0;
  std::optional<dynamics::EnergyAudit> audit;  ///< of the run stored; of the worst of several
};

/// Provenance of a result made from `scene` by this build.
[[nodiscard]] Provenance provenance_of(const scene::Scene& scene, std::string command = {});

/// Writes the group "provenance".
void save(StoreWriter& store, const Provenance& provenance);
[[nodiscard]] Provenance load_provenance(const StoreReader& store);

/// The scene a result was made from, overrides applied. @throws InvalidInput when the file has no provenance
[[nodiscard]] scene::Scene load_scene_of(const StoreReader& store);

}  // namespace slipmode::results
