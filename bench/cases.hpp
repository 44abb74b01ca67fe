#pragma once

#include "bench/comparison.hpp"

namespace slipmode::bench {

/// Rows of the main table. @param quick  a tenth of the time simulated, fewer repeats
[[nodiscard]] std::vector<ComparisonCase> comparison_cases(bool quick);

}  // namespace slipmode::bench
