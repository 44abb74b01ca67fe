#include "dynamics/internal/drive_overlay.hpp"

#include <slipmode/core/errors.hpp>
#include "dynamics/internal/harmonic_response.hpp"
#include "dynamics/internal/lobatto.hpp"

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
using Complex = std::complex<double>;

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

/// @param load  what the inputs put into the pairs
void refuse_resonance(const Regime& r, double w, const Eigen::VectorXcd& load) {
  const auto np = r.pairs.np;
  for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
    if (load(i) == 0.0 && load(np + i) == 0.0) continue;
    const Complex determinant =
        Complex(-r.pairs.g11(i), w) * Complex(-r.pairs.g22(i), w) - r.pairs.g12(i) * r.pairs.g21(i);
    if (std::abs(determinant) <= kResonance * w * std::max(w, r.pair_rate(i)))
      throw NumericalFailure("the drive's angular frequency of " + std::to_string(w) +
                                 " rad/s is that of a mode without damping: its motion grows without bound; give the "
                                 "structure damping or change the frequency",
                             std::numeric_limits<double>::quiet_NaN(), {}, std::abs(determinant));
  }
}

/// ∫ e^{G(h−s)} b e^{iws} ds over 0 ≤ s ≤ h of one pair: Taylor's series of a short time, doubled.
Eigen::Vector2cd pair_from_rest(const ModalModel& pairs, Eigen::Index i, const Eigen::Vector2cd& b, double w,
                                double rate, double h) {
  constexpr double kShort = 0.25;  // radians: twelve terms leave 1e-17
  const int doublings = std::max(0, 1 + std::ilogb(std::max(rate, w) * h / kShort));
  h = std::ldexp(h, -doublings);
  const Eigen::Matrix2d G{{pairs.g11(i), pairs.g12(i)}, {pairs.g21(i), pairs.g22(i)}};
  Eigen::Vector2cd term = h * b, sum = term;  // hᵏ⁺¹/(k+1)! Σ Gᵏ⁻ʲ (iw)ʲ b
  Complex turned = h;                         // hᵏ⁺¹/(k+1)! (iw)ᵏ
  for (int k = 1; k < 12; ++k) {
    const double factor = h / (k + 1);
    turned *= Complex(0.0, w * factor);
    term = (factor * (G * term) + turned * b).eval();
    sum += term;
  }
  for (int k = 0; k < doublings; ++k, h *= 2.0)
    sum = (pairs.exponential(i, h) * sum + std::polar(1.0, w * h) * sum).eval();
  return sum;
}

/// How much of an output is the force of its contact in stick.
double force_share(RegimeOutput::Kind kind) {
  if (kind == RegimeOutput::Kind::kForce || kind == RegimeOutput::Kind::kReserve) return 1.0;
  return kind == RegimeOutput::Kind::kExcess ? -1.0 : 0.0;
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

DriveOverlay::DriveOverlay(const Regime& r, const ModalModel& slipping_model, const friction::Drive& drive)
    : inputs(driven_inputs(r, drive)) {
  omega_ = drive.omega();
  phase_ = drive.shaker() ? drive.shaker()->phase : 0.0;
  const Complex way = drive.shaker() ? Complex(0.0, -drive.shaker()->amplitude) : 0.0;
  const auto used = inputs.c.cols();
  Eigen::MatrixXcd own(2 * r.pairs.np, used), lifted(slipping_model.input.rows(), used), forces(r.speed_input(), used);
  for (Eigen::Index j = 0; j < used; ++j) {
    const double w = static_cast<double>(j + 1) * omega_;
    const Eigen::VectorXcd J = inputs.c.col(j) - Complex(0.0, 1.0) * inputs.s.col(j);
    refuse_resonance(r, w, r.B * J);
    const HarmonicResponse response = harmonic_response(r, slipping_model, w, way, J.tail(r.forces));
    own.col(j) = r.from_slipping * response.slipping + r.from_oscillators * response.oscillators;
    lifted.col(j) = response.slipping;
    forces.col(j) = response.force;
  }
  state = {own.real(), -own.imag()};
  slipping = {lifted.real(), -lifted.imag()};
  force = {forces.real(), -forces.imag()};
  displacement = through(r.displacement_row, r.displacement_coefficient, state, inputs);
  velocity = through(r.velocity_row, r.velocity_coefficient, state, inputs);
  driven = through(r.drive_row, r.drive_coefficient, state, inputs);
  // Of forces, the rows would give a small difference of large numbers.
  Eigen::MatrixXd rows = r.row, coefficients = r.coefficient,
                  shares = Eigen::MatrixXd::Zero(r.speed_input(), r.row.cols());
  for (Eigen::Index k = 0; k < rows.cols(); ++k) {
    const RegimeOutput& output = r.outputs[static_cast<std::size_t>(k)];
    const double share = force_share(output.kind);
    if (share == 0.0) continue;
    rows.col(k) -= share * r.force_row.col(output.contact);
    coefficients.col(k) -= share * r.force_coefficient.col(output.contact);
    shares(output.contact, k) = share;
  }
  const Amplitudes rest = through(rows, coefficients, state, inputs);
  outputs = {rest.c + shares.transpose() * force.c, rest.s + shares.transpose() * force.s};
}

Eigen::VectorXd DriveOverlay::from_rest(const Regime& r, double tau, DrivePhase first) const {
  const auto np = r.pairs.np;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(2 * np);
  DrivePhase p;
  for (Eigen::Index j = 0; j < orders(); ++j) {
    p = p.times(first);
    const Complex begin(p.cosine, p.sine);
    const Eigen::VectorXcd b = r.B * (inputs.c.col(j) - Complex(0.0, 1.0) * inputs.s.col(j));
    for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
      const Eigen::Vector2cd moved =
          pair_from_rest(r.pairs, i, {b(i), b(np + i)}, static_cast<double>(j + 1) * omega_, r.pair_rate(i), tau);
      out(i) += (begin * moved(0)).real();
      out(np + i) += (begin * moved(1)).real();
    }
  }
  return out;
}

DrivePhase DriveOverlay::phase(double t) const {
  const double theta = omega_ * t + phase_;
  return {std::cos(theta), std::sin(theta)};
}

const std::vector<DriveOverlay::Window>& DriveOverlay::window(int level, double h) const {
  return windows_.get(level, [&](std::vector<Window>& out) {
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
      out.push_back(own);
    }
  });
}

}  // namespace slipmode::dynamics
