#pragma once

#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>

namespace slipmode::studies {

/// Runs what [ensemble] asks for: `members` starts (see scene::ensemble_states) at each of its belt speeds or shaker
/// frequencies; a belt that is not constant, or a force, keeps its own.
/// @throws as diagnostics::run_ensemble
[[nodiscard]] diagnostics::EnsembleRun ensemble(const scene::Scene& scene, const RunOptions& run = {});

}  // namespace slipmode::studies
