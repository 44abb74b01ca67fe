#include "orbits/mixed/internal/partition.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/friction/simplified.hpp>
#include "orbits/balance/internal/balance_problem.hpp"

#include <fmt/format.h>
#include <Eigen/SparseLU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;
using dynamics::HybridSystem;
using Indices = std::vector<Eigen::Index>;

Eigen::SparseMatrix<Complex> part_of(const Eigen::SparseMatrix<Complex>& A, const Indices& rows,
                                     const Indices& columns) {
  Indices place(static_cast<std::size_t>(A.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) place[static_cast<std::size_t>(rows[i])] = static_cast<Eigen::Index>(i);
  std::vector<Eigen::Triplet<Complex>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (Eigen::SparseMatrix<Complex>::InnerIterator it(A, columns[j]); it; ++it)
      if (const Eigen::Index i = place[static_cast<std::size_t>(it.row())]; i >= 0)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(j), it.value());
  Eigen::SparseMatrix<Complex> out(std::ssize(rows), std::ssize(columns));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

[[noreturn]] void fail_at(int k, double omega) {
  const std::string what =
      k == 0
          ? "floats: nothing but its own couplings holds its mean position. Keep more of it near the contacts (reach)"
          : fmt::format(
                "has a mode without damping at harmonic {} ({:.10g} rad/s). Give the structure damping, or "
                "choose another frequency",
                k, k * omega);
  throw NumericalFailure("the structure away from the contacts " + what, std::numeric_limits<double>::quiet_NaN(), {},
                         std::numeric_limits<double>::quiet_NaN());
}

/// The rest's answers to loads, columns, at order k: for these and one more that no mode is likely to be blind to, as a
/// pivot of rounding is not zero.
/// @throws NumericalFailure  where it has none
Eigen::MatrixXcd answers_at(const Eigen::SparseMatrix<Complex>& stiffness, const Eigen::MatrixXcd& loads, int k,
                            double omega) {
  constexpr double kSingular = 1e15;
  const Eigen::Index n = stiffness.rows();
  if (n == 0) return loads;
  Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu(stiffness);
  if (lu.info() != Eigen::Success) fail_at(k, omega);
  Eigen::VectorXcd probe(n);
  for (Eigen::Index i = 0; i < n; ++i) probe[i] = std::polar(1.0, static_cast<double>(i) * static_cast<double>(i));
  const Eigen::VectorXcd probed = lu.solve(probe);
  double size = 0.0;
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<Complex>::InnerIterator it(stiffness, j); it; ++it)
      size = std::max(size, std::abs(it.value()));
  if (!probed.allFinite() || size * probed.lpNorm<Eigen::Infinity>() > kSingular) fail_at(k, omega);
  return lu.solve(loads);
}

}  // namespace

Complex phasor(const Eigen::VectorXd& blocks, Eigen::Index b, Eigen::Index harmonics, Eigen::Index k) {
  const Eigen::Index first = b * (2 * harmonics + 1);
  return {blocks[first + k], k == 0 ? 0.0 : -blocks[first + harmonics + k]};
}

void put_phasor(Complex value, Eigen::Index b, Eigen::Index harmonics, Eigen::Index k, Eigen::VectorXd& out_blocks) {
  const Eigen::Index first = b * (2 * harmonics + 1);
  out_blocks[first + k] = value.real();
  if (k > 0) out_blocks[first + harmonics + k] = -value.imag();
}

Parts parts_of(const HybridSystem& system, int reach) {
  const Eigen::Index n = system.size();
  const std::array<fem::SparseMatrix, 3> matrices = {fem::to_sparse(system.structure().M()),
                                                     fem::to_sparse(system.structure().C()),
                                                     fem::to_sparse(system.structure().K())};
  std::vector<bool> is_near(static_cast<std::size_t>(n), false);
  for (const friction::Contact& contact : system.contacts())
    for (Eigen::Index i = 0; i < n; ++i)
      if (contact.direction[i] != 0.0) is_near[static_cast<std::size_t>(i)] = true;
  const auto each_coupling = [&](const auto& visit) {
    for (const fem::SparseMatrix& A : matrices)
      for (Eigen::Index j = 0; j < n; ++j)
        for (fem::SparseMatrix::InnerIterator it(A, j); it; ++it)
          if (it.value() != 0.0) visit(static_cast<std::size_t>(it.row()), static_cast<std::size_t>(j));
  };
  for (int step = 0; step < reach; ++step) {
    std::vector<bool> wider = is_near;
    each_coupling([&](std::size_t i, std::size_t j) {
      if (is_near[i]) wider[j] = true;
      if (is_near[j]) wider[i] = true;
    });
    is_near = std::move(wider);
  }
  std::vector<bool> touches(static_cast<std::size_t>(n), false);
  each_coupling([&](std::size_t i, std::size_t j) {
    if (is_near[i] != is_near[j]) touches[i] = touches[j] = true;
  });
  Parts out;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (is_near[at] && touches[at]) out.boundary.push_back(std::ssize(out.near));
    (is_near[at] ? out.near : out.rest).push_back(i);
  }
  return out;
}

