#include "dynamics/regime_build.hpp"

#include "core/decompositions.hpp"
#include "core/v8.hpp"
#include "dynamics/pair_form.hpp"
#include "fem/modes.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Natural frequencies below this share of the fastest are rigid-body motion.
constexpr double kRigid = 1e-8;
/// Damping counts as diagonal in the regime's modes when the rest is below this share of it.
constexpr double kProportionalTolerance = 1e-12;

/// Rows of a [2m x k] matrix spread to padded pairs [2np x k].
Eigen::MatrixXd spread(const Eigen::MatrixXd& rows, Eigen::Index np) {
  const Eigen::Index m = rows.rows() / 2;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(2 * np, rows.cols());
  out.topRows(m) = rows.topRows(m);
  out.middleRows(np, m) = rows.bottomRows(m);
  return out;
}

Eigen::MatrixXd spread_columns(const Eigen::MatrixXd& columns, Eigen::Index np) {
  return spread(columns.transpose(), np).transpose();
}

}  // namespace

RegimeBuilder::RegimeBuilder(const HybridSystem& system, const ModalModel& slipping,
                             const std::vector<ContactRole>& roles)
    : slipping_(slipping),
      modal_(slipping.modal),
      roles_(roles),
      rayleigh_(slipping.rayleigh),
      n_(slipping.n),
      nc_(static_cast<Eigen::Index>(roles.size())),
      ni_(nc_ + 3),
      V_(nc_),
      one_(nc_ + 2),
      friction_(Eigen::VectorXd::Zero(nc_)),
      K_(modal_.omega.cwiseAbs2().asDiagonal()),
      C_(modal_.damping),
      spring_(Eigen::VectorXd::Zero(nc_)) {
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const friction::Contact& contact = system.contacts()[static_cast<std::size_t>(c)];
    laws_.push_back(contact_forces(contact));
    loads_.emplace_back(contact);
    if (role(c) == ContactRole::kHeld) held_.push_back(c);
    if (load(c).oscillates()) oscillators_.push_back(c);
  }
  couple_contacts();
  eliminate_held();
}

void RegimeBuilder::couple_contacts() {
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const auto w = modal_.directions.col(c);
    if (role(c) == ContactRole::kSprung) spring_(c) = law(c).stiffness;
    if (role(c) == ContactRole::kSlidingNegative) friction_(c) = -law(c).kinetic_coefficient(-1.0);
    if (role(c) == ContactRole::kSlidingPositive) friction_(c) = law(c).kinetic_coefficient(1.0);
    if (friction_(c) != 0.0) {
      spring_(c) -= friction_(c) * load(c).y;
      if (load(c).v != 0.0) C_ -= friction_(c) * load(c).v * w * w.transpose();
      symmetric_ &= load(c).v == 0.0;
    }
    symmetric_ &= spring_(c) >= 0.0;
    if (spring_(c) != 0.0) K_ += spring_(c) * w * w.transpose();
  }
  symmetric_ &= oscillators_.empty();
  bare_ = symmetric_ && held_.empty() && spring_.isZero(0.0);
}

void RegimeBuilder::eliminate_held() {
  // η = Z y + P u: Z orthonormal and orthogonal to the held directions, P their pseudo-inverse.
  const auto s = static_cast<Eigen::Index>(held_.size());
  Z_ = Eigen::MatrixXd::Identity(n_, n_);
  P_ = Eigen::MatrixXd::Zero(n_, ni_);
  if (s > 0) {
    const Eigen::MatrixXd W = modal_.directions(Eigen::all, held_);
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(W).householderQ();
    Z_ = Q.rightCols(n_ - s).eval();
    const Eigen::MatrixXd pseudo = W * (W.transpose() * W).inverse();
    for (Eigen::Index k = 0; k < s; ++k) P_.col(held_[static_cast<std::size_t>(k)]) = pseudo.col(k);
  }
  P_all_ = P_.rowwise().sum();
}

void RegimeBuilder::set_blocks(ModalModel& pairs, const PairForm& form) const {
  pairs.proportional = false;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(pairs.np);
  pairs.g11 = pairs.g12 = pairs.g21 = pairs.g22 = none;
  pairs.g11.head(pairs.n) = form.g11;
  pairs.g12.head(pairs.n) = form.g12;
  pairs.g21.head(pairs.n) = form.g21;
  pairs.g22.head(pairs.n) = form.g22;
}

