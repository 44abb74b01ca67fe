#include "dynamics/internal/harmonic_response.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/dynamics/receptance.hpp>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
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

/// Directions differ by no more than rounding to this share of their size.
constexpr double kSame = 1e-13;

/// A direction along that of a contact.
struct Along {
  Eigen::Index of = -1;  ///< the contact; -1: none
  double share = 0.0;    ///< its displacement over that of the contact
};

/// @param direction  as a column, with those of the contacts in `of_contacts` @param among  the contacts asked about
Along along(const Eigen::MatrixXd& of_contacts, const std::vector<Eigen::Index>& among,
            const Eigen::VectorXd& direction) {
  for (const Eigen::Index d : among) {
    const double share = of_contacts.col(d).dot(direction) / of_contacts.col(d).squaredNorm();
    if ((direction - share * of_contacts.col(d)).norm() <= kSame * direction.norm()) return {d, share};
  }
  return {};
}

/// Of contacts that are not held, those that a held one carries.
std::vector<Along> carried_contacts(const Regime& r, const ModalModel& slipping) {
  std::vector<Eigen::Index> held;
  for (Eigen::Index c = 0; c < r.speed_input(); ++c)
    if (r.held(static_cast<int>(c))) held.push_back(c);
  std::vector<Along> out(static_cast<std::size_t>(r.speed_input()));
  for (Eigen::Index c = 0; c < r.speed_input(); ++c)
    if (!r.held(static_cast<int>(c)))
      out[static_cast<std::size_t>(c)] = along(slipping.displacement_row, held, slipping.displacement_row.col(c));
  return out;
}

/// Forces along given directions as some on contacts, which hold against them, and what is left beside these.
struct Pressing {
  Eigen::MatrixXd on;    ///< per force [nc x nk]
  Eigen::MatrixXd rest;  ///< directions of what is left [2np x nk]
};

/// @param stiff  the contacts that hold @param impedances  of those that are not held: those at one place share
/// what presses on it by their stiffnesses
Pressing pressing_on(const Regime& r, const ModalModel& slipping, const std::vector<Eigen::Index>& stiff,
                     const Eigen::VectorXcd& impedances) {
  Pressing out{Eigen::MatrixXd::Zero(r.speed_input(), r.forces), slipping.force_input};
  if (stiff.empty() || r.forces == 0) return out;
  std::vector<Eigen::Index> places;  // the first contact at each
  std::vector<Along> place_of;
  Eigen::VectorXd borne = Eigen::VectorXd::Zero(r.speed_input());
  const auto bears = [&](Eigen::Index c) { return r.held(static_cast<int>(c)) ? 1.0 : std::abs(impedances(c)); };
  for (const Eigen::Index c : stiff) {
    Along place = along(slipping.input, places, slipping.input.col(c));
    if (place.of < 0) {
      places.push_back(c);
      place = {c, 1.0};
    }
    place_of.push_back(place);
    borne(place.of) += bears(c) * place.share * place.share;
  }
  const Eigen::MatrixXd directions = slipping.input(Eigen::all, places);
  Eigen::MatrixXd shares =
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(directions).solve(slipping.force_input);
  // What is rounding would move things that rest.
  const Eigen::VectorXd sizes = kSame * slipping.force_input.colwise().norm();
  for (Eigen::Index k = 0; k < r.forces; ++k)
    for (Eigen::Index j = 0; j < shares.rows(); ++j)
      if (std::abs(shares(j, k)) * directions.col(j).norm() <= sizes(k)) shares(j, k) = 0.0;
  Eigen::MatrixXd at = Eigen::MatrixXd::Zero(r.speed_input(), r.forces);
  at(places, Eigen::all) = shares;
  for (std::size_t k = 0; k < stiff.size(); ++k) {
    const Along& place = place_of[k];
    out.on.row(stiff[k]) = (bears(stiff[k]) * place.share / borne(place.of)) * at.row(place.of);
  }
  out.rest -= directions * shares;
  for (Eigen::Index k = 0; k < r.forces; ++k)
    if (out.rest.col(k).norm() <= sizes(k)) out.rest.col(k).setZero();
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
  const std::vector<Along> contacts = carried_contacts(r, slipping);
  Eigen::MatrixXd input = slipping.input;
  Eigen::VectorXcd impedances(nc);
  const auto acts = [&](Eigen::Index c) {
    return r.held(static_cast<int>(c)) || (contacts[static_cast<std::size_t>(c)].of < 0 && impedances(c) != 0.0);
  };
  for (Eigen::Index c = 0; c < nc; ++c) {
    impedances(c) = impedance(r.answers[static_cast<std::size_t>(c)], omega);
    if (!acts(c)) input.col(c).setZero();
  }
  std::vector<Eigen::Index> own;  // states that are unknowns of their own
  for (Eigen::Index i = 0; i < slipping.n; ++i)
    if (resonates(slipping, i, omega, kOwnUnknown)) own.insert(own.end(), {i, np + i});
  Eigen::MatrixXcd by_contacts = pair_receptances(slipping, omega, input.cast<Complex>());
  by_contacts(own, Eigen::all).setZero();
  const Eigen::MatrixXcd H = slipping.displacement_row.transpose() * by_contacts;

  // What presses on a held contact, or on one stiffer than the structure, moves little of what it would move without,
  // and its force may be far larger than what does: the unknown there is the sum of both.
  std::vector<Eigen::Index> stiff;
  for (Eigen::Index c = 0; c < nc; ++c)
    if (r.held(static_cast<int>(c)) || std::abs(impedances(c) * H(c, c)) > 1.0) stiff.push_back(c);
  const Pressing pressing = pressing_on(r, slipping, stiff, impedances);
  const Eigen::VectorXcd pressed = pressing.on * forces, forced = pressing.rest * forces;
  Eigen::VectorXcd by_forces = pair_receptances(slipping, omega, forced);
  by_forces(own).setZero();
  const Eigen::VectorXcd moved = slipping.displacement_row.transpose() * by_forces;

  const auto unknowns = nc + std::ssize(own);
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(unknowns, unknowns);
  Eigen::VectorXcd b = Eigen::VectorXcd::Zero(unknowns);
  // Units of the unknown forces: a soft spring's own, else it is told by its neighbours' rounding.
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(nc);
  for (Eigen::Index c = 0; c < nc; ++c) {
    const Complex own_way = r.sticks(static_cast<int>(c)) ? way : 0.0;
    if (!acts(c)) {
      const Along& at = contacts[static_cast<std::size_t>(c)];
      A(c, c) = 1.0;
      if (at.of >= 0) b(c) = impedances(c) * (own_way - at.share * way);
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
      b(c) += pressed(c) / stiffness;
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
    if (const Along& at = contacts[static_cast<std::size_t>(c)]; at.of >= 0)
      out.force(at.of) -= at.share * out.force(c);
  out.force -= pressed;
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
