#pragma once

#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>

namespace slipmode::results {

/// Writes groups `ensemble`, `members`, `provenance` and, where the scene has sensors, `sensors`.
void store_ensemble(StoreWriter& writer, const scene::Scene& scene, const diagnostics::EnsembleRun& run);

/// Writes the group `sensors`: their places and readings of these displacements.
void store_sensors(StoreWriter& writer, const scene::Scene& scene, const Eigen::MatrixXd& q);

/// Reads what a POD can be made of: an ensemble, or the samples of one trajectory or orbit.
/// @throws InvalidInput  when the file holds neither
[[nodiscard]] pod::Ensemble load_snapshots(const StoreReader& store);

}  // namespace slipmode::results
