#pragma once

#include "orbits/internal/branch_solver.hpp"

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace slipmode::orbits {

/// A converged point of a branch with all that is watched along it.
struct WatchedPoint {
  BranchEvaluation at;
  PeriodicOrbit orbit;
  Eigen::VectorXd tangent;   ///< scaled [N + e]
  Eigen::MatrixXd half_map;  ///< −Φ(T/2), where the branch is solved by half periods; else empty

  Eigen::VectorXd skew;  ///< x(T/2) + x(0), scaled [N], where the passes are run in halves; else empty

  /// Test functions: each changes sign where its kind of special point lies.
  double fold = 1.0;      ///< the parameter's share of the tangent
  double breaking = 1.0;  ///< ∏ (1 + μ) over half-period multipliers; 1 for orbits that are not symmetric
  double doubling = 1.0;  ///< ∏ (1 + μ) without trivial ones; 1 for symmetric orbits
  double torus = 1.0;     ///< ∏_{i<j} (1 − μ_i μ_j), of half-period multipliers where symmetric
};

/// @param along  direction of travel, scaled [N + e]
[[nodiscard]] WatchedPoint watch(const BranchSolver& solver, BranchEvaluation at, const Eigen::VectorXd& along);

/// What a change of word is: sticks that come or go, touches, or reversals.
[[nodiscard]] SpecialKind kind_of_word_change(const std::string& before, const std::string& after);

/// Special points between two neighbours, in order along the branch. `b` lies at the length `s` along a's tangent.
/// @param tolerance  of the parameter, absolute
[[nodiscard]] std::vector<SpecialPoint> special_points_between(const BranchSolver& solver, const WatchedPoint& a,
                                                               const WatchedPoint& b, double s, double tolerance);

}  // namespace slipmode::orbits
