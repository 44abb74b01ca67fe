#include "dynamics/internal/harmonic_response.hpp"

#include <slipmode/dynamics/receptance.hpp>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>

namespace slipmode::dynamics {
namespace {

using Complex = std::complex<double>;

/// ζ of a normal oscillator per wᵀq.
Complex oscillator_gain(const friction::LoadForm& load, double omega) {
  return Complex(load.lift, omega * load.lift_rate) / Complex(load.stiffness - omega * omega, omega * load.damping);
}

}  // namespace

HarmonicResponse harmonic_response(const Regime& r, const ModalModel& slipping, double omega, Complex way,
                                   const Eigen::VectorXcd& forces) {
  const Eigen::Index nc = r.speed_input();
  const Eigen::MatrixXcd by_contacts = pair_receptances(slipping, omega, slipping.input.cast<Complex>());
  const Eigen::MatrixXcd by_forces = pair_receptances(slipping, omega, slipping.force_input * forces);
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
