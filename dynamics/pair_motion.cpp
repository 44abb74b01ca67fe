#include <slipmode/dynamics/pair_motion.hpp>

#include <cmath>

namespace slipmode::dynamics {
namespace {

/// w below this share of |τ| would make A large.
constexpr double kHardlyOscillates = 1e-2;

}  // namespace

PairMotion::PairMotion(const ModalModel& m, double slowest) {
  decay_ = frequency_ = a11_ = a12_ = a21_ = Eigen::VectorXd::Zero(m.np);
  for (Eigen::Index i = 0; i < m.n; ++i) {
    const double half = (m.g11(i) - m.g22(i)) / 2.0, square = -m.g12(i) * m.g21(i) - half * half;
    const double decay = (m.g11(i) + m.g22(i)) / 2.0;
    if (!(square > kHardlyOscillates * kHardlyOscillates * decay * decay) || square <= slowest * slowest) {
      others_.push_back(i);
      continue;
    }
    decay_(i) = decay;
    frequency_(i) = std::sqrt(square);
    a11_(i) = half / frequency_(i);
    a12_(i) = m.g12(i) / frequency_(i);
    a21_(i) = m.g21(i) / frequency_(i);
  }
}

kernels::MotionArrays PairMotion::arrays() const {
  return {decay_.size(), decay_.data(), frequency_.data(), a11_.data(), a12_.data(), a21_.data()};
}

Eigen::MatrixXd PairMotion::changes(const Eigen::VectorXd& times) const {
  Eigen::MatrixXd out(4 * decay_.size(), times.size());
  kernels::kernels().changes(arrays(), times.data(), times.size(), out.data());
  return out;
}

void PairMotion::add(double t, const double* free, double* x) const {
  kernels::kernels().free_motion(arrays(), t, free, x);
}

}  // namespace slipmode::dynamics
