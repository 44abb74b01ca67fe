#pragma once

#include <slipmode/orbits/branches/continuation.hpp>

namespace slipmode::orbits {

/// A branch from a point on: steps, special points, and why it ended. One way, or both ways in order along the branch.
/// @param solver  BranchSolver or BalanceBranchSolver
template <class Solver>
[[nodiscard]] Branch walk_branch(const Solver& solver, const ContinuationOptions& options, const BranchPoint& from);

/// @throws InvalidInput  for a range without length, a start outside it, steps that are not positive
void check_continuation(double parameter, const ContinuationOptions& options);

}  // namespace slipmode::orbits