int highest_harmonic_on(const HybridSystem& system, const Indices& rest, int order) {
  int highest = 1;
  for (const friction::ForceHarmonic& h : system.drive().force()->harmonics)
    if (h.amplitude != 0.0 && !system.force_directions()(rest, h.direction).isZero(0.0))
      highest = std::max(highest, h.order * order);
  return highest;
}

Partition::Partition(const HybridSystem& system, int reach, int order, int harmonics)
    : system_(system),
      order_(order),
      harmonics_(harmonics),
      omega_(system.drive().force()->omega / order),
      M_(fem::to_sparse(system.structure().M())),
      C_(fem::to_sparse(system.structure().C())),
      K_(fem::to_sparse(system.structure().K())),
      parts_(parts_of(system, reach)) {
  make_near_part();
  if (const int highest = highest_harmonic_on(system, parts_.rest, order); highest > harmonics)
    throw InvalidInput(
        fmt::format("harmonics: {}; the force away from the contacts has harmonic {} of the orbit's period: valid: "
                    "that or more",
                    harmonics, highest));
  own_coupling_ = Eigen::VectorXd::Zero(coupled() * block());
  Indices coupled_dofs;
  for (Eigen::Index b = 0; b < coupled(); ++b)
    coupled_dofs.push_back(parts_.near[static_cast<std::size_t>(boundary(b))]);
  for (int k = 0; coupled() > 0 && k <= harmonics; ++k) {
    Eigen::MatrixXcd right(std::ssize(parts_.rest), coupled() + 1);
    right << Eigen::MatrixXcd(stiffness(k, parts_.rest, coupled_dofs)), loads(k, parts_.rest);
    const Eigen::MatrixXcd answer =
        stiffness(k, coupled_dofs, parts_.rest) * answers_at(stiffness(k, parts_.rest, parts_.rest), right, k, omega_);
    impedance_.emplace_back(answer.leftCols(coupled()));
    for (Eigen::Index b = 0; b < coupled(); ++b) put_phasor(-answer(b, coupled()), b, harmonics_, k, own_coupling_);
  }
}

void Partition::make_near_part() {
  const auto part = [&](const fem::SparseMatrix& A) -> Eigen::MatrixXd {
    return Eigen::MatrixXcd(part_of(A.cast<Complex>(), parts_.near, parts_.near)).real();
  };
  near_M_ = part(M_);
  near_C_ = part(C_);
  near_K_ = part(K_);
  near_load_ = system_.load().size() > 0 ? Eigen::VectorXd(system_.load()(parts_.near))
                                         : Eigen::VectorXd::Zero(std::ssize(parts_.near)).eval();
  directions_ = Eigen::MatrixXd::Zero(std::ssize(parts_.near), system_.force_directions().cols() + coupled());
  directions_.leftCols(system_.force_directions().cols()) = system_.force_directions()(parts_.near, Eigen::all);
  for (Eigen::Index b = 0; b < coupled(); ++b) directions_(boundary(b), system_.force_directions().cols() + b) = 1.0;
  contacts_ = system_.contacts();
  for (friction::Contact& contact : contacts_) contact.direction = contact.direction(parts_.near).eval();
}

HybridSystem Partition::system_under(const Eigen::VectorXd& coupling, double share) const {
  friction::Force force{.omega = omega_, .harmonics = {}};
  for (friction::ForceHarmonic h : system_.drive().force()->harmonics) {
    h.order *= order_;
    force.harmonics.push_back(h);
  }
  Eigen::VectorXd load = near_load_;
  for (Eigen::Index b = 0; b < coupled(); ++b) {
    load[boundary(b)] += coupling[b * block()];
    for (Eigen::Index k = 1; k <= harmonics_; ++k) {
      const Complex p = phasor(coupling, b, harmonics_, k);  // Re(p e^{iθ}) = |p| sin(θ + arg p + π/2)
      force.harmonics.push_back({.amplitude = std::abs(p),
                                 .phase = std::arg(p) + 0.5 * std::numbers::pi,
                                 .order = static_cast<int>(k),
                                 .direction = static_cast<int>(own_directions() + b)});
    }
  }
  std::vector<friction::Contact> contacts = contacts_;
  if (share < 1.0)
    for (friction::Contact& contact : contacts) contact.law = friction::weakened(contact.law, share);
  std::vector<std::string> names;
  for (const Eigen::Index i : parts_.near)
    names.push_back(system_.structure().dof_names()[static_cast<std::size_t>(i)]);
  return {fem::Structure(near_M_, near_C_, near_K_, std::move(names), system_.structure().units()), std::move(contacts),
          std::move(force), std::move(load), directions_};
}

