#pragma once

#include <slipmode/orbits/branches/special_curve.hpp>
#include "orbits/internal/shooting_problem.hpp"

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

/// What keeps a branch over two parameters on a curve of special points.
struct CurveCondition {
  SpecialKind kind = SpecialKind::kFold;
  KeyRange other;           ///< of the parameter that is solved for
  std::size_t contact = 0;  ///< of a grazing: which contact
  int side = 0;             ///< +1 its right stop, −1 its left one
  double touch = 0.0;       ///< when, as a share of the period after the origin; at first
};
/// A branch that turns back at a grazing is followed as that.
[[nodiscard]] CurveCondition condition_of(const SpecialPoint& special, const KeyRange& other);

/// Way from the middle of a contact's gap to a stop [m]; nothing where it has none on that side.
[[nodiscard]] std::optional<double> gap_towards(const friction::Contact& contact, int side);

/// Of a grazing, of the motion: its orbits are those that stay this far off the stop, on the side that knows no touch.
inline constexpr double kUntouched = 1e-10;

/// Where a contact is nearest to a stop: a local extreme of its displacement.
struct Touch {
  double clearance = 0.0;  ///< way left to the stop, negative beyond it [m]
  double share = 0.0;      ///< when, as a share of the period after the origin
};
/// The distance between shares of the period, at most a half.
[[nodiscard]] double shares_apart(double a, double b);

/// The extreme nearest in time to a share of the period. Where half periods are run, those towards the other stop are
/// their mirror images half a period on.
/// @throws NumericalFailure  where there is none
[[nodiscard]] Touch touch_near(ShootingProblem& problem, const ShootingPoint& point, const CurveCondition& condition,
                               double share);
/// The contact, side and share at which the point comes nearest to any stop.
/// @throws InvalidInput  as nearest_touch
[[nodiscard]] CurveCondition grazed(ShootingProblem& problem, const ShootingPoint& point, const CurveCondition& like);
/// The same of any motion. @param touches  the extremes of a contact towards a side @param size  of the motion
/// @throws InvalidInput  where the nearest is not within 1e-4 of the size: no stop is grazed
[[nodiscard]] CurveCondition nearest_touch(
    std::size_t contacts, double size, const CurveCondition& like,
    const std::function<std::vector<Touch>(std::size_t contact, int side)>& touches);

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
[[nodiscard]] MultiplierPair critical_pair(const Eigen::VectorXcd& multipliers,
                                           const std::optional<MultiplierPair>& near);
/// Why a curve of Neimark-Sacker points ends at a pair; empty where it goes on.
[[nodiscard]] std::string resonance_met(const MultiplierPair& pair);
/// uᵀA v with the singular vectors of the least singular value at `from`: near it as smooth as A, and zero where A is
/// singular.
[[nodiscard]] std::function<double(const Eigen::MatrixXd& A)> least_singular_value_near(const Eigen::MatrixXd& from);
/// Of DP where half periods are run.
[[nodiscard]] Eigen::VectorXcd multipliers_of(const Eigen::MatrixXd& J, Eigen::Index states, bool half_period);
/// The slowest speed at which a stop is reached; infinite where none is [m/s].
[[nodiscard]] double slowest_touch(const std::vector<dynamics::Event>& events);

/// Step of a condition's differences. @param matrix  that closes the orbits, by the unknowns without parameters
[[nodiscard]] double condition_step(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
/// One equation more.
void append(const Eigen::RowVectorXd& row, double value, Eigen::MatrixXd& out_J, Eigen::VectorXd& out_r);

/// Derivatives of a condition in the directions in which the branch goes on, and towards it; in others zero, as
/// Newton's method on J needs no more.
/// @param J, r   closing conditions, two columns more than rows
/// @param value  the condition a step away; nothing outside of the parameters' ranges
[[nodiscard]] Eigen::RowVectorXd condition_row(
    const Eigen::MatrixXd& J, const Eigen::VectorXd& r, double here, double step,
    const std::function<std::optional<double>(const Eigen::VectorXd& step)>& value);

}  // namespace slipmode::orbits
