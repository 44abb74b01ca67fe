#include <slipmode/dynamics/modal_model.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/fem/modes.hpp>
#include "dynamics/internal/pair_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// C in modal coordinates counts as diagonal when the rest is below this share of it.
constexpr double kProportionalTolerance = 1e-12;

Eigen::MatrixXd contact_directions(const HybridSystem& system) {
  Eigen::MatrixXd W(system.size(), static_cast<Eigen::Index>(system.contacts().size()));
  for (Eigen::Index c = 0; c < W.cols(); ++c) W.col(c) = system.contacts()[static_cast<std::size_t>(c)].direction;
  return W;
}

/// Wᵀ Φ. What is left where a sum cancels is rounding, of which the spring between two masses that float would make a
/// force on both together.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& W, const Eigen::MatrixXd& shapes) {
  constexpr double kRounds = 64.0 * std::numeric_limits<double>::epsilon();
  const Eigen::MatrixXd rows = W.transpose() * shapes, sizes = W.cwiseAbs().transpose() * shapes.cwiseAbs();
  return (rows.array().abs() > kRounds * sizes.array()).select(rows, 0.0);
}

/// The least-squares a + b ω² through the modal dampings, if it fits to rounding.
std::optional<fem::Rayleigh> fit_rayleigh(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping) {
  const double fastest = omega.size() > 0 && omega.maxCoeff() > 0.0 ? omega.maxCoeff() : 1.0;
  Eigen::MatrixXd A(omega.size(), 2);
  A << Eigen::VectorXd::Ones(omega.size()), (omega / fastest).array().square().matrix();
  const Eigen::Vector2d ab = A.colPivHouseholderQr().solve(damping);
  if (!((A * ab - damping).norm() <= kProportionalTolerance * damping.norm())) return std::nullopt;
  return fem::Rayleigh{ab(0), ab(1) / (fastest * fastest)};
}

/// Everything that follows from G, the inputs and the rows.
void finish(ModalModel& m) {
  const auto np = m.np;
  const auto apply_transposed_G = [&](const Eigen::VectorXd& row) {
    Eigen::VectorXd out(2 * np);
    out.head(np) = m.g11.cwiseProduct(row.head(np)) + m.g21.cwiseProduct(row.tail(np));
    out.tail(np) = m.g12.cwiseProduct(row.head(np)) + m.g22.cwiseProduct(row.tail(np));
    return out;
  };
  m.acceleration_row.resize(2 * np, m.contacts);
  for (int c = 0; c < m.contacts; ++c) m.acceleration_row.col(c) = apply_transposed_G(m.velocity_row.col(c));
  m.mobility = m.velocity_row.transpose() * m.input;
  m.load_acceleration = m.velocity_row.transpose() * m.load;
  m.force_acceleration = m.velocity_row.transpose() * m.force_input;
  m.measure_rates();
}

void size_arrays(ModalModel& m) {
  const auto np = m.np;
  for (auto* g : {&m.g11, &m.g12, &m.g21, &m.g22}) *g = Eigen::VectorXd::Zero(np);
  m.input = m.displacement_row = m.velocity_row = Eigen::MatrixXd::Zero(2 * np, m.contacts);
  m.load = Eigen::VectorXd::Zero(2 * np);
}

/// Real modes: pair = (η, η̇).
void fill_proportional(ModalModel& m, const Eigen::VectorXd& omega, const Eigen::VectorXd& damping,
                       const Eigen::MatrixXd& rows, const Eigen::VectorXd& modal_load,
                       const Eigen::MatrixXd& modal_forces) {
  size_arrays(m);
  m.force_input = Eigen::MatrixXd::Zero(2 * m.np, modal_forces.cols());
  m.force_input.middleRows(m.np, m.n) = modal_forces;
  m.force_row = m.force_input;
  m.omega = m.damping = Eigen::VectorXd::Zero(m.np);
  m.omega.head(m.n) = omega;
  m.damping.head(m.n) = damping;
  m.g12.head(m.n).setOnes();
  m.g21.head(m.n) = -omega.array().square().matrix();
  m.g22.head(m.n) = -damping;
  m.input.middleRows(m.np, m.n) = rows.transpose();
  m.velocity_row.middleRows(m.np, m.n) = rows.transpose();
  m.displacement_row.topRows(m.n) = rows.transpose();
  m.load.segment(m.np, m.n) = modal_load;
  m.rayleigh = fit_rayleigh(omega, damping);
}

