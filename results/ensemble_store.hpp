#pragma once

#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>

namespace slipmode::results {

/// A sink that keeps finished members, snapshots and all, in a journal and takes over those it already holds. The
/// journal must outlive it. Of members that one process computes alone, one a second is kept: to keep many short ones
/// would take as long as to compute them.
[[nodiscard]] diagnostics::EnsembleSink ensemble_sink(Journal& journal);

/// Writes groups `ensemble`, `members` and, where the scene has sensors, `sensors`.
void store_ensemble(StoreWriter& writer, const scene::Scene& scene, const diagnostics::EnsembleRun& run);

/// Writes the group `sensors`: their places and readings of these displacements.
void store_sensors(StoreWriter& writer, const scene::Scene& scene, const Eigen::MatrixXd& q);

/// Reads what a POD can be made of: an ensemble, or the samples of one trajectory or orbit.
/// @throws InvalidInput  when the file holds neither
[[nodiscard]] pod::Ensemble load_snapshots(const StoreReader& store);

}  // namespace slipmode::results
