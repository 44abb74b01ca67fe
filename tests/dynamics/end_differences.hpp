#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"

namespace slipmode::dynamics {

/// d(final state)/d(start) by fourth-order central differences of runs: for tangents told to 1e-7, far above what the
/// differences leave out.
[[nodiscard]] inline Eigen::MatrixXd slopes_of_end(const HybridSystem& system, const State& start, double duration,
                                                   const FlowOptions& flow) {
  const auto end_of = [&](const State& from) {
    return fixtures::stacked(simulate(system, from, {.duration = duration, .flow = flow}).final_state);
  };
  return fixtures::slopes(start, end_of, 3e-4);
}

}  // namespace slipmode::dynamics
