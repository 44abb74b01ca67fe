#include "dynamics/internal/drive_overlay.hpp"

#include <slipmode/dynamics/receptance.hpp>
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

/// A pair whose determinant is below this share of the squared frequency answers a harmonic steadily with about the
/// inverse of it times what moves in a radian: so many digits would be lost.
constexpr double kResonance = 1e-3;

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

/// Exponent beyond which a growing window is useless anyway.
constexpr double kSwellExponent = 200.0;

/// e^{iθ} − 1, to all digits where θ is small.
Complex turned_by(double theta) { return std::polar(2.0 * std::sin(0.5 * theta), 0.5 * theta) * Complex(0.0, 1.0); }

/// ∫ e^{G(h−s)} (b e^{iws} + held (e^{iws} − 1)) ds over 0 ≤ s ≤ h of one pair: Taylor's series of a short time,
/// doubled.
Eigen::Vector2cd pair_from_rest(const ModalModel& pairs, Eigen::Index i, const Eigen::Vector2cd& b,
                                const Eigen::Vector2cd& held, double w, double rate, double h) {
  constexpr double kShort = 0.25;  // radians: twelve terms leave 1e-17
  const int doublings = std::max(0, 1 + std::ilogb(std::max(rate, w) * h / kShort));
  h = std::ldexp(h, -doublings);
  const Eigen::Matrix2d G{{pairs.g11(i), pairs.g12(i)}, {pairs.g21(i), pairs.g22(i)}};
  const Eigen::Vector2cd both = b + held;
  const bool holds = !held.isZero(0.0);       // of pairs in resonance, moved in every step, it is
  Eigen::Vector2cd term = h * b, sum = term;  // hᵏ⁺¹/(k+1)! (Gᵏ b + Σ_{j>0} Gᵏ⁻ʲ (iw)ʲ both)
  Eigen::Vector2cd constant_term = h * held, constant = constant_term;  // of ∫ e^{G(h−s)} held ds
  Complex turned = h;                                                   // hᵏ⁺¹/(k+1)! (iw)ᵏ
  for (int k = 1; k < 12; ++k) {
    const double factor = h / (k + 1);
    turned *= Complex(0.0, w * factor);
    term = (factor * (G * term) + turned * both).eval();
    sum += term;
    if (!holds) continue;
    constant_term = (factor * (G * constant_term)).eval();
    constant += constant_term;
  }
  for (int k = 0; k < doublings; ++k, h *= 2.0) {
    const Eigen::Matrix2d free = pairs.exponential(i, h);
    sum = (free * sum + std::polar(1.0, w * h) * sum).eval();
    if (!holds) continue;
    sum += turned_by(w * h) * constant;
    constant += (free * constant).eval();
  }
  return sum;
}

Amplitudes amplitudes(const Eigen::MatrixXcd& phasors) { return {phasors.real(), -phasors.imag()}; }

