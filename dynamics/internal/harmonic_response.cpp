#include "dynamics/internal/harmonic_response.hpp"

#include <slipmode/dynamics/receptance.hpp>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

using Complex = std::complex<double>;

/// A pair of the slipping structure whose determinant is below this share of ω² is an unknown of its own.
constexpr double kOwnUnknown = 1e-2;

/// Solves A x = b of rows and columns of any size.
Eigen::VectorXcd equilibrated_solve(Eigen::MatrixXcd A, Eigen::VectorXcd b) {
  const Eigen::VectorXd columns = A.cwiseAbs().colwise().maxCoeff().cwiseInverse();
  A *= columns.asDiagonal();
  const Eigen::VectorXd rows = A.cwiseAbs().rowwise().maxCoeff().cwiseInverse();
  A = (rows.asDiagonal() * A).eval();
  b = rows.cwiseProduct(b).eval();
  return columns.cwiseProduct(A.partialPivLu().solve(b).eval());
}

/// ζ of a normal oscillator per wᵀq.
Complex oscillator_gain(const friction::LoadForm& load, double omega) {
  return Complex(load.lift, omega * load.lift_rate) / Complex(load.stiffness - omega * omega, omega * load.damping);
}

/// λ of a contact that is not held, per d − y.
Complex impedance(const ContactAnswer& answer, double omega) {
  const Complex own(answer.stiffness, omega * answer.damping);
  const friction::LoadForm& load = answer.load;
  if (!load.oscillates()) return own;
  return own - answer.friction * Complex(load.z, omega * load.z_rate) * oscillator_gain(load, omega);
}

/// A direction along that of a held contact.
struct Carried {
  Eigen::Index by = -1;  ///< the held one; -1: none
  double share = 0.0;    ///< its displacement over that of the held one
};

/// @param direction  as a column, with those of the contacts in `of_contacts`
Carried carried(const Regime& r, const Eigen::MatrixXd& of_contacts, const Eigen::VectorXd& direction) {
  constexpr double kSame = 1e-13;
  for (Eigen::Index d = 0; d < r.speed_input(); ++d) {
    if (!r.held(static_cast<int>(d))) continue;
    const double share = of_contacts.col(d).dot(direction) / of_contacts.col(d).squaredNorm();
    if ((direction - share * of_contacts.col(d)).norm() <= kSame * direction.norm()) return {d, share};
  }
  return {};
}

std::vector<Carried> carried_contacts(const Regime& r, const ModalModel& slipping) {
  std::vector<Carried> out(static_cast<std::size_t>(r.speed_input()));
  for (Eigen::Index c = 0; c < r.speed_input(); ++c)
    if (!r.held(static_cast<int>(c)))
      out[static_cast<std::size_t>(c)] = carried(r, slipping.displacement_row, slipping.displacement_row.col(c));
  return out;
}

}  // namespace

bool resonates(const ModalModel& pairs, Eigen::Index i, double omega, double share) {
  const Complex determinant =
      Complex(-pairs.g11(i), omega) * Complex(-pairs.g22(i), omega) - pairs.g12(i) * pairs.g21(i);
  return std::abs(determinant) <= share * omega * omega;
}

bool any_oscillator_resonates(const Regime& r, double omega, double share) {
  return std::ranges::any_of(r.answers, [&](const ContactAnswer& answer) {
    const Complex stiffness(answer.load.stiffness - omega * omega, omega * answer.load.damping);
    return answer.load.oscillates() && std::abs(stiffness) <= share * omega * omega;
  });
}

