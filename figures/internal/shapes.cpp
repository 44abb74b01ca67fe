#include "figures/internal/shapes.hpp"

namespace slipmode::figures {

Eigen::VectorXd normalised(const Eigen::VectorXd& shape) {
  const double largest = shape.cwiseAbs().maxCoeff();
  return largest > 0.0 ? Eigen::VectorXd(shape / largest) : shape;
}

Eigen::VectorXd turned_to(const Eigen::VectorXd& shape, const Eigen::VectorXd& reference) {
  return shape.dot(reference) < 0.0 ? Eigen::VectorXd(-shape) : shape;
}

Eigen::VectorXd beam_shape(const fem::Beam& beam, const Eigen::VectorXd& x, const Eigen::VectorXd& q) {
  Eigen::VectorXd y(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) y[i] = x[i] > 0.0 ? beam.displacement_row(x[i]).dot(q) : 0.0;
  return normalised(y);
}

}  // namespace slipmode::figures
