#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// False nearest neighbours in dimensions 1 … 10 and the correlation sum in dimension 6 of 10⁵ samples, every sample a
/// reference, beside a search over all pairs. Lorenz's system and white noise. Time on the clock, two threads for both.
[[nodiscard]] Row measure_series(bool quick);

}  // namespace slipmode::bench
