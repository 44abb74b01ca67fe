#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace slipmode::bench {

/// A row without a peer: lines to print and the same figures for JSON.
struct Row {
  std::vector<std::string> lines;
  std::vector<std::pair<std::string, double>> figures;  ///< name with unit, value
};

/// Bifurcation diagram of the ten-mass chain: 500 belt speeds 0.5 … 0.001, 5,000 units each from rest, on 1 and 2
/// threads. Time on the clock.
[[nodiscard]] Row measure_sweep(bool coulomb, bool quick);

/// Six POMs of 1,000 masses with ground springs: full and reduced run in the same process, cost of the basis (run,
/// decomposition) apart, and the number of runs after which it is paid for.
[[nodiscard]] Row measure_reduction(bool quick);

/// POD of 10⁵ snapshots of 1,000 masses: first as a stream in blocks, then from one matrix in memory. Peak memory of
/// the process after each.
[[nodiscard]] Row measure_pod(bool quick);

}  // namespace slipmode::bench
