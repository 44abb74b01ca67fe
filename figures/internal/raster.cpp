#include "figures/internal/raster.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace slipmode::figures {

void Range::include(const Eigen::VectorXd& values, bool positive) {
  for (const double value : values) {
    if (!std::isfinite(value) || (positive && !(value > 0.0))) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
}

std::vector<Eigen::Index> one_per_cell(const Eigen::VectorXd& x, const Eigen::VectorXd& y, const Range& range_x,
                                       const Range& range_y, double cells_x, double cells_y) {
  const auto cell = [](double value, const Range& range, double cells) {
    return static_cast<int>(cells * (value - range.low) / std::max(range.high - range.low, 1e-300));
  };
  std::set<std::pair<int, int>> seen;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x(i)) || !std::isfinite(y(i))) continue;
    if (seen.emplace(cell(x(i), range_x, cells_x), cell(y(i), range_y, cells_y)).second) kept.push_back(i);
  }
  return kept;
}

}  // namespace slipmode::figures
