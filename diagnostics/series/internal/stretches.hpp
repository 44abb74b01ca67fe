#pragma once

// How far rates of growth scatter along a motion.

#include <Eigen/Core>
#include <cmath>

namespace slipmode::diagnostics {

/// Equal stretches into which a motion or a record is cut for the standard error of its exponents.
inline constexpr Eigen::Index kStretches = 8;

/// Means of the columns of `rates` over `count` stretches of equal length; what does not fill the last is left out.
/// @param rates  one column per interval, at least `count` [k x T]
/// @return one column per stretch [k x count]
[[nodiscard]] inline Eigen::MatrixXd stretch_means(const Eigen::MatrixXd& rates, Eigen::Index count = kStretches) {
  const Eigen::Index length = rates.cols() / count;
  Eigen::MatrixXd means(rates.rows(), count);
  for (Eigen::Index s = 0; s < count; ++s) means.col(s) = rates.middleCols(s * length, length).rowwise().mean();
  return means;
}

/// Standard error of the mean of independent columns, row by row. @param parts  two columns or more [k x m]
[[nodiscard]] inline Eigen::VectorXd standard_error(const Eigen::MatrixXd& parts) {
  const auto m = static_cast<double>(parts.cols());
  const Eigen::VectorXd mean = parts.rowwise().mean();
  return ((parts.colwise() - mean).rowwise().squaredNorm() / (m * (m - 1.0))).cwiseSqrt();
}

}  // namespace slipmode::diagnostics
