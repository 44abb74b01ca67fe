#pragma once

#include "bench/comparison.hpp"

#include <string>
#include <vector>

namespace slipmode::bench {

/// Times in ms per 10⁴ units of simulated time; ratios of times; errors of the state.
[[nodiscard]] std::string comparison_header();
[[nodiscard]] std::string comparison_line(const Comparison& row);
[[nodiscard]] std::string tanh_header();
[[nodiscard]] std::string tanh_line(const TanhFigures& row);

/// The processor's model as the system names it.
[[nodiscard]] std::string cpu_model();

}  // namespace slipmode::bench
