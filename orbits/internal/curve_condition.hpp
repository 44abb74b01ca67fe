#pragma once

#include <slipmode/orbits/special_curve.hpp>
#include "orbits/internal/shooting_problem.hpp"

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace slipmode::orbits {

/// What keeps a branch over two parameters on a curve of special points.
struct CurveCondition {
  SpecialKind kind = SpecialKind::kFold;
  KeyRange other;           ///< of the parameter that is solved for
  std::size_t contact = 0;  ///< of a grazing: which contact
  int side = 0;             ///< +1 its right stop, −1 its left one
  double touch = 0.0;       ///< when, as a share of the period after the origin; at first
};

/// Where a contact is nearest to a stop: a local extreme of its displacement.
struct Touch {
  double clearance = 0.0;  ///< way left to the stop, negative beyond it [m]
  double share = 0.0;      ///< when, as a share of the period after the origin
};

/// The extreme nearest in time to a share of the period. Where half periods are run, those towards the other stop are
/// their mirror images half a period on.
/// @throws NumericalFailure  where there is none
[[nodiscard]] Touch touch_near(ShootingProblem& problem, const ShootingPoint& point, const CurveCondition& condition,
                               double share);
/// The contact, side and share at which the point comes nearest to any stop.
/// @throws InvalidInput  where that is not within 1e-4 of the motion's size: no stop is grazed
[[nodiscard]] CurveCondition grazed(ShootingProblem& problem, const ShootingPoint& point, const CurveCondition& like);

/// The matrix that is singular at a point of the kind. @param J  closing conditions, and phase; by columns x, [ln T]
[[nodiscard]] Eigen::MatrixXd critical_matrix(SpecialKind kind, const Eigen::MatrixXd& J, Eigen::Index states,
                                              bool half_period);
/// Two multipliers, complex or both real; of DP where half periods are run. Smooth also where they meet.
struct MultiplierPair {
  double sum = 0.0, product = 1.0;

  [[nodiscard]] bool complex() const { return sum * sum < 4.0 * product; }
};
/// The pair nearest to another, or the one whose product is nearest to 1.
/// @throws NumericalFailure  where there is no pair
[[nodiscard]] MultiplierPair critical_pair(const Eigen::MatrixXd& J, Eigen::Index states, bool half_period,
                                           const std::optional<MultiplierPair>& near);
/// The slowest speed at which a stop is reached; infinite where none is [m/s].
[[nodiscard]] double slowest_touch(const std::vector<dynamics::Event>& events);

/// Derivatives of a condition in the directions in which the branch goes on, and towards it; in others zero, as
/// Newton's method on J needs no more.
/// @param J, r   closing conditions, two columns more than rows
/// @param value  the condition a step away; nothing outside of the parameters' ranges
[[nodiscard]] Eigen::RowVectorXd condition_row(
    const Eigen::MatrixXd& J, const Eigen::VectorXd& r, double here, double step,
    const std::function<std::optional<double>(const Eigen::VectorXd& step)>& value);

}  // namespace slipmode::orbits
