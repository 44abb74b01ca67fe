#include "dynamics/drive_overlay.hpp"

#include "core/errors.hpp"
#include "dynamics/lobatto.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

namespace slipmode::dynamics {
namespace {

/// Closer to an eigenvalue than this share of the drive's frequency there is no telling resonance from damping.
constexpr double kResonance = 1e-13;

using Amplitudes = DriveOverlay::Amplitudes;

Amplitudes through(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& coefficients, const Amplitudes& state,
                   const Amplitudes& inputs) {
  return {rows.transpose() * state.c + coefficients.transpose() * inputs.c,
          rows.transpose() * state.s + coefficients.transpose() * inputs.s};
}

/// The drive's part of a regime's inputs.
Amplitudes driven_inputs(const Regime& r, const friction::Drive& drive) {
  const Eigen::Index V = r.speed_input();
  int highest = 1;
  if (drive.force())
    for (const friction::ForceHarmonic& h : drive.force()->harmonics) highest = std::max(highest, h.order);
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(r.inputs(), highest), s = c;
  if (const friction::Shaker* shaker = drive.shaker()) {
    const double A = shaker->amplitude, w = shaker->omega();
    for (Eigen::Index k = 0; k < V; ++k)
      if (r.sticks(static_cast<int>(k))) s(k, 0) = A;
    c(V, 0) = A * w;
    s(V + 1, 0) = -A * w * w;
  } else {
    for (const friction::ForceHarmonic& h : drive.force()->harmonics) {
      c(r.force_input(h.direction), h.order - 1) += h.amplitude * std::sin(h.phase);
      s(r.force_input(h.direction), h.order - 1) += h.amplitude * std::cos(h.phase);
    }
  }
  return {std::move(c), std::move(s)};
}

}  // namespace

double Amplitudes::at(Eigen::Index k, DrivePhase first) const {
  double sum = c(k, 0) * first.cosine + s(k, 0) * first.sine;
  DrivePhase p = first;
  for (Eigen::Index j = 1; j < c.cols(); ++j) {
    p = p.times(first);
    sum += c(k, j) * p.cosine + s(k, j) * p.sine;
  }
  return sum;
}

double Amplitudes::rate(Eigen::Index k, DrivePhase first) const {
  double sum = s(k, 0) * first.cosine - c(k, 0) * first.sine;
  DrivePhase p = first;
  for (Eigen::Index j = 1; j < c.cols(); ++j) {
    p = p.times(first);
    sum += static_cast<double>(j + 1) * (s(k, j) * p.cosine - c(k, j) * p.sine);
  }
  return sum;
}

double Amplitudes::bend(Eigen::Index k, DrivePhase first) const {
  double sum = 0.0;
  DrivePhase p;
  for (Eigen::Index j = 0; j < c.cols(); ++j) {
    p = p.times(first);
    sum -= static_cast<double>((j + 1) * (j + 1)) * (c(k, j) * p.cosine + s(k, j) * p.sine);
  }
  return sum;
}

double Amplitudes::size(Eigen::Index k, int power) const {
  double sum = magnitude(k, 0);
  for (Eigen::Index j = 1; j < c.cols(); ++j) sum += std::pow(static_cast<double>(j + 1), power) * magnitude(k, j);
  return sum;
}

void Amplitudes::add(DrivePhase first, double factor, Eigen::VectorXd& out) const {
  DrivePhase p;
  for (Eigen::Index j = 0; j < c.cols(); ++j) {
    p = p.times(first);
    out += (factor * p.cosine) * c.col(j) + (factor * p.sine) * s.col(j);
  }
}

Eigen::VectorXd Amplitudes::rates(DrivePhase first) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(c.rows());
  DrivePhase p;
  for (Eigen::Index j = 0; j < c.cols(); ++j) {
    p = p.times(first);
    out += static_cast<double>(j + 1) * (p.cosine * s.col(j) - p.sine * c.col(j));
  }
  return out;
}

DriveOverlay::DriveOverlay(const Regime& r, const friction::Drive& drive) : inputs(driven_inputs(r, drive)) {
  omega_ = drive.shaker() ? drive.shaker()->omega() : drive.force()->omega;
  phase_ = drive.shaker() ? drive.shaker()->phase : 0.0;
  const auto np = r.pairs.np, orders_used = inputs.c.cols();
  Eigen::MatrixXd state_c = Eigen::MatrixXd::Zero(2 * np, orders_used), state_s = state_c;
  using Complex = std::complex<double>;
  for (Eigen::Index j = 0; j < orders_used; ++j) {
    const double w = static_cast<double>(j + 1) * omega_;
    const Eigen::VectorXd fc = r.B * inputs.c.col(j), fs = r.B * inputs.s.col(j);
    for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
      const Complex f1(fc(i), -fs(i)), f2(fc(np + i), -fs(np + i));
      if (f1 == 0.0 && f2 == 0.0) continue;
      const Complex a(-r.pairs.g11(i), w), d(-r.pairs.g22(i), w);
      const double b = -r.pairs.g12(i), c = -r.pairs.g21(i);
      const Complex determinant = a * d - b * c;
      if (std::abs(determinant) <= kResonance * w * std::max(w, r.pair_rate(i)))
        throw NumericalFailure("the drive's angular frequency of " + std::to_string(w) +
                                   " rad/s is that of a mode without damping: its motion grows without bound; give the "
                                   "structure damping or change the frequency",
                               std::numeric_limits<double>::quiet_NaN(), {}, std::abs(determinant));
      const Complex x1 = (d * f1 - b * f2) / determinant, x2 = (a * f2 - c * f1) / determinant;
      state_c(i, j) = x1.real();
      state_s(i, j) = -x1.imag();
      state_c(np + i, j) = x2.real();
      state_s(np + i, j) = -x2.imag();
    }
  }
  state = {std::move(state_c), std::move(state_s)};
  outputs = through(r.row, r.coefficient, state, inputs);
  force = through(r.force_row, r.force_coefficient, state, inputs);
  displacement = through(r.displacement_row, r.displacement_coefficient, state, inputs);
  velocity = through(r.velocity_row, r.velocity_coefficient, state, inputs);
  driven = through(r.drive_row, r.drive_coefficient, state, inputs);
  slipping = {r.to_slipping * state.c + r.inputs_slipping * inputs.c,
              r.to_slipping * state.s + r.inputs_slipping * inputs.s};
}

DrivePhase DriveOverlay::phase(double t) const {
  const double theta = omega_ * t + phase_;
  return {std::cos(theta), std::sin(theta)};
}

const std::vector<DriveOverlay::Window>& DriveOverlay::window(int level, double h) const {
  auto& slot = windows_[static_cast<std::size_t>(level)];
  if (!slot.empty()) return slot;
  for (Eigen::Index order = 1; order <= orders(); ++order) {
    const double w = static_cast<double>(order) * omega_;
    Eigen::Matrix<double, 8, 1> cosine, sine;
    for (int j = 0; j < 8; ++j) {
      cosine(j) = std::cos(w * lobatto().point(j) * h);
      sine(j) = std::sin(w * lobatto().point(j) * h);
    }
    Window own;
    Eigen::Map<Eigen::Matrix<double, 8, 1>>(own.cosine.data()) = lobatto().bernstein * cosine;
    Eigen::Map<Eigen::Matrix<double, 8, 1>>(own.sine.data()) = lobatto().bernstein * sine;
    own.remainder = std::min(kInterpolationGain, interpolation_share(w, h));
    slot.push_back(own);
  }
  return slot;
}

}  // namespace slipmode::dynamics
