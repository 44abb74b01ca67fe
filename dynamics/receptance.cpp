#include <slipmode/dynamics/receptance.hpp>

#include <cmath>
#include <complex>
#include <limits>

namespace slipmode::dynamics {

Eigen::MatrixXcd pair_receptances(const ModalModel& m, double omega, const Eigen::MatrixXcd& inputs) {
  const auto np = m.np;
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(2 * np, inputs.cols());
  for (Eigen::Index i = 0; i < m.n; ++i) {
    const std::complex<double> a(-m.g11(i), omega), d(-m.g22(i), omega);
    const double b = -m.g12(i), c = -m.g21(i);
    const double nearest = std::sqrt(std::numeric_limits<double>::epsilon()) * omega * omega;
    std::complex<double> determinant = a * d - b * c;
    if (std::abs(determinant) < nearest) determinant = nearest;
    for (Eigen::Index k = 0; k < inputs.cols(); ++k) {
      const std::complex<double> f1 = inputs(i, k), f2 = inputs(np + i, k);
      out(i, k) = (d * f1 - b * f2) / determinant;
      out(np + i, k) = (a * f2 - c * f1) / determinant;
    }
  }
  return out;
}

}  // namespace slipmode::dynamics
