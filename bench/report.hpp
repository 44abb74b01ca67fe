#pragma once

#include "bench/comparison.hpp"
#include "bench/library_cases.hpp"

#include <string>

namespace slipmode::bench {

/// Times in ms per 10⁴ units of simulated time, and their ratios; a + behind the set-up where it counts.
[[nodiscard]] std::string time_header();
[[nodiscard]] std::string time_line(const Comparison& row);
/// What the history keeps of a row.
[[nodiscard]] Timed timed(const Comparison& row);
/// Errors of the state and whether every method finds the reference's events.
[[nodiscard]] std::string error_header();
[[nodiscard]] std::string error_line(const Comparison& row);
[[nodiscard]] std::string tanh_header();
[[nodiscard]] std::string tanh_line(const TanhFigures& row);

}  // namespace slipmode::bench