void fill_shapes(ModalModel& m, const Eigen::MatrixXd& shapes, const Eigen::MatrixXd& shapes_M) {
  m.to_q = m.to_v = Eigen::MatrixXd::Zero(m.n, 2 * m.np);
  m.from_q = m.from_v = Eigen::MatrixXd::Zero(2 * m.np, m.n);
  m.to_q.leftCols(m.n) = shapes;
  m.to_v.middleCols(m.np, m.n) = shapes;
  m.from_q.topRows(m.n) = shapes_M.transpose();
  m.from_v.middleRows(m.np, m.n) = shapes_M.transpose();
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(m.n, m.n);
  m.modal.to_eta = m.modal.to_eta_rate = Eigen::MatrixXd::Zero(m.n, 2 * m.np);
  m.modal.to_eta.leftCols(m.n) = m.modal.to_eta_rate.middleCols(m.np, m.n) = unit;
  m.modal.from_eta = m.modal.to_eta.transpose();
  m.modal.from_eta_rate = m.modal.to_eta_rate.transpose();
}

/// Complex modes of the state matrix, in real form, from the modes of the undamped structure, so that the state is
/// balanced.
void fill_general(ModalModel& m, const fem::Modes& modes, const Eigen::MatrixXd& shapes_M, const Eigen::MatrixXd& D,
                  const Eigen::MatrixXd& rows, const Eigen::VectorXd& modal_load, const Eigen::MatrixXd& modal_forces) {
  const auto n = m.n, np = m.np;
  const BalancedState balanced = balanced_state(modes.omega, D);
  const PairForm form = pair_form(balanced.A);
  check_pair_form(form, balanced.scale);
  size_arrays(m);
  m.proportional = false;
  m.g11.head(n) = form.g11;
  m.g12.head(n) = form.g12;
  m.g21.head(n) = form.g21;
  m.g22.head(n) = form.g22;

  const auto spread_rows = [&](const Eigen::MatrixXd& source) {  // 2n x k → 2np x k
    Eigen::MatrixXd target = Eigen::MatrixXd::Zero(2 * np, source.cols());
    target.topRows(n) = source.topRows(n);
    target.middleRows(np, n) = source.bottomRows(n);
    return target;
  };
  const Eigen::VectorXd inverse_scale = balanced.scale.cwiseInverse();
  const Eigen::MatrixXd eta = inverse_scale.asDiagonal() * form.T.topRows(n), eta_dot = form.T.bottomRows(n);
  const Eigen::MatrixXd from_eta = form.T_inverse.leftCols(n) * balanced.scale.asDiagonal();
  const Eigen::MatrixXd from_eta_dot = form.T_inverse.rightCols(n);
  m.input = spread_rows(from_eta_dot * rows.transpose());
  m.load = spread_rows(from_eta_dot * modal_load);
  m.force_input = spread_rows(from_eta_dot * modal_forces);
  m.force_row = spread_rows((modal_forces.transpose() * eta_dot).transpose());
  m.displacement_row = spread_rows((rows * eta).transpose());
  m.velocity_row = spread_rows((rows * eta_dot).transpose());
  m.to_q = spread_rows((modes.shapes * eta).transpose()).transpose();
  m.to_v = spread_rows((modes.shapes * eta_dot).transpose()).transpose();
  m.from_q = spread_rows(from_eta * shapes_M.transpose());
  m.from_v = spread_rows(from_eta_dot * shapes_M.transpose());
  m.dissipation_root = spread_rows((square_root(D) * eta_dot).transpose()).transpose();
  m.modal.to_eta = spread_rows(eta.transpose()).transpose();
  m.modal.to_eta_rate = spread_rows(eta_dot.transpose()).transpose();
  m.modal.from_eta = spread_rows(from_eta);
  m.modal.from_eta_rate = spread_rows(from_eta_dot);
}

