#include "dynamics/drive_overlay.hpp"

#include "core/errors.hpp"
#include "dynamics/lobatto.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// Closer to an eigenvalue than this share of the drive's frequency there is no telling resonance from damping.
constexpr double kResonance = 1e-13;

DriveOverlay::Amplitudes through(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& coefficients,
                                 const DriveOverlay::Amplitudes& state, const DriveOverlay::Amplitudes& inputs) {
  return {rows.transpose() * state.c + coefficients.transpose() * inputs.c,
          rows.transpose() * state.s + coefficients.transpose() * inputs.s};
}

}  // namespace

double DriveOverlay::Amplitudes::size(Eigen::Index k) const { return std::hypot(c(k), s(k)); }

DriveOverlay::DriveOverlay(const Regime& r, const friction::Shaker& shaker)
    : omega_(shaker.omega()), phase_(shaker.phase) {
  const auto ni = r.inputs(), V = r.speed_input(), np = r.pairs.np;
  const double A = shaker.amplitude;
  inputs.c = inputs.s = Eigen::VectorXd::Zero(ni);
  for (Eigen::Index c = 0; c < V; ++c)
    if (r.sticks(static_cast<int>(c))) inputs.s(c) = A;
  inputs.c(V) = A * omega_;
  inputs.s(V + 1) = -A * omega_ * omega_;

  const Eigen::VectorXd fc = r.B * inputs.c, fs = r.B * inputs.s;
  state.c = state.s = Eigen::VectorXd::Zero(2 * np);
  using Complex = std::complex<double>;
  for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
    const Complex f1(fc(i), -fs(i)), f2(fc(np + i), -fs(np + i));
    if (f1 == 0.0 && f2 == 0.0) continue;
    const Complex a(-r.pairs.g11(i), omega_), d(-r.pairs.g22(i), omega_);
    const double b = -r.pairs.g12(i), c = -r.pairs.g21(i);
    const Complex determinant = a * d - b * c;
    if (std::abs(determinant) <= kResonance * omega_ * std::max(omega_, r.pair_rate(i)))
      throw NumericalFailure("the drive's frequency of " + std::to_string(shaker.frequency_hz) +
                                 " Hz is that of a mode without damping: its motion grows without bound; give the "
                                 "structure damping or change the frequency",
                             std::numeric_limits<double>::quiet_NaN(), {}, std::abs(determinant));
    const Complex x1 = (d * f1 - b * f2) / determinant, x2 = (a * f2 - c * f1) / determinant;
    state.c(i) = x1.real();
    state.s(i) = -x1.imag();
    state.c(np + i) = x2.real();
    state.s(np + i) = -x2.imag();
  }
  outputs = through(r.row, r.coefficient, state, inputs);
  force = through(r.force_row, r.force_coefficient, state, inputs);
  displacement = through(r.displacement_row, r.displacement_coefficient, state, inputs);
  velocity = through(r.velocity_row, r.velocity_coefficient, state, inputs);
}

DrivePhase DriveOverlay::phase(double t) const {
  const double theta = omega_ * t + phase_;
  return {std::cos(theta), std::sin(theta)};
}

const DriveOverlay::Window& DriveOverlay::window(int level, double h) const {
  auto& slot = windows_[static_cast<std::size_t>(level)];
  if (!slot) {
    Eigen::Matrix<double, 8, 1> cosine, sine;
    for (int j = 0; j < 8; ++j) {
      cosine(j) = std::cos(omega_ * lobatto().point(j) * h);
      sine(j) = std::sin(omega_ * lobatto().point(j) * h);
    }
    alignas(64) std::array<double, 8> lanes;
    Window w;
    Eigen::Map<Eigen::Matrix<double, 8, 1>>(lanes.data()) = lobatto().bernstein * cosine;
    w.cosine = load8(lanes.data());
    Eigen::Map<Eigen::Matrix<double, 8, 1>>(lanes.data()) = lobatto().bernstein * sine;
    w.sine = load8(lanes.data());
    w.remainder = std::min(kInterpolationGain, interpolation_share(omega_, h));
    slot = w;
  }
  return *slot;
}

}  // namespace slipmode::dynamics
