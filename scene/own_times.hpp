#pragma once

#include <slipmode/scene/scene.hpp>

namespace slipmode::scene {

/// The scene with the times of a belt's [validation] that it does not give taken from its structure's slowest natural
/// period T₁, contacts slipping: transient 24 T₁, block and sweep_limit 120, limit 2400, horizon 2.4, lyapunov_duration
/// 480, cost_duration 240, each to one digit; and the speeds, where it gives none, in steps of a twentieth of its own
/// up to 2.5 times that. Unchanged without a belt, and where nothing vibrates.
[[nodiscard]] Scene with_own_times(Scene scene);

}  // namespace slipmode::scene
