#pragma once

#include <slipmode/orbits/branches/continuation.hpp>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

/// A converged point of a branch with all that is watched along it.
///
/// A Solver corrects points of a branch, and says of them what is watched: BranchSolver by shooting,
/// BalanceBranchSolver by balance.
template <class Solver>
struct WatchedPoint {
  typename Solver::Evaluation at;
  PeriodicOrbit orbit;
  std::optional<Balance> balance;  ///< of a branch of these
  Eigen::VectorXd tangent;         ///< scaled [N + e]
  Eigen::MatrixXd half_map;        ///< −Φ(T/2), where the branch is solved by half periods; else empty
  /// What vanishes where orbits become those of a simpler branch, beyond which they are the same ones again; scaled,
  /// empty where there is none.
  Eigen::VectorXd skew;    ///< x(T/2) + x(0): symmetric ones
  Eigen::VectorXd halves;  ///< x(T/2) − x(0): those of half the period
  Eigen::VectorXd rate;    ///< ẋ(0): a state of rest

  /// Test functions: each changes sign where its kind of special point lies.
  double fold = 1.0;      ///< the parameter's share of the tangent
  double breaking = 1.0;  ///< ∏ (1 + μ) over half-period multipliers; 1 for orbits that are not symmetric
  double doubling = 1.0;  ///< ∏ (1 + μ) without trivial ones; 1 for symmetric orbits
  double torus = 1.0;     ///< ∏_{i<j} (1 − μ_i μ_j), of half-period multipliers where symmetric
};

/// @param along  direction of travel, scaled [N + e]
template <class Solver>
[[nodiscard]] WatchedPoint<Solver> watch(const Solver& solver, typename Solver::Evaluation at,
                                         const Eigen::VectorXd& along);

/// Where pieces of a branch meet, det [J; tᵀ] keeps its sign along it (as in piecewise-linear homotopies): beyond a
/// corner at which the branch turns back, the other piece's tangent leads away from it. Turns that of a `point` with
/// another word than the last one where it does not.
template <class Solver>
void keep_orientation(const WatchedPoint<Solver>& last, WatchedPoint<Solver>& out_point);

/// A change of word in words.
[[nodiscard]] std::string word_change(const PeriodicOrbit& before, const PeriodicOrbit& after);
/// What a change of word is: sticks that come or go, touches, or reversals.
[[nodiscard]] SpecialKind kind_of_word_change(const std::string& before, const std::string& after);

template <class Solver>
struct SpecialPoints {
  std::vector<SpecialPoint> points;           ///< in order along the branch
  std::optional<WatchedPoint<Solver>> joins;  ///< the last orbit, where the last of them ends the branch
};

/// Special points between two neighbours. `b` lies at the length `s` along a's tangent.
/// @param tolerance  of the parameter, absolute
template <class Solver>
[[nodiscard]] SpecialPoints<Solver> special_points_between(const Solver& solver, const WatchedPoint<Solver>& a,
                                                           const WatchedPoint<Solver>& b, double s, double tolerance);

}  // namespace slipmode::orbits