Eigen::MatrixXd Partition::coupling_by(const Eigen::MatrixXd& motion) const {
  // (S p): cosines Re S a + Im S b, sines Re S b − Im S a, for p = a − i b.
  Eigen::MatrixXd out(motion.rows(), motion.cols());
  Eigen::MatrixXd a(coupled(), motion.cols()), b(coupled(), motion.cols());
  for (Eigen::Index k = 0; k <= harmonics_; ++k) {
    const Eigen::MatrixXcd& S = impedance_[static_cast<std::size_t>(k)];
    for (Eigen::Index c = 0; c < coupled(); ++c) {
      a.row(c) = motion.row(c * block() + k);
      if (k > 0) b.row(c) = motion.row(c * block() + harmonics_ + k);
    }
    Eigen::MatrixXd cosines = S.real() * a, sines;
    if (k > 0) {
      cosines += S.imag() * b;
      sines = S.real() * b - S.imag() * a;
    }
    for (Eigen::Index c = 0; c < coupled(); ++c) {
      out.row(c * block() + k) = cosines.row(c);
      if (k > 0) out.row(c * block() + harmonics_ + k) = sines.row(c);
    }
  }
  return out;
}

Eigen::MatrixXcd Partition::rest_under(const Eigen::VectorXd& motion) const {
  Eigen::MatrixXcd out(std::ssize(parts_.rest), harmonics_ + 1);
  for (int k = 0; k <= harmonics_ && !parts_.rest.empty(); ++k) {
    Eigen::VectorXcd moved = Eigen::VectorXcd::Zero(std::ssize(parts_.near));
    for (Eigen::Index b = 0; b < coupled(); ++b) moved[boundary(b)] = phasor(motion, b, harmonics_, k);
    out.col(k) = answers_at(stiffness(k, parts_.rest, parts_.rest),
                            loads(k, parts_.rest) - stiffness(k, parts_.rest, parts_.near) * moved, k, omega_);
  }
  return out;
}

Partition::Response Partition::without_contacts() const {
  Indices all(static_cast<std::size_t>(system_.size()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Eigen::Index>(i);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(std::ssize(parts_.near)), v = q;
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(coupled() * block());
  int highest = static_cast<int>(harmonics_);
  for (const friction::ForceHarmonic& h : system_.drive().force()->harmonics)
    highest = std::max(highest, h.order * order_);
  for (int k = 0; k <= highest; ++k) {
    const Eigen::VectorXcd load = loads(k, all);
    if (load.isZero(0.0)) continue;
    const Eigen::SparseLU<SparseComplex> lu(stiffness(k, all, all));
    if (lu.info() != Eigen::Success) continue;  // floats, or resounds: the contacts hold it
    const Eigen::VectorXcd answer = lu.solve(load);
    if (!answer.allFinite()) continue;
    const Eigen::VectorXcd near = answer(parts_.near);
    q += near.real();
    v -= k * omega_ * near.imag();
    for (Eigen::Index b = 0; k <= harmonics_ && b < coupled(); ++b)
      put_phasor(near[boundary(b)], b, harmonics_, k, motion);
  }
  Eigen::VectorXd coupling = own_coupling_;
  if (coupled() > 0) coupling += coupling_by(motion);
  return {{.time = 0.0, .q = std::move(q), .v = std::move(v)}, std::move(coupling)};
}

Partition::SparseComplex Partition::stiffness(int k, const Indices& rows, const Indices& columns) const {
  const double w = k * omega_;
  SparseComplex D = K_.cast<Complex>();
  if (k > 0) D += Complex(0.0, w) * C_.cast<Complex>() - Complex(w * w) * M_.cast<Complex>();
  return part_of(D, rows, columns);
}

Eigen::VectorXcd Partition::loads(int k, const Indices& rows) const {
  if (k == 0) {
    if (system_.load().size() == 0) return Eigen::VectorXcd::Zero(std::ssize(rows));
    return system_.load()(rows).cast<Complex>();
  }
  return system_.force_directions()(rows, Eigen::all) * drive_phasors(system_, order_, k);
}

}  // namespace slipmode::orbits
