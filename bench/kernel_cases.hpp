#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// The roof over the step kernels: fused multiply-adds per second from registers to registers, for each width of
/// vectors the processor has, on one thread. What a kernel does per second stands beside the one for its width.
[[nodiscard]] Row measure_kernels(bool quick);

}  // namespace slipmode::bench
