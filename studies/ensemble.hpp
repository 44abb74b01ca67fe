#pragma once

#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <memory>
#include <optional>

namespace slipmode::studies {

/// Runs what [ensemble] asks for: `members` starts (see scene::ensemble_states) at each of its belt speeds or
/// frequencies of the drive; a belt that is not constant keeps its own.
/// @param journal  keeps finished members and gives back earlier ones; nullptr: in memory only
/// @throws as diagnostics::run_ensemble
[[nodiscard]] diagnostics::EnsembleRun ensemble(const scene::Scene& scene, const RunOptions& run = {},
                                                results::Journal* journal = nullptr);

/// Each member is one.
[[nodiscard]] Pieces ensemble_pieces(const scene::Scene& scene);

/// What provenance of it says.
inline constexpr const char* kEnsembleCommand = "slipmode simulate";
[[nodiscard]] std::optional<dynamics::EnergyAudit> audit_of(const diagnostics::EnsembleRun& ensemble);

/// The same as several processes: this one's part of the members, see diagnostics::EnsembleOptions. Side by side in
/// order, their snapshots are the ensemble's; there may be none [n x 0].
/// @param part  from 1 to parts
/// @throws InvalidInput  also under a shaker
[[nodiscard]] diagnostics::EnsembleRun ensemble_part(const scene::Scene& scene, std::size_t part, std::size_t parts,
                                                     const RunOptions& run = {});

/// What is kept of it. Shares its snapshots.
[[nodiscard]] results::Content content_of(const scene::Scene& scene,
                                          const std::shared_ptr<const diagnostics::EnsembleRun>& ensemble);

}  // namespace slipmode::studies