/// Springs side by side are told apart by their stretch alone, which the contacts' answer to a force has as a
/// difference of what that would move without them and of what they take back.
bool springs_share_a_place(const Regime& r) {
  for (Eigen::Index c = 0; c < r.speed_input(); ++c)
    for (Eigen::Index d = 0; d < c; ++d)
      if (r.spring(c) > 0.0 && r.spring(d) > 0.0 && r.displacement_row.col(c) == r.displacement_row.col(d)) return true;
  return false;
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

void Amplitudes::add(DrivePhase first, double factor, Eigen::VectorXd& out) const {
  DrivePhase p;
  for (Eigen::Index j = 0; j < c.cols(); ++j) {
    p = p.times(first);
    out += (factor * p.cosine) * c.col(j) + (factor * p.sine) * s.col(j);
  }
}

DriveOverlay::DriveOverlay(const Regime& r, const ModalModel& slipping_model, const friction::Drive& drive,
                           bool from_rest)
    : inputs(driven_inputs(r, drive)),
      place_size(Eigen::VectorXd::Zero(2 * r.speed_input())),
      swell(Eigen::VectorXd::Zero(r.pairs.np)) {
  omega_ = drive.omega();
  phase_ = drive.shaker() ? drive.shaker()->phase : 0.0;
  const Complex way = drive.shaker() ? Complex(0.0, -drive.shaker()->amplitude) : 0.0;
  const bool told_apart = drive.force() && springs_share_a_place(r);
  const auto used = inputs.c.cols();
  Eigen::MatrixXcd own(2 * r.pairs.np, used), lifted(slipping_model.input.rows(), used), forces(r.speed_input(), used);
  for (Eigen::Index j = 0; j < used; ++j) {
    const double w = static_cast<double>(j + 1) * omega_;
    const Eigen::VectorXcd J = inputs.c.col(j) - Complex(0.0, 1.0) * inputs.s.col(j), load = r.B * J;
    if (find_resonances(r, j + 1, load, from_rest ? std::numeric_limits<double>::infinity() : kResonance) ||
        any_oscillator_resonates(r, w, kResonance) || told_apart) {
      own.col(j) = pair_receptances(r.pairs, w, load);
      for (const Resonance& of : resonances)
        if (of.order == j + 1) own(of.pair, j) = own(r.pairs.np + of.pair, j) = 0.0;
      lifted.col(j) = r.to_slipping * own.col(j) + r.inputs_slipping * J;
      forces.col(j) = r.force_row.transpose() * own.col(j) + r.force_coefficient.transpose() * J;
      place_size.head(r.speed_input()) += r.displacement_row.cwiseAbs().transpose() * own.col(j).cwiseAbs();
      continue;
    }
    const HarmonicResponse response = harmonic_response(r, slipping_model, w, way, J.tail(r.forces));
    own.col(j) = r.from_slipping * response.slipping + r.from_oscillators * response.oscillators;
    lifted.col(j) = response.slipping;
    forces.col(j) = response.force;
    place_size.head(r.speed_input()) += response.place_size;
  }
  if (from_rest) measure_pushes(r, slipping_model);
  place_size += slipping_model.place_row.transpose() * lifted.cwiseAbs().rowwise().sum();
  state = amplitudes(own);
  slipping = amplitudes(lifted);
  force = amplitudes(forces);
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
  outputs[0] = {rest.c + shares.transpose() * force.c, rest.s + shares.transpose() * force.s};
  differentiate(r);
}

void DriveOverlay::measure_pushes(const Regime& r, const ModalModel& slipping_model) {
  const auto np = r.pairs.np;
  for (const Resonance& of : resonances) {
    const std::vector<Eigen::Index> pair{of.pair, np + of.pair};
    const Eigen::Matrix2d G{{r.pairs.g11(of.pair), r.pairs.g12(of.pair)}, {r.pairs.g21(of.pair), r.pairs.g22(of.pair)}};
    const Eigen::Vector2d push = of.push.cwiseAbs(), reach = push / r.rate + G.cwiseAbs() * push / (r.rate * r.rate);
    place_size.head(r.speed_input()) += r.displacement_row(pair, Eigen::all).cwiseAbs().transpose() * reach;
    place_size += slipping_model.place_row.transpose() * (r.to_slipping(Eigen::all, pair).cwiseAbs() * reach);
  }
}

bool DriveOverlay::find_resonances(const Regime& r, Eigen::Index order, const Eigen::VectorXcd& load, double share) {
  const auto np = r.pairs.np, known = std::ssize(resonances);
  const double w = static_cast<double>(order) * omega_;
  for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
    const Eigen::Vector2cd push(load(i), load(np + i));
    // What only integrates is bounded by no scale.
    if (push.isZero(0.0) || r.scale1(i) == 0.0 || r.scale2(i) == 0.0 || !resonates(r.pairs, i, w, share)) continue;
    resonances.push_back({i, order, push});
    swell(i) += r.scale1(i) * std::abs(push(0)) + r.scale2(i) * std::abs(push(1));
  }
  return std::ssize(resonances) > known;
}

void DriveOverlay::differentiate(const Regime& r) {
  const auto np = r.pairs.np;
  const auto rate = [this](const Amplitudes& of) {
    Eigen::MatrixXcd out = of.s + Complex(0.0, 1.0) * of.c;
    for (Eigen::Index j = 0; j < out.cols(); ++j) out.col(j) *= static_cast<double>(j + 1) * omega_;
    return out;
  };
  Eigen::MatrixXcd of_state = rate(state);
  for (const Resonance& own : resonances) {
    of_state(own.pair, own.order - 1) += own.push(0);
    of_state(np + own.pair, own.order - 1) += own.push(1);
  }
  state_rate = amplitudes(of_state);
  input_rate = amplitudes(rate(inputs));
  const std::array<const Eigen::MatrixXd*, 3> rows{&r.row, &r.row1, &r.row2};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Eigen::MatrixXcd next = rate(outputs[k]);
    for (const Resonance& own : resonances)
      next.col(own.order - 1) +=
          own.push(0) * rows[k]->row(own.pair).transpose() + own.push(1) * rows[k]->row(np + own.pair).transpose();
    outputs[k + 1] = amplitudes(next);
  }
}

Eigen::Vector2cd DriveOverlay::Resonance::moved(const Regime& r, double omega, double tau) const {
  return pair_from_rest(r.pairs, pair, push, Eigen::Vector2cd::Zero(), static_cast<double>(order) * omega,
                        r.pair_rate(pair), tau);
}

