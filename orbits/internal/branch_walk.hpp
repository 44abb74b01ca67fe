#pragma once

#include "orbits/internal/branch_solver.hpp"

namespace slipmode::orbits {

/// One way along a branch, from an orbit at `parameter` on: steps, special points, and why it ended.
/// @param direction  ±1, of the parameter at first
[[nodiscard]] Branch walk_branch(const BranchSolver& solver, const ContinuationOptions& options,
                                 const PeriodicOrbit& orbit, double parameter, int direction);

}  // namespace slipmode::orbits