void RegimeBuilder::reuse_slipping_pairs(Regime& out) {
  ModalModel& pairs = out.pairs;
  pairs.n = slipping_.n;
  pairs.np = slipping_.np;
  pairs.g11 = slipping_.g11;
  pairs.g12 = slipping_.g12;
  pairs.g21 = slipping_.g21;
  pairs.g22 = slipping_.g22;
  pairs.proportional = slipping_.proportional;
  pairs.omega = slipping_.omega;
  pairs.damping = slipping_.damping;
  pairs.dissipation_root = slipping_.dissipation_root;
  at_.to_y = modal_.to_eta;
  at_.to_rate = modal_.to_eta_rate;
  at_.from_y = modal_.from_eta;
  at_.from_rate = modal_.from_eta_rate;
}

fem::Modes RegimeBuilder::base_modes() const {
  // The square root of the stiffness, not the stiffness, goes into the decomposition: low frequencies keep their
  // digits.
  const Eigen::Index m = Z_.cols();
  if (m == 0) return {Eigen::VectorXd(0), Eigen::MatrixXd(0, 0)};
  std::vector<Eigen::Index> sprung;
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (spring_(c) > 0.0) sprung.push_back(c);
  Eigen::MatrixXd root(n_ + static_cast<Eigen::Index>(sprung.size()), m);
  root.topRows(n_) = modal_.omega.asDiagonal() * Z_;
  for (std::size_t k = 0; k < sprung.size(); ++k)
    root.row(n_ + static_cast<Eigen::Index>(k)) =
        std::sqrt(spring_(sprung[k])) * (modal_.directions.col(sprung[k]).transpose() * Z_);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(root, Eigen::ComputeThinV);
  fem::Modes modes{svd.singularValues().reverse(), svd.matrixV().rowwise().reverse()};
  const double slowest = kRigid * modes.omega.maxCoeff();
  for (double& w : modes.omega)
    if (w <= slowest) w = 0.0;
  return modes;
}

void RegimeBuilder::make_symmetric_pairs(Regime& out) {
  const Eigen::Index m = Z_.cols();
  const auto [omega, shapes] = base_modes();
  ModalModel& pairs = out.pairs;
  Eigen::MatrixXd D = shapes.transpose() * (Z_.transpose() * C_ * Z_) * shapes;
  D = (D + D.transpose()).eval() / 2.0;
  const Eigen::VectorXd diagonal = D.diagonal();
  const bool kept = rayleigh_ && spring_.isZero(0.0);
  const Eigen::MatrixXd no_rate = Eigen::MatrixXd::Zero(m, m);
  if (kept || (D - Eigen::MatrixXd(diagonal.asDiagonal())).norm() <= kProportionalTolerance * D.norm()) {
    pairs.proportional = true;
    pairs.omega = pairs.damping = pairs.g11 = pairs.g12 = pairs.g21 = pairs.g22 = Eigen::VectorXd::Zero(pairs.np);
    pairs.omega.head(m) = omega;
    pairs.damping.head(m) =
        kept ? Eigen::VectorXd(rayleigh_->mass + rayleigh_->stiffness * omega.array().square()) : diagonal;
    pairs.g12.head(m).setOnes();
    pairs.g21 = -pairs.omega.cwiseAbs2();
    pairs.g22 = -pairs.damping;
    at_.to_y = spread_columns((Eigen::MatrixXd(m, 2 * m) << shapes, no_rate).finished(), pairs.np);
    at_.to_rate = spread_columns((Eigen::MatrixXd(m, 2 * m) << no_rate, shapes).finished(), pairs.np);
    at_.from_y = at_.to_y.transpose();
    at_.from_rate = at_.to_rate.transpose();
    return;
  }
  const BalancedState balanced = balanced_state(omega, D);
  const PairForm form = pair_form(balanced.A);
  set_blocks(pairs, form);
  const Eigen::VectorXd inverse_scale = balanced.scale.cwiseInverse();
  at_.to_y = spread_columns(shapes * inverse_scale.asDiagonal() * form.T.topRows(m), pairs.np);
  at_.to_rate = spread_columns(shapes * form.T.bottomRows(m), pairs.np);
  at_.from_y = spread(form.T_inverse.leftCols(m) * balanced.scale.asDiagonal() * shapes.transpose(), pairs.np);
  at_.from_rate = spread(form.T_inverse.rightCols(m) * shapes.transpose(), pairs.np);
}