/// e^{Gt} = whole I + rest, e^{Gt} − I = less_one I + rest.
struct PairExponential {
  double whole, less_one;
  Eigen::Matrix2d rest;

  PairExponential(const ModalModel& m, Eigen::Index i, double t) {
    const double tau = (m.g11(i) + m.g22(i)) / 2.0, det = m.g11(i) * m.g22(i) - m.g12(i) * m.g21(i);
    const double delta = det - tau * tau;  // > 0: oscillating
    const Eigen::Matrix2d I = Eigen::Matrix2d::Identity(), G{{m.g11(i), m.g12(i)}, {m.g21(i), m.g22(i)}};
    if (delta > 0.0) {
      const double w = std::sqrt(delta), growth = std::exp(tau * t), half = std::sin(w * t / 2.0);
      whole = growth * std::cos(w * t);
      less_one = std::expm1(tau * t) - 2.0 * growth * half * half;
      rest = growth * std::sin(w * t) / w * (G - tau * I);
      return;
    }
    // Newton's form by two decaying exponentials, the slow one first: what rests of a rigid body rests exactly, and a
    // fast decay does not multiply 0 by infinity.
    const double w = std::sqrt(-delta), fast = tau - w;
    const double slow = tau < 0.0 ? det / fast : tau + w;  // no cancellation
    whole = std::exp(slow * t);
    less_one = std::expm1(slow * t);
    const double apart = std::abs(w * t) > 1.0 ? (whole - std::exp(fast * t)) / (2.0 * w)
                                               : std::exp(tau * t) * (w > 0.0 ? std::sinh(w * t) / w : t);
    rest = apart * (G - slow * I);
  }
};

}  // namespace

Eigen::MatrixXd square_root(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> root(Eigen::MatrixXd((A + A.transpose()) / 2.0));
  return root.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * root.eigenvectors().transpose();
}

void separate_rigid_modes(const Eigen::VectorXd& omega, Eigen::MatrixXd& shapes, Eigen::MatrixXd& damping,
                          double damping_size, Eigen::MatrixXd* coupled) {
  std::vector<Eigen::Index> rigid;
  for (Eigen::Index i = 0; i < omega.size(); ++i)
    if (omega(i) == 0.0) rigid.push_back(i);
  if (rigid.empty()) return;
  // A solver turns a rigid-body shape towards the others by rounding of the largest ω² over theirs, most to the
  // softest.
  constexpr double kTurns = 16.0 * std::numeric_limits<double>::epsilon(), kMostTurned = 1e-9;
  double softest = omega.maxCoeff();
  for (const double w : omega)
    if (w > 0.0) softest = std::min(softest, w);
  const double turned = softest > 0.0 ? kTurns * std::pow(omega.maxCoeff() / softest, 2) : 0.0;
  const double rounding = std::clamp(turned, kProportionalTolerance, kMostTurned);
  Eigen::MatrixXd own = damping(rigid, rigid);
  own = (own + own.transpose()).eval() / 2.0;
  const auto m = own.rows();
  Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(m, m);
  Eigen::Index reached = 0;
  if (coupled != nullptr && coupled->cols() > 0) {
    // What the terms do not reach comes last, apart: its displacements then change nothing, and stay exact zeros of A.
    const Eigen::VectorXd size = coupled->colwise().norm().transpose().cwiseMax(1e-300);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd((*coupled)(rigid, Eigen::all) * size.cwiseInverse().asDiagonal(),
                                                Eigen::ComputeFullU);
    reached = (svd.singularValues().array() > rounding).count();
    Q = svd.matrixU();
  }
  for (const auto& [begin, count] : {std::pair{Eigen::Index{0}, reached}, std::pair{reached, m - reached}}) {
    if (count == 0) continue;
    auto part = Q.middleCols(begin, count);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> turn(Eigen::MatrixXd(part.transpose() * own * part));
    part = (part * turn.eigenvectors()).eval();
  }
  shapes(Eigen::all, rigid) = (shapes(Eigen::all, rigid) * Q).eval();
  damping(rigid, Eigen::all) = (Q.transpose() * damping(rigid, Eigen::all)).eval();
  damping(Eigen::all, rigid) = (damping(Eigen::all, rigid) * Q).eval();
  const double nothing = rounding * damping_size;
  for (const Eigen::Index i : rigid)
    if (damping.row(i).norm() <= nothing && damping.col(i).norm() <= nothing) {
      damping.row(i).setZero();
      damping.col(i).setZero();
    }
  if (coupled == nullptr) return;
  (*coupled)(rigid, Eigen::all) = (Q.transpose() * (*coupled)(rigid, Eigen::all)).eval();
  for (auto w : coupled->colwise())
    for (const Eigen::Index i : rigid)
      if (std::abs(w(i)) <= rounding * w.norm()) w(i) = 0.0;
}

