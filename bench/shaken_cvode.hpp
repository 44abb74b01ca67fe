#pragma once

#include "bench/shaken_peers.hpp"

namespace slipmode::bench {

/// CVODE's part of run_shaken. @param method  kAdams or kBdf
[[nodiscard]] ShakenRun run_shaken_cvode(ShakenMethod method, const ShakenProblem& problem, const ShakenPoint& start,
                                         double duration, double tolerance);

}  // namespace slipmode::bench