void RegimeBuilder::make_general_pairs(Regime& out) {
  // First states: scaled displacements of the modes without what is not symmetric or not positive, then scaled ζ;
  // second states: their rates.
  const auto m = Z_.cols(), k = static_cast<Eigen::Index>(oscillators_.size()), N = m + k;
  const auto [base_omega, shapes] = base_modes();
  Eigen::VectorXd omega(N);
  omega.head(m) = base_omega;
  for (Eigen::Index j = 0; j < k; ++j)
    omega(m + j) = std::sqrt(load(oscillators_[static_cast<std::size_t>(j)]).stiffness);
  Eigen::MatrixXd damping = Eigen::MatrixXd::Zero(N, N);
  const Eigen::MatrixXd ZS = Z_ * shapes;
  damping.topLeftCorner(m, m) = ZS.transpose() * C_ * ZS;
  BalancedState state = balanced_state(omega, damping);
  Eigen::MatrixXd& A = state.A;
  for (Eigen::Index c = 0; c < nc_; ++c) {
    if (spring_(c) >= 0.0) continue;
    const Eigen::VectorXd w = ZS.transpose() * modal_.directions.col(c);
    A.block(N, 0, m, m) -= spring_(c) * w * w.cwiseQuotient(state.scale.head(m)).transpose();
  }
  for (Eigen::Index j = 0; j < k; ++j) {
    const Eigen::Index c = oscillators_[static_cast<std::size_t>(j)];
    const LoadForm& own = load(c);
    const Eigen::VectorXd w = ZS.transpose() * modal_.directions.col(c);
    A(N + m + j, N + m + j) = -own.damping;
    A.block(N + m + j, 0, 1, m) += own.lift * w.cwiseQuotient(state.scale.head(m)).transpose();
    A.block(N + m + j, N, 1, m) += own.lift_rate * w.transpose();
    A.block(N, m + j, m, 1) += friction_(c) * own.z / state.scale(m + j) * w;
    A.block(N, N + m + j, m, 1) += friction_(c) * own.z_rate * w;
  }
  const PairForm form = pair_form(A);
  ModalModel& pairs = out.pairs;
  set_blocks(pairs, form);
  const Eigen::VectorXd inverse_scale = state.scale.cwiseInverse();
  const Eigen::MatrixXd first = inverse_scale.asDiagonal() * form.T.topRows(N), second = form.T.bottomRows(N);
  const Eigen::MatrixXd from_first = form.T_inverse.leftCols(N) * state.scale.asDiagonal();
  const Eigen::MatrixXd from_second = form.T_inverse.rightCols(N);
  at_.to_y = spread_columns(shapes * first.topRows(m), pairs.np);
  at_.to_rate = spread_columns(shapes * second.topRows(m), pairs.np);
  at_.to_zeta = spread_columns(first.bottomRows(k), pairs.np);
  at_.to_zeta_rate = spread_columns(second.bottomRows(k), pairs.np);
  at_.from_y = spread(from_first.leftCols(m) * shapes.transpose(), pairs.np);
  at_.from_rate = spread(from_second.leftCols(m) * shapes.transpose(), pairs.np);
  at_.from_zeta = spread(from_first.rightCols(k), pairs.np);
  at_.from_zeta_rate = spread(from_second.rightCols(k), pairs.np);
}

void RegimeBuilder::make_pairs(Regime& out) {
  ModalModel& pairs = out.pairs;
  const auto m = Z_.cols(), k = static_cast<Eigen::Index>(oscillators_.size());
  pairs.n = m + k;
  pairs.np = padded(pairs.n);
  at_.to_zeta = at_.to_zeta_rate = Eigen::MatrixXd::Zero(k, 2 * pairs.np);
  at_.from_zeta = at_.from_zeta_rate = Eigen::MatrixXd::Zero(2 * pairs.np, k);
  if (pairs.n == 0) {
    for (auto* g : {&pairs.g11, &pairs.g12, &pairs.g21, &pairs.g22}) *g = Eigen::VectorXd::Zero(pairs.np);
    at_.to_y = at_.to_rate = Eigen::MatrixXd::Zero(0, 2 * pairs.np);
    at_.from_y = at_.from_rate = Eigen::MatrixXd::Zero(2 * pairs.np, 0);
  } else if (bare_) {
    reuse_slipping_pairs(out);
  } else if (symmetric_) {
    make_symmetric_pairs(out);
  } else {
    make_general_pairs(out);
  }
  pairs.measure_rates();
  if (!pairs.proportional && !bare_ && pairs.n > 0)
    pairs.dissipation_root = square_root(modal_.damping) * (Z_ * at_.to_rate);
}

