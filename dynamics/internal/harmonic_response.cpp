#include "dynamics/internal/harmonic_response.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace slipmode::dynamics {
namespace {

using Complex = std::complex<double>;

/// (iω − G)⁻¹ of the pairs on columns of inputs. On a natural frequency of the slipping structure without damping a
/// pair's answer has no bound, though contacts may give it one: taken next to it, the error is that of rounding ω.
Eigen::MatrixXcd receptances(const ModalModel& m, double omega, const Eigen::MatrixXcd& inputs) {
  const auto np = m.np;
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(2 * np, inputs.cols());
  for (Eigen::Index i = 0; i < m.n; ++i) {
    const Complex a(-m.g11(i), omega), d(-m.g22(i), omega);
    const double b = -m.g12(i), c = -m.g21(i);
    const double nearest = std::numeric_limits<double>::epsilon() * omega * omega;
    Complex determinant = a * d - b * c;
    if (std::abs(determinant) < nearest) determinant = nearest;
    for (Eigen::Index k = 0; k < inputs.cols(); ++k) {
      const Complex f1 = inputs(i, k), f2 = inputs(np + i, k);
      out(i, k) = (d * f1 - b * f2) / determinant;
      out(np + i, k) = (a * f2 - c * f1) / determinant;
    }
  }
  return out;
}

/// ζ of a normal oscillator per wᵀq.
Complex oscillator_gain(const friction::LoadForm& load, double omega) {
  return Complex(load.lift, omega * load.lift_rate) / Complex(load.stiffness - omega * omega, omega * load.damping);
}

}  // namespace

HarmonicResponse harmonic_response(const Regime& r, const ModalModel& slipping, double omega, Complex way,
                                   const Eigen::VectorXcd& forces) {
  const Eigen::Index nc = r.speed_input();
  const Eigen::MatrixXcd by_contacts = receptances(slipping, omega, slipping.input.cast<Complex>());
  const Eigen::MatrixXcd by_forces = receptances(slipping, omega, slipping.force_input * forces);
  const Eigen::MatrixXcd H = slipping.displacement_row.transpose() * by_contacts;
  const Eigen::VectorXcd moved = slipping.displacement_row.transpose() * by_forces;

  Eigen::MatrixXcd A(nc, nc);
  Eigen::VectorXcd b(nc);
  for (Eigen::Index c = 0; c < nc; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const double own = std::abs(H(c, c));
    const Complex target = (r.sticks(static_cast<int>(c)) ? way : 0.0) - moved(c);
    if (r.held(static_cast<int>(c))) {
      A.row(c) = H.row(c) / own;
      b(c) = target / own;
      continue;
    }
    Complex impedance(r.answers[i].stiffness, omega * r.answers[i].damping);
    const friction::LoadForm& load = r.answers[i].load;
    if (load.oscillates())
      impedance -= r.answers[i].friction * Complex(load.z, omega * load.z_rate) * oscillator_gain(load, omega);
    const double size = std::max(1.0, std::abs(impedance) * own);
    A.row(c) = impedance / size * H.row(c);
    A(c, c) += 1.0 / size;
    b(c) = impedance / size * target;
  }
  HarmonicResponse out;
  out.force = A.partialPivLu().solve(b);
  out.slipping = by_contacts * out.force + by_forces;
  out.oscillators.resize(r.from_oscillators.cols());
  Eigen::Index j = 0;
  for (Eigen::Index c = 0; c < nc; ++c) {
    const friction::LoadForm& load = r.answers[static_cast<std::size_t>(c)].load;
    if (!load.oscillates()) continue;
    const Complex zeta =
        oscillator_gain(load, omega) * slipping.displacement_row.col(c).cast<Complex>().dot(out.slipping);
    out.oscillators(j++) = zeta;
    out.oscillators(j++) = Complex(0.0, omega) * zeta;
  }
  return out;
}

}  // namespace slipmode::dynamics