void ModalModel::measure_rates() {
  for (Eigen::Index i = 0; i < n; ++i) {
    const double half_trace = (g11(i) + g22(i)) / 2.0, det = g11(i) * g22(i) - g12(i) * g21(i);
    const double gap = half_trace * half_trace - det;
    const double size = gap < 0 ? std::sqrt(det) : std::abs(half_trace) + std::sqrt(gap);
    fastest = std::max(fastest, size);
  }
}

double ModalModel::viscous_power(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  if (dissipation_root.size() > 0) return (dissipation_root * x).squaredNorm();
  return damping.dot(x.tail(np).cwiseAbs2());
}

double ModalModel::viscous_power(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const {
  if (dissipation_root.size() > 0) return (dissipation_root * x).dot(dissipation_root * y);
  return damping.dot(x.tail(np).cwiseProduct(y.tail(np)));
}

Eigen::VectorXd ModalModel::rate(const Eigen::VectorXd& x, const Eigen::VectorXd& force) const {
  Eigen::VectorXd rate = input * force + load;
  rate.head(np) += g11.cwiseProduct(x.head(np)) + g12.cwiseProduct(x.tail(np));
  rate.tail(np) += g21.cwiseProduct(x.head(np)) + g22.cwiseProduct(x.tail(np));
  return rate;
}

Eigen::Matrix2d ModalModel::exponential(Eigen::Index i, double t) const {
  const PairExponential e(*this, i, t);
  return e.whole * Eigen::Matrix2d::Identity() + e.rest;
}

Eigen::Matrix2d ModalModel::change(Eigen::Index i, double t) const {
  const PairExponential e(*this, i, t);
  return e.less_one * Eigen::Matrix2d::Identity() + e.rest;
}

ModalModel build_modal_model(const HybridSystem& system, bool rows_only) {
  const fem::Structure& structure = system.structure();
  ModalModel m;
  m.n = structure.size();
  m.np = padded(m.n);
  m.contacts = static_cast<int>(system.contacts().size());
  m.contact_offset.resize(m.contacts);
  for (int c = 0; c < m.contacts; ++c) m.contact_offset(c) = system.contacts()[static_cast<std::size_t>(c)].offset;

  const Eigen::MatrixXd W = contact_directions(system);
  const bool loaded = system.load().size() > 0;
  const auto rayleigh = structure.rayleigh();
  const auto rayleigh_damping = [&](const Eigen::VectorXd& omega) -> Eigen::VectorXd {
    return rayleigh->mass + (rayleigh->stiffness * omega.array().square());
  };

  if (rows_only && rayleigh && structure.is_chain_like()) {
    const Eigen::Index nk = system.force_directions().cols();
    Eigen::MatrixXd vectors(m.n, m.contacts + nk + (loaded ? 1 : 0));
    vectors.leftCols(m.contacts) = W;
    vectors.middleCols(m.contacts, nk) = system.force_directions();
    if (loaded) vectors.rightCols(1) = system.load();
    const fem::ModalRows modal = fem::modal_rows(structure, vectors);
    const Eigen::VectorXd load =
        loaded ? Eigen::VectorXd(modal.rows.bottomRows(1).transpose()) : Eigen::VectorXd::Zero(m.n);
    fill_proportional(m, modal.omega, rayleigh_damping(modal.omega), modal.rows.topRows(m.contacts), load,
                      modal.rows.middleRows(m.contacts, nk).transpose());
    m.rayleigh = rayleigh;
    finish(m);
    return m;
  }

  fem::Modes modes = fem::natural_modes(structure);
  Eigen::MatrixXd D;
  if (!rayleigh) {
    D = modes.shapes.transpose() * fem::multiply(structure.C(), modes.shapes);
    if ((D - D.transpose()).norm() <= kProportionalTolerance * D.norm()) D = (D + D.transpose()).eval() / 2.0;
    separate_rigid_modes(modes.omega, modes.shapes, D, D.norm());
  }
  const Eigen::MatrixXd rows = rows_of(W, modes.shapes);
  const Eigen::VectorXd load =
      loaded ? Eigen::VectorXd(modes.shapes.transpose() * system.load()) : Eigen::VectorXd::Zero(m.n);
  const Eigen::MatrixXd shapes_M = fem::multiply(structure.M(), modes.shapes);
  m.modal.omega = modes.omega;
  m.modal.directions = rows.transpose();
  m.modal.load = load;
  m.modal.forces = modes.shapes.transpose() * system.force_directions();
  if (rayleigh) {
    m.modal.damping = rayleigh_damping(modes.omega).asDiagonal();
    fill_proportional(m, modes.omega, rayleigh_damping(modes.omega), rows, load, m.modal.forces);
    m.rayleigh = rayleigh;
    fill_shapes(m, modes.shapes, shapes_M);
  } else {
    const Eigen::VectorXd diagonal = D.diagonal();
    if ((D - Eigen::MatrixXd(diagonal.asDiagonal())).norm() <= kProportionalTolerance * D.norm()) {
      m.modal.damping = diagonal.asDiagonal();
      fill_proportional(m, modes.omega, diagonal, rows, load, m.modal.forces);
      fill_shapes(m, modes.shapes, shapes_M);
    } else {
      m.modal.damping = D;
      fill_general(m, modes, shapes_M, D, rows, load, m.modal.forces);
    }
  }
  finish(m);
  m.place_row.resize(2 * m.np, 2 * W.cols());
  m.place_row << m.to_q.cwiseAbs().transpose() * W.cwiseAbs(), m.to_v.cwiseAbs().transpose() * W.cwiseAbs();
  return m;
}

ModalModel with_given_forces(const ModalModel& model) {
  ModalModel m;
  m.n = model.n;
  m.np = model.np;
  m.given = static_cast<int>(model.force_input.cols());
  m.contacts = model.contacts + m.given;
  m.g11 = model.g11;
  m.g12 = model.g12;
  m.g21 = model.g21;
  m.g22 = model.g22;
  m.input.resize(2 * m.np, m.contacts);
  m.input << model.input, model.force_input;
  m.load = model.load;
  m.velocity_row.resize(2 * m.np, m.contacts);
  m.velocity_row << model.velocity_row, model.force_row;
  m.displacement_row = Eigen::MatrixXd::Zero(2 * m.np, m.contacts);
  m.displacement_row.leftCols(model.contacts) = model.displacement_row;
  m.fastest = model.fastest;
  m.proportional = model.proportional;
  m.omega = model.omega;
  m.modal.omega = model.modal.omega;
  m.damping = model.damping;
  m.dissipation_root = model.dissipation_root;
  return m;
}

}  // namespace slipmode::dynamics
