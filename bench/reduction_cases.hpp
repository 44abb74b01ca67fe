#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// From what size on a reduced model pays: chains of 10 to 3,000 masses (ground springs from 30 on) beside six modes of
/// each: POMs, at 3,000 masses a static mode and five natural ones. Times of full and reduced model by turns, from
/// rest, audit on; steps and events, which differ; cost of the basis, and the number of runs after which it is paid
/// for.
/// @param quick  up to 300 masses, a tenth of the simulated time
[[nodiscard]] Row measure_reduction(bool quick);

}  // namespace slipmode::bench
