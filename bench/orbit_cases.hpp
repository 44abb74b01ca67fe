#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// Period-1 orbits of S0's single mass with their multipliers, from the same simulated guess: slipmode's shooting on
/// the tangent flow beside shooting on CVODE with differences.
[[nodiscard]] Row measure_orbits(bool quick);

}  // namespace slipmode::bench
