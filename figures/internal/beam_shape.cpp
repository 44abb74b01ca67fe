#include "figures/internal/beam_shape.hpp"

namespace slipmode::figures {

Eigen::VectorXd beam_shape(const fem::Beam& beam, const Eigen::VectorXd& x, const Eigen::VectorXd& q) {
  Eigen::VectorXd y(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) y[i] = x[i] > 0.0 ? beam.displacement_row(x[i]).dot(q) : 0.0;
  const double largest = y.cwiseAbs().maxCoeff();
  return largest > 0.0 ? Eigen::VectorXd(y / largest) : y;
}

}  // namespace slipmode::figures
