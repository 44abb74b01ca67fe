#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace slipmode::figures {

/// The span of some values; low > high as long as there is none.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  /// Widens to the finite values, to those above zero only if `positive`.
  void include(const Eigen::VectorXd& values, bool positive = false);
};

/// Indices of the points that are the first in their cell of a raster; points that are not finite are left out.
[[nodiscard]] std::vector<Eigen::Index> one_per_cell(const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                                                     const Range& range_x, const Range& range_y, double cells_x,
                                                     double cells_y);

}  // namespace slipmode::figures