void DriveOverlay::move_resonances(const Regime& r, double tau, DrivePhase first, Eigen::VectorXd& out_x) const {
  for (const Resonance& own : resonances) {
    DrivePhase p;
    for (Eigen::Index j = 0; j < own.order; ++j) p = p.times(first);
    const Eigen::Vector2cd moved = Complex(p.cosine, p.sine) * own.moved(r, omega_, tau);
    out_x(own.pair) += moved(0).real();
    out_x(r.pairs.np + own.pair) += moved(1).real();
  }
}

Eigen::VectorXd DriveOverlay::from_entry(const Regime& r, double tau, DrivePhase first) const {
  const auto np = r.pairs.np, contacts = r.speed_input(), others = r.inputs() - contacts;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(2 * np);
  DrivePhase p;
  for (Eigen::Index j = 0; j < orders(); ++j) {
    p = p.times(first);
    const Complex begin(p.cosine, p.sine);
    const Eigen::VectorXcd J = inputs.c.col(j) - Complex(0.0, 1.0) * inputs.s.col(j);
    const Eigen::VectorXcd held = r.B.leftCols(contacts) * J.head(contacts);
    const Eigen::VectorXcd b = r.B.rightCols(others) * J.tail(others);
    for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
      const Eigen::Vector2cd moved = begin * pair_from_rest(r.pairs, i, {b(i), b(np + i)}, {held(i), held(np + i)},
                                                            static_cast<double>(j + 1) * omega_, r.pair_rate(i), tau);
      out(i) += moved(0).real();
      out(np + i) += moved(1).real();
    }
  }
  return out;
}

void DriveOverlay::follow_inputs(const Regime& r, double tau, DrivePhase first, Eigen::VectorXd& out_inputs) const {
  const Eigen::Index contacts = r.speed_input();
  DrivePhase p;
  for (Eigen::Index j = 0; j < orders(); ++j) {
    p = p.times(first);
    const double turn = static_cast<double>(j + 1) * omega_ * tau;
    const Complex begin(p.cosine, p.sine), then = begin * std::polar(1.0, turn), change = begin * turned_by(turn);
    for (Eigen::Index k = 0; k < r.inputs(); ++k) {
      const Complex& by = k < contacts ? change : then;
      out_inputs(k) += inputs.c(k, j) * by.real() + inputs.s(k, j) * by.imag();
    }
  }
}

DrivePhase DriveOverlay::phase(double t) const {
  const double theta = omega_ * t + phase_;
  return {std::cos(theta), std::sin(theta)};
}

const std::vector<DriveOverlay::Window>& DriveOverlay::window(const Regime& r, int level, double h) const {
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
      swell_window(r, order, h, own);
      out.push_back(std::move(own));
    }
  });
}

void DriveOverlay::swell_window(const Regime& r, Eigen::Index order, double h, Window& out) const {
  const auto np = r.pairs.np, no = r.row.cols();
  const double w = static_cast<double>(order) * omega_, growth = std::exp(std::min(r.growth * h, kSwellExponent));
  for (const Resonance& own : resonances) {
    if (own.order != order) continue;
    if (out.swell_cosine.size() == 0) {
      out.swell_cosine = out.swell_sine = Eigen::MatrixXd::Zero(8, no);
      out.swell_remainder = Eigen::VectorXd::Zero(no);
    }
    Eigen::Matrix<double, 8, 4> moved;
    for (int j = 0; j < 8; ++j) {
      const Eigen::Vector2cd at = own.moved(r, omega_, lobatto().point(j) * h);
      moved.row(j) << at(0).real(), at(1).real(), -at(0).imag(), -at(1).imag();
    }
    moved = (lobatto().bernstein * moved).eval();
    Eigen::MatrixXd rows(2, no);
    rows << r.row.row(own.pair), r.row.row(np + own.pair);
    out.swell_cosine += moved.leftCols<2>() * rows;
    out.swell_sine += moved.rightCols<2>() * rows;
    // |x⁽⁸⁾| ≤ ‖G‖⁸|x| + 8 f⁷|push|, f the faster of ‖G‖ and w, and |x| ≤ h|push|.
    const double fastest = std::max(r.pair_rate(own.pair), w);
    const double share = std::min(kInterpolationGain * h, interpolation_share(fastest, h) * (h + 8.0 / fastest));
    const double push = r.scale1(own.pair) * std::abs(own.push(0)) + r.scale2(own.pair) * std::abs(own.push(1));
    out.swell_remainder += growth * share * push * r.weight.row(own.pair).transpose();
  }
}

}  // namespace slipmode::dynamics
