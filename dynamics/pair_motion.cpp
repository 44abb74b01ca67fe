#include <slipmode/dynamics/pair_motion.hpp>

#include <slipmode/dynamics/kernels/kernels.hpp>

#include <cmath>

namespace slipmode::dynamics {
namespace {

/// w below this share of |τ| would make A large.
constexpr double kHardlyOscillates = 1e-2;

}  // namespace

PairMotion::PairMotion(const ModalModel& m) {
  decay_ = frequency_ = a11_ = a12_ = a21_ = Eigen::VectorXd::Zero(m.np);
  available_ = m.n > 0;
  for (Eigen::Index i = 0; i < m.n; ++i) {
    const double half = (m.g11(i) - m.g22(i)) / 2.0, square = -m.g12(i) * m.g21(i) - half * half;
    decay_(i) = (m.g11(i) + m.g22(i)) / 2.0;
    if (!(square > kHardlyOscillates * kHardlyOscillates * decay_(i) * decay_(i))) {
      available_ = false;
      return;
    }
    frequency_(i) = std::sqrt(square);
    a11_(i) = half / frequency_(i);
    a12_(i) = m.g12(i) / frequency_(i);
    a21_(i) = m.g21(i) / frequency_(i);
  }
}

void PairMotion::add(double t, const double* free, double* x) const {
  kernels::kernels().free_motion(
      {decay_.size(), decay_.data(), frequency_.data(), a11_.data(), a12_.data(), a21_.data()}, t, free, x);
}

}  // namespace slipmode::dynamics
