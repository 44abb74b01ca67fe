#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include "bench/chain_problem.hpp"

namespace slipmode::bench {

/// The same chain as the library takes it, nothing set up yet.
[[nodiscard]] dynamics::HybridSystem system_of(const ChainProblem& problem);

/// A state on the attractor from which every method starts: `transient` after rest, and on from there until the contact
/// slips at 0.02 or faster, so that no method begins on a guard. Time 0, modes left empty.
[[nodiscard]] dynamics::State start_on_attractor(const dynamics::HybridSystem& system, double transient);

/// States of one long run, `spacing` apart or a little more, each chosen like the start.
[[nodiscard]] std::vector<dynamics::State> starts_on_attractor(const dynamics::HybridSystem& system,
                                                               const dynamics::State& first, double spacing, int count);

}  // namespace slipmode::bench