HarmonicResponse harmonic_response(const Regime& r, const ModalModel& slipping, double omega, Complex way,
                                   const Eigen::VectorXcd& forces) {
  const Eigen::Index nc = r.speed_input(), np = slipping.np;
  // What presses on a held contact moves nothing, and its force may be far larger than what does: the unknown there is
  // the sum of both.
  Eigen::VectorXcd on_held = Eigen::VectorXcd::Zero(nc), moving = forces;
  for (Eigen::Index k = 0; k < forces.size(); ++k)
    if (const Carried at = carried(r, slipping.input, slipping.force_input.col(k)); at.by >= 0)
      on_held(at.by) += at.share * std::exchange(moving(k), 0.0);
  const Eigen::VectorXcd forced = slipping.force_input * moving;
  const std::vector<Carried> contacts = carried_contacts(r, slipping);
  Eigen::MatrixXd input = slipping.input;
  Eigen::VectorXcd impedances(nc);
  const auto acts = [&](Eigen::Index c) {
    return r.held(static_cast<int>(c)) || (contacts[static_cast<std::size_t>(c)].by < 0 && impedances(c) != 0.0);
  };
  for (Eigen::Index c = 0; c < nc; ++c) {
    impedances(c) = impedance(r.answers[static_cast<std::size_t>(c)], omega);
    if (!acts(c)) input.col(c).setZero();
  }
  Eigen::MatrixXcd by_contacts = pair_receptances(slipping, omega, input.cast<Complex>());
  Eigen::MatrixXcd by_forces = pair_receptances(slipping, omega, forced);
  std::vector<Eigen::Index> own;  // states that are unknowns of their own
  for (Eigen::Index i = 0; i < slipping.n; ++i)
    if (resonates(slipping, i, omega, kOwnUnknown))
      for (const Eigen::Index k : {i, np + i}) {
        own.push_back(k);
        by_contacts.row(k).setZero();
        by_forces.row(k).setZero();
      }
  const Eigen::MatrixXcd H = slipping.displacement_row.transpose() * by_contacts;
  const Eigen::VectorXcd moved = slipping.displacement_row.transpose() * by_forces;

  const auto unknowns = nc + std::ssize(own);
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(unknowns, unknowns);
  Eigen::VectorXcd b = Eigen::VectorXcd::Zero(unknowns);
  // Units of the unknown forces: a soft spring's own, else it is told by its neighbours' rounding.
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(nc);
  for (Eigen::Index c = 0; c < nc; ++c) {
    const Complex own_way = r.sticks(static_cast<int>(c)) ? way : 0.0;
    if (!acts(c)) {
      const Carried& at = contacts[static_cast<std::size_t>(c)];
      A(c, c) = 1.0;
      if (at.by >= 0) b(c) = impedances(c) * (own_way - at.share * way);
      continue;
    }
    const bool held = r.held(static_cast<int>(c));
    const double reach = std::abs(H(c, c)), stiffness = std::abs(impedances(c));
    const Complex factor = held ? 1.0 : impedances(c) / stiffness;
    A.row(c).head(nc) = factor * H.row(c);
    for (Eigen::Index k = nc; k < unknowns; ++k)
      A(c, k) = factor * slipping.displacement_row(own[static_cast<std::size_t>(k - nc)], c);
    b(c) = factor * (own_way - moved(c));
    if (held) {
      if (own.empty()) unit(c) = 1.0 / reach;  // else what is left of H may be rounding
    } else {
      A(c, c) += 1.0 / stiffness;
      unit(c) = stiffness / std::max(1.0, stiffness * reach);
    }
  }
  for (Eigen::Index k = nc; k < unknowns; k += 2) {
    const Eigen::Index i = own[static_cast<std::size_t>(k - nc)];
    A.block<2, 2>(k, k) << Complex(-slipping.g11(i), omega), Complex(-slipping.g12(i)), Complex(-slipping.g21(i)),
        Complex(-slipping.g22(i), omega);
    A.row(k).head(nc) = -input.row(i).cast<Complex>();
    A.row(k + 1).head(nc) = -input.row(np + i).cast<Complex>();
    b(k) = forced(i);
    b(k + 1) = forced(np + i);
  }
  A.leftCols(nc) *= unit.asDiagonal();
  const Eigen::VectorXcd solved = own.empty() ? A.partialPivLu().solve(b).eval() : equilibrated_solve(A, b);
  HarmonicResponse out;
  out.force = unit.cwiseProduct(solved.head(nc));
  out.slipping = by_contacts * out.force + by_forces;
  out.slipping(own) = solved.tail(unknowns - nc);
  out.place_size = H.cwiseAbs() * out.force.cwiseAbs() + moved.cwiseAbs();
  for (Eigen::Index c = 0; c < nc; ++c)
    if (const Carried& at = contacts[static_cast<std::size_t>(c)]; at.by >= 0)
      out.force(at.by) -= at.share * out.force(c);
  out.force -= on_held;
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
