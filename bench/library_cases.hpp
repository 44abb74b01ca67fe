#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace slipmode::bench {

/// What the history keeps of a case; 0: does not apply.
struct Timed {
  std::string name;
  double ms = 0.0;  ///< what the case is about, audit on
  double audit_on_off = 0.0;
  double ratio_cvode = 0.0, ratio_dopri5 = 0.0;
  double error = 0.0;
};

/// A row of a table of its own: lines to print and the same figures for JSON.
struct Row {
  std::vector<std::string> lines;
  std::vector<std::pair<std::string, double>> figures;  ///< name with unit, value
  std::vector<Timed> timed = {};
};

/// Bifurcation diagram of the ten-mass chain: 500 belt speeds 0.5 … 0.001, 5,000 units each from rest, on 1 and 2
/// threads, audit on, and on 2 without. Time on the clock.
[[nodiscard]] Row measure_sweep(bool coulomb, bool quick);

/// POD of 10⁵ snapshots of 1,000 masses: first as a stream in blocks, then from one matrix in memory. Peak memory of
/// the process after each.
[[nodiscard]] Row measure_pod(bool quick);

}  // namespace slipmode::bench
