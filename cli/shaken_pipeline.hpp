#pragma once

#include <slipmode/scene/scene.hpp>
#include "cli/session.hpp"

#include <filesystem>

namespace slipmode::cli {

/// `slipmode run` for a scene with a shaker: modes, trajectory, ensemble, sensors, POMFs, reduced models, validation
/// sweeps, figures. Runs what the scene asks for and leaves files and figures in `folder`.
[[nodiscard]] Report run_shaken_pipeline(const Session& session, const scene::Scene& scene,
                                         const std::filesystem::path& folder);

}  // namespace slipmode::cli
