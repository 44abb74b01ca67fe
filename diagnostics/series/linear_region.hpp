#pragma once

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// A straight line through part of a curve, by least squares.
struct LinearFit {
  Eigen::Index begin = 0;  ///< first point used
  Eigen::Index end = 0;    ///< one past the last
  double slope = 0.0;      ///< [y/x]
  double intercept = 0.0;  ///< y at x = 0
  double residual = 0.0;   ///< root mean square distance of the points from the line [y]
  double curvature = 0.0;  ///< half the difference between the slopes of its first and its second half [y/x]
};

/// Least-squares line through points begin … end − 1.
/// @param x  ascending [n]
/// @param y  [n]
/// @throws InvalidInput  for fewer than 2 points, unequal lengths or a range outside the curve
[[nodiscard]] LinearFit fit_line(const Eigen::VectorXd& x, const Eigen::VectorXd& y, Eigen::Index begin,
                                 Eigen::Index end);

struct RegionOptions {
  int least_points = 5;      ///< ≥ 3
  double least_rise = 0.4;   ///< share of the whole rise of the curve, max y − min y, that the line must cover
  double least_width = 0.0;  ///< width in x the line must cover
};

/// The straightest part of a curve: of all stretches of consecutive points that cover at least `least_rise` of its rise
/// and `least_width` in x, the one whose residual is least relative to the rise of its line; the first of equals.
/// Cost O(n²).
/// @throws InvalidInput       as fit_line, or for options out of range
/// @throws NumericalFailure   if no stretch qualifies, or y is not finite
[[nodiscard]] LinearFit linear_region(const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                                      const RegionOptions& options = {});

}  // namespace slipmode::diagnostics