void RegimeBuilder::make_inputs(Regime& out) const {
  // M η̈ = force: what the inputs put into the equations of y and of ζ.
  Eigen::MatrixXd force = -K_ * P_;
  force.col(V_) -= C_ * P_all_;
  force.col(one_) += modal_.load;
  Eigen::MatrixXd lift = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(oscillators_.size()), ni_);
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const auto w = modal_.directions.col(c);
    if (role(c) == ContactRole::kHeld) continue;
    force.col(c) += (role(c) == ContactRole::kSprung ? law(c).stiffness : 1.0) * w;
  }
  for (Eigen::Index j = 0; j < lift.rows(); ++j) {
    const Eigen::Index c = oscillators_[static_cast<std::size_t>(j)];
    const auto w = modal_.directions.col(c);
    lift.row(j) = load(c).lift * (w.transpose() * P_);
    lift(j, V_) += load(c).lift_rate * w.dot(P_all_);
    lift(j, one_) += load(c).lift * load(c).offset;
  }
  out.B = at_.from_rate * (Z_.transpose() * force) + at_.from_zeta_rate * lift;
  out.B_follows = Eigen::VectorXd::Zero(out.B.rows());
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (out.follows[static_cast<std::size_t>(c)]) out.B_follows += out.B.col(c);
  out.viscous_cross = ((P_all_.transpose() * modal_.damping) * Z_ * at_.to_rate).transpose();
  out.viscous_drive = P_all_.dot(modal_.damping * P_all_);
}

void RegimeBuilder::make_contact_rows(Regime& out) const {
  const auto np2 = 2 * out.pairs.np;
  const Eigen::MatrixXd eta = Z_ * at_.to_y, eta_rate = Z_ * at_.to_rate;
  out.force_row = out.velocity_row = Eigen::MatrixXd::Zero(np2, nc_);
  out.force_coefficient = out.velocity_coefficient = Eigen::MatrixXd::Zero(ni_, nc_);
  out.displacement_row = eta.transpose() * modal_.directions;
  out.displacement_coefficient = P_.transpose() * modal_.directions;
  out.spring = out.slope = Eigen::VectorXd::Zero(nc_);
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const auto w = modal_.directions.col(c);
    auto row = out.force_row.col(c), coefficient = out.force_coefficient.col(c);
    if (role(c) != ContactRole::kHeld) {
      out.velocity_row.col(c) = eta_rate.transpose() * w;
      out.velocity_coefficient(V_, c) = w.dot(P_all_);
      coefficient(c) = 1.0;
      if (role(c) == ContactRole::kSprung) {
        out.spring(c) = law(c).stiffness;
        row = -law(c).stiffness * (eta.transpose() * w);
        coefficient = -law(c).stiffness * (P_.transpose() * w);
        coefficient(c) += law(c).stiffness;
      }
    } else {
      out.velocity_coefficient(V_, c) = 1.0;
      row = (eta.transpose() * K_ + eta_rate.transpose() * C_) * P_.col(c);
      coefficient = P_.transpose() * (K_ * P_.col(c));
      coefficient(V_) += P_.col(c).dot(C_ * P_all_);
      coefficient(V_ + 1) += P_.col(c).dot(P_all_);
      coefficient(one_) -= P_.col(c).dot(modal_.load);
      for (Eigen::Index d = 0; d < nc_; ++d) {
        if (role(d) == ContactRole::kHeld) continue;
        const double share = P_.col(c).dot(modal_.directions.col(d));
        coefficient(d) -= share * (role(d) == ContactRole::kSprung ? law(d).stiffness : 1.0);
      }
    }
    for (std::size_t j = 0; j < oscillators_.size(); ++j) {
      // Friction under the load of an oscillator: on the contact itself, or felt by a held one.
      const Eigen::Index d = oscillators_[j];
      const double share = role(c) == ContactRole::kHeld ? -P_.col(c).dot(modal_.directions.col(d))
                           : c == d                      ? 1.0
                                                         : 0.0;
      row += share * friction_(d) *
             (load(d).z * at_.to_zeta.row(static_cast<Eigen::Index>(j)) +
              load(d).z_rate * at_.to_zeta_rate.row(static_cast<Eigen::Index>(j)))
                 .transpose();
    }
    if (friction_(c) != 0.0) {
      if (!load(c).oscillates()) out.slope(c) = friction_(c) * load(c).y;
      row += friction_(c) * (load(c).y * (eta.transpose() * w) + load(c).v * (eta_rate.transpose() * w));
      coefficient += friction_(c) * load(c).y * (P_.transpose() * w);
      coefficient(V_) += friction_(c) * load(c).v * w.dot(P_all_);
    }
  }
}

