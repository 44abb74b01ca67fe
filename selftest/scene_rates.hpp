#pragma once

#include <slipmode/dynamics/system.hpp>

namespace slipmode::selftest {

/// What nothing is taken to be slower than [1/s].
inline constexpr double kSlowest = 1e-3;

/// A bound on how fast anything in the system changes once it slides, from its numbers alone: none of the flow's [1/s].
[[nodiscard]] double fastest_rate(const dynamics::HybridSystem& system, const dynamics::State& start);

}  // namespace slipmode::selftest
