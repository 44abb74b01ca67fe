#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/trade/case.hpp>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace slipmode::trade {

/// Time of a run of one length, in this process, on one thread.
struct RunCost {
  double wall = std::numeric_limits<double>::quiet_NaN();  ///< median of the repeats [s of clock]
  double cpu = std::numeric_limits<double>::quiet_NaN();   ///< median [s of processor]
  double cpu_low = 0.0, cpu_high = 0.0;                    ///< least and largest of the repeats [s of processor]
  double setup = 0.0;  ///< building, projecting, modal data: the first run's excess over the median [s of processor]
  double simulated = 0.0;  ///< length of the run [s]
  std::string failure = {};

  /// Processor time of one run of another length, set-up included [s].
  [[nodiscard]] double of_run(double duration) const { return setup + cpu * duration / simulated; }
};

/// What is timed: makes its case anew, so that set-up is seen, and says where it starts.
struct Timed {
  std::function<Case()> build;
  std::function<dynamics::State(const Case&)> start;
};

/// Runs each once, then all by turns, `repeats` times: a machine that slows down slows all alike. Nothing is sampled.
/// Processor time rather than the clock's is what costs are compared by: other programs do not count.
/// @throws InvalidInput  for simulated ≤ 0 or repeats < 1
/// @throws Interrupted   if the stop flag was set
[[nodiscard]] std::vector<RunCost> measure_costs(const std::vector<Timed>& all, double simulated, int repeats,
                                                 const ParallelOptions& options = {});

}  // namespace slipmode::trade