void RegimeBuilder::make_outputs(Regime& out) const {
  const auto np2 = 2 * out.pairs.np;
  const Eigen::MatrixXd eta = Z_ * at_.to_y, eta_rate = Z_ * at_.to_rate;
  std::vector<Eigen::VectorXd> rows, coefficients;
  const auto add = [&](Eigen::Index c, RegimeOutput::Kind kind, Eigen::VectorXd row, Eigen::VectorXd coefficient) {
    out.outputs.push_back({static_cast<int>(c), kind});
    rows.push_back(std::move(row));
    coefficients.push_back(std::move(coefficient));
  };
  for (Eigen::Index c = 0; c < nc_; ++c) {
    if (!law(c).sticks()) continue;
    const auto w = modal_.directions.col(c);
    const bool varies = load(c).varies();
    Eigen::VectorXd load_row = Eigen::VectorXd::Zero(np2), load_coefficient = Eigen::VectorXd::Zero(ni_);
    if (varies) {
      load_row = load(c).y * (eta.transpose() * w) + load(c).v * (eta_rate.transpose() * w);
      load_coefficient = load(c).y * (P_.transpose() * w);
      load_coefficient(V_) += load(c).v * w.dot(P_all_);
      load_coefficient(one_) += load(c).constant;
      const auto own = std::find(oscillators_.begin(), oscillators_.end(), c);
      if (own != oscillators_.end()) {
        const auto j = static_cast<Eigen::Index>(own - oscillators_.begin());
        load_row += (load(c).z * at_.to_zeta.row(j) + load(c).z_rate * at_.to_zeta_rate.row(j)).transpose();
      }
    }
    const Eigen::VectorXd force_row = out.force_row.col(c), force_coefficient = out.force_coefficient.col(c);
    if (role(c) != ContactRole::kSeparated) {
      if (!out.follows[static_cast<std::size_t>(c)]) {
        Eigen::VectorXd row = -out.velocity_row.col(c), coefficient = -out.velocity_coefficient.col(c);
        coefficient(V_) += 1.0;
        if (friction_(c) != 0.0 && law(c).stiffness > 0.0) {
          Eigen::VectorXd stretch_rate = force_row, drift = force_coefficient;
          out.differentiate(stretch_rate, drift);
          row -= stretch_rate / law(c).stiffness;
          coefficient -= drift / law(c).stiffness;
        }
        add(c, RegimeOutput::Kind::kSpeed, row, coefficient);
      } else if (!varies) {
        add(c, RegimeOutput::Kind::kForce, force_row, force_coefficient);
      } else {
        const double up = law(c).static_coefficient(1.0), down = law(c).static_coefficient(-1.0);
        add(c, RegimeOutput::Kind::kExcess, up * load_row - force_row, up * load_coefficient - force_coefficient);
        add(c, RegimeOutput::Kind::kReserve, down * load_row + force_row, down * load_coefficient + force_coefficient);
      }
    }
    if (varies) add(c, RegimeOutput::Kind::kLoad, load_row, load_coefficient);
  }
  const auto no = static_cast<Eigen::Index>(rows.size());
  out.row.resize(np2, no);
  out.coefficient.resize(ni_, no);
  for (Eigen::Index k = 0; k < no; ++k) {
    out.row.col(k) = rows[static_cast<std::size_t>(k)];
    out.coefficient.col(k) = coefficients[static_cast<std::size_t>(k)];
  }
}

void RegimeBuilder::make_changes(Regime& out) const {
  out.from_slipping =
      at_.from_y * (Z_.transpose() * modal_.to_eta) + at_.from_rate * (Z_.transpose() * modal_.to_eta_rate);
  out.to_slipping = modal_.from_eta * (Z_ * at_.to_y) + modal_.from_eta_rate * (Z_ * at_.to_rate);
  out.inputs_slipping = modal_.from_eta * P_;
  out.inputs_slipping.col(V_) += modal_.from_eta_rate * P_all_;
  const auto k = static_cast<Eigen::Index>(oscillators_.size());
  out.from_oscillators.resize(2 * out.pairs.np, 2 * k);
  out.to_oscillators.resize(2 * k, 2 * out.pairs.np);
  for (Eigen::Index j = 0; j < k; ++j) {
    out.from_oscillators.col(2 * j) = at_.from_zeta.col(j);
    out.from_oscillators.col(2 * j + 1) = at_.from_zeta_rate.col(j);
    out.to_oscillators.row(2 * j) = at_.to_zeta.row(j);
    out.to_oscillators.row(2 * j + 1) = at_.to_zeta_rate.row(j);
  }
}

void RegimeBuilder::fill(Regime& out) {
  out.roles = roles_;
  for (const ContactRole r : roles_) out.follows.push_back(r == ContactRole::kHeld || r == ContactRole::kSprung);
  make_pairs(out);
  make_inputs(out);
  make_contact_rows(out);
  make_outputs(out);
  make_changes(out);
}

}  // namespace slipmode::dynamics
