#include "orbits/internal/motion_scale.hpp"

#include <algorithm>

namespace slipmode::orbits::detail {

Eigen::VectorXd half_reaches(const Eigen::MatrixXd& samples) {
  constexpr double kLeast = 1e-3;
  const Eigen::VectorXd reach = 0.5 * (samples.rowwise().maxCoeff() - samples.rowwise().minCoeff());
  return reach.cwiseMax(kLeast * reach.maxCoeff());
}

MotionScale::MotionScale(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v) : scale_(q.rows() + v.rows()) {
  scale_ << half_reaches(q), half_reaches(v);
}

double MotionScale::distance(const Eigen::Ref<const Eigen::MatrixXd>& apart) const {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < scale_.size(); ++i) {
    if (scale_(i) > 0.0) largest = std::max(largest, apart.row(i).cwiseAbs().maxCoeff() / scale_(i));
  }
  return largest;
}

}  // namespace slipmode::orbits::detail
