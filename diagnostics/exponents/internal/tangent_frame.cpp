#include "diagnostics/exponents/internal/tangent_frame.hpp"

#include <slipmode/core/errors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::diagnostics {

Orthonormalised orthonormalise(const Eigen::MatrixXd& images, double collapse) {
  if (!images.allFinite()) {
    throw NumericalFailure("tangent directions are not finite; shorten the interval between renormalisations",
                           std::numeric_limits<double>::quiet_NaN(), {}, 0.0);
  }
  const Eigen::Index count = images.cols();
  Orthonormalised out{
      .directions = Eigen::MatrixXd(images.rows(), count), .log_growth = Eigen::VectorXd(count), .columns = {}};
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    Eigen::VectorXd rest = images.col(k);
    const double least = collapse * std::max(1.0, rest.norm());
    for (int pass = 0; pass < 2; ++pass) {
      const auto before = out.directions.leftCols(kept);
      rest -= before * (before.transpose() * rest);
    }
    const double length = rest.norm();
    if (length <= least) continue;
    out.directions.col(kept) = rest / length;
    out.log_growth[kept] = std::log(length);
    out.columns.push_back(k);
    ++kept;
  }
  out.directions.conservativeResize(Eigen::NoChange, kept);
  out.log_growth.conservativeResize(kept);
  return out;
}

Eigen::MatrixXd random_frame(Eigen::Index size, Eigen::Index count, Random& random) {
  Eigen::MatrixXd columns(size, count);
  for (Eigen::Index k = 0; k < count; ++k)
    for (Eigen::Index i = 0; i < size; ++i) columns(i, k) = random.normal();
  return orthonormalise(columns).directions;
}

}  // namespace slipmode::diagnostics
