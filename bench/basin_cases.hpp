#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// Basins of S2's three planes over [−2, 2]²: attractors and labels by slipmode beside dopri5 with events, over the
/// same periods and until its motion repeats; where the peer's motions end is then judged by slipmode.
[[nodiscard]] Row measure_basins(bool quick);

}  // namespace slipmode::bench
