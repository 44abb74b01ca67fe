#include "dynamics/internal/regime_build.hpp"

#include <slipmode/core/coupled_parts.hpp>
#include <slipmode/core/decompositions.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/friction/places.hpp>
#include "dynamics/internal/sprung_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace slipmode::dynamics {
namespace {

/// Natural frequencies below this share of the fastest are rigid-body motion.
constexpr double kRigid = 1e-8;
/// Rounding: damping counts as diagonal in the regime's modes when the rest is below this share of it, and a direction
/// as projected out when no more than this share of it is left.
constexpr double kRounding = 1e-12;

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
      along_(friction::by_direction(system.contacts())),
      n_(slipping.n),
      nc_(static_cast<Eigen::Index>(roles.size())),
      nk_(modal_.forces.cols()),
      ni_(nc_ + 3 + nk_),
      V_(nc_),
      one_(nc_ + 2),
      friction_(Eigen::VectorXd::Zero(nc_)),
      most_damped_(slipping.proportional ? Eigen::VectorXd(modal_.damping.diagonal().cwiseAbs())
                                         : Eigen::VectorXd(modal_.damping.cwiseAbs().rowwise().sum())),
      C_(modal_.damping),
      spring_(Eigen::VectorXd::Zero(nc_)),
      damper_(Eigen::VectorXd::Zero(nc_)) {
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const friction::Contact& contact = system.contacts()[static_cast<std::size_t>(c)];
    laws_.push_back(contact_forces(contact));
    loads_.emplace_back(contact);
    if (role(c) == ContactRole::kHeld) held_.push_back(c);
    if (load(c).oscillates()) oscillators_.push_back(c);
  }
  couple_contacts();
  eliminate_held();
  moved_ = left_of(modal_.directions);
}

Eigen::MatrixXd RegimeBuilder::left_of(const Eigen::MatrixXd& directions) const {
  Eigen::MatrixXd left = Z_.transpose() * directions;
  for (Eigen::Index k = 0; k < left.cols(); ++k)
    if (!(left.col(k).norm() > kRounding * directions.col(k).norm())) left.col(k).setZero();
  return left;
}

void RegimeBuilder::couple_contacts() {
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const auto w = modal_.directions.col(c);
    const ContactAnswer& answer = answers_.emplace_back(contact_answer(law(c), load(c), role(c)));
    spring_(c) = answer.stiffness;
    friction_(c) = answer.friction;
    if (role(c) == ContactRole::kLeftStop || role(c) == ContactRole::kRightStop) damper_(c) = answer.damping;
    if (answer.damping != 0.0) C_ += answer.damping * w * w.transpose();
    symmetric_ &= friction_(c) == 0.0 || load(c).v == 0.0;
    symmetric_ &= spring_(c) >= 0.0;
  }
  symmetric_ &= oscillators_.empty();
  bare_ = symmetric_ && held_.empty() && spring_.isZero(0.0) && damper_.isZero(0.0);
}

const friction::Stop* RegimeBuilder::stop(Eigen::Index c) const {
  const ContactRole is = role(c);
  if (is == ContactRole::kLeftStop || is == ContactRole::kLeftFlight) return &*law(c).clearance.left;
  if (is == ContactRole::kRightStop || is == ContactRole::kRightFlight) return &*law(c).clearance.right;
  return nullptr;
}

void RegimeBuilder::eliminate_held() {
  // η = Z y + P u: Z orthonormal and orthogonal to the held directions, P their pseudo-inverse.
  const auto s = static_cast<Eigen::Index>(held_.size());
  Z_ = Eigen::MatrixXd::Identity(n_, n_);
  P_ = Eigen::MatrixXd::Zero(n_, ni_);
  if (s > 0) {
    const Eigen::MatrixXd W = modal_.directions(Eigen::all, held_);
    std::vector<Eigen::Index> reached, others;
    for (Eigen::Index i = 0; i < n_; ++i) (W.row(i).isZero(0.0) ? others : reached).push_back(i);
    // With the largest first, what a heavy part hardly moves with keeps its digits.
    std::ranges::stable_sort(reached, std::ranges::greater{},
                             [&](Eigen::Index i) { return W.row(i).lpNorm<Eigen::Infinity>(); });
    const auto m = static_cast<Eigen::Index>(reached.size());
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(W(reached, Eigen::all)).householderQ();
    Z_ = Eigen::MatrixXd::Zero(n_, n_ - s);
    Z_(reached, Eigen::seqN(0, m - s)) = Q.rightCols(m - s);
    for (std::size_t k = 0; k < others.size(); ++k) Z_(others[k], m - s + static_cast<Eigen::Index>(k)) = 1.0;
    const Eigen::MatrixXd pseudo = W * (W.transpose() * W).inverse();
    for (Eigen::Index k = 0; k < s; ++k) P_.col(held_[static_cast<std::size_t>(k)]) = pseudo.col(k);
  }
  P_all_ = P_.rowwise().sum();
  // w k wᵀ of a stiff contact's spring as two factors: formed, its rounding would push in all directions, not along w.
  const Eigen::MatrixXd& W_all = modal_.directions;
  const Eigen::MatrixXd sizes = W_all.cwiseAbs(), P_sizes = P_.cwiseAbs();
  const Eigen::VectorXd own = modal_.omega.cwiseAbs2();
  KP_ = own.asDiagonal() * P_ + W_all * (spring_.asDiagonal() * (W_all.transpose() * P_));
  KP_size_ = own.asDiagonal() * P_sizes + sizes * (spring_.cwiseAbs().asDiagonal() * (sizes.transpose() * P_sizes));
}

Eigen::MatrixXd RegimeBuilder::left_damping() const {
  Eigen::MatrixXd C = Z_.transpose() * modal_.damping * Z_;
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (const double own = answers_[static_cast<std::size_t>(c)].damping; own != 0.0)
      C += own * moved_.col(c) * moved_.col(c).transpose();
  return C;
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
    root.row(n_ + static_cast<Eigen::Index>(k)) = std::sqrt(spring_(sprung[k])) * moved_.col(sprung[k]).transpose();
  const Eigen::MatrixXd size = root.cwiseAbs();
  auto [omega, shapes] = spectrum_by_parts(coupled_parts(size.transpose() * size), [&](const Part& part) -> Spectrum {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(root(Eigen::all, part), Eigen::ComputeThinV);
    return {svd.singularValues().reverse(), svd.matrixV().rowwise().reverse()};
  });
  fem::Modes modes{std::move(omega), std::move(shapes)};
  // What holding contacts leaves may be a rigid-body motion alone: its rounding is a share of the whole structure's.
  const double slowest = std::max(kRigid * modes.omega.maxCoeff(), kRounding * modal_.omega.maxCoeff());
  for (double& w : modes.omega)
    if (w <= slowest) w = 0.0;
  return modes;
}

std::optional<PairForm> RegimeBuilder::supported_pairs() const {
  const Eigen::VectorXd damping = modal_.damping.diagonal();
  if (!held_.empty() || modal_.damping != Eigen::MatrixXd(damping.asDiagonal())) return std::nullopt;
  // Damping by the masses alone stays diagonal in the sprung structure's own modes.
  if (damper_.isZero(0.0) && damping.isConstant(damping(0), 0.0)) return std::nullopt;
  std::vector<Support> supports;
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (spring_(c) != 0.0 || damper_(c) != 0.0) supports.push_back({modal_.directions.col(c), spring_(c), damper_(c)});
  return sprung_pairs(modal_.omega, damping, supports);
}

void RegimeBuilder::set_pairs(Regime& out, const PairForm& form, const Eigen::VectorXd& scale,
                              const Eigen::MatrixXd* shapes) {
  const Eigen::Index m = scale.size(), np = out.pairs.np;
  check_pair_form(form, scale);
  set_blocks(out.pairs, form);
  const auto in_eta = [shapes](Eigen::MatrixXd columns) {
    return shapes ? Eigen::MatrixXd(*shapes * columns) : std::move(columns);
  };
  const auto of_eta = [shapes](Eigen::MatrixXd rows) {
    return shapes ? Eigen::MatrixXd(rows * shapes->transpose()) : std::move(rows);
  };
  at_.to_y = spread_columns(in_eta(scale.cwiseInverse().asDiagonal() * form.T.topRows(m)), np);
  at_.to_rate = spread_columns(in_eta(form.T.bottomRows(m)), np);
  at_.from_y = spread(of_eta(form.T_inverse.leftCols(m) * scale.asDiagonal()), np);
  at_.from_rate = spread(of_eta(form.T_inverse.rightCols(m)), np);
}

void RegimeBuilder::make_symmetric_pairs(Regime& out) {
  const Eigen::Index m = Z_.cols();
  if (const std::optional<PairForm> form = supported_pairs()) return set_pairs(out, *form, modal_.omega, nullptr);
  auto [omega, shapes] = base_modes();
  ModalModel& pairs = out.pairs;
  Eigen::MatrixXd D = shapes.transpose() * left_damping() * shapes;
  if ((D - D.transpose()).norm() <= kRounding * D.norm()) D = (D + D.transpose()).eval() / 2.0;
  separate_rigid_modes(omega, shapes, D, C_.norm());
  const Eigen::VectorXd diagonal = D.diagonal();
  const bool kept = rayleigh_ && spring_.isZero(0.0) && damper_.isZero(0.0);
  const Eigen::MatrixXd no_rate = Eigen::MatrixXd::Zero(m, m);
  if (kept || (D - Eigen::MatrixXd(diagonal.asDiagonal())).norm() <= kRounding * D.norm()) {
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
  set_pairs(out, pair_form(balanced.A), balanced.scale, &shapes);
}

void RegimeBuilder::make_general_pairs(Regime& out) {
  // First states: scaled displacements of the modes without what is not symmetric or not positive, then scaled ζ;
  // second states: their rates. First ζ that act back, by a friction that follows the load; the others are driven. All
  // in units of mass-normalised modes: neither A nor what its decomposition rounds by depends on the user's.
  const auto m = Z_.cols();
  fem::Modes base = base_modes();
  Eigen::MatrixXd& shapes = base.shapes;
  std::vector<Eigen::Index> order, driven;  // in oscillators_
  for (std::size_t j = 0; j < oscillators_.size(); ++j)
    (friction_(oscillators_[j]) != 0.0 ? order : driven).push_back(static_cast<Eigen::Index>(j));
  const auto acting = static_cast<Eigen::Index>(order.size()), N = m + acting;
  order.insert(order.end(), driven.begin(), driven.end());
  const auto k = static_cast<Eigen::Index>(order.size());
  const auto contact = [&](Eigen::Index j) {
    return oscillators_[static_cast<std::size_t>(order[static_cast<std::size_t>(j)])];
  };
  Eigen::VectorXd inertia(k);  // √m: ζ in m takes this to units of η
  for (Eigen::Index j = 0; j < k; ++j) inertia(j) = std::sqrt(load(contact(j)).mass);
  Eigen::VectorXd omega(N);
  omega.head(m) = base.omega;
  for (Eigen::Index j = 0; j < acting; ++j) omega(m + j) = std::sqrt(load(contact(j)).stiffness);
  Eigen::MatrixXd own_damping = shapes.transpose() * left_damping() * shapes;
  const auto direction = [&](Eigen::Index c) -> Eigen::VectorXd { return shapes.transpose() * moved_.col(c); };
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(m, nc_);  // of the contacts that add what is not in the base modes
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (spring_(c) < 0.0 || (load(c).oscillates() && friction_(c) != 0.0)) W.col(c) = direction(c);
  separate_rigid_modes(base.omega, shapes, own_damping, C_.norm(), &W);
  Eigen::MatrixXd damping = Eigen::MatrixXd::Zero(N, N);
  damping.topLeftCorner(m, m) = own_damping;
  Eigen::VectorXd coupling = Eigen::VectorXd::Zero(N);  // squared
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const Eigen::VectorXd w = W.col(c).cwiseAbs();
    if (spring_(c) < 0.0) coupling.head(m) = coupling.head(m).cwiseMax(-spring_(c) * w.norm() * w);
    if (load(c).oscillates())
      coupling.head(m) =
          coupling.head(m).cwiseMax(std::abs(load(c).lift) * std::sqrt(load(c).mass) * direction(c).cwiseAbs());
  }
  double beside = 0.0;
  for (Eigen::Index j = acting; j < k; ++j) beside = std::max(beside, std::sqrt(load(contact(j)).stiffness));
  BalancedState state = N > 0 ? balanced_state(omega, damping, coupling.cwiseSqrt(), beside) : BalancedState{};
  Eigen::MatrixXd& A = state.A;
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (spring_(c) < 0.0)
      A.block(N, 0, m, m) -= spring_(c) * W.col(c) * W.col(c).cwiseQuotient(state.scale.head(m)).transpose();
  for (Eigen::Index j = 0; j < acting; ++j) {
    const Eigen::Index c = contact(j);
    const friction::LoadForm& own = load(c);
    const auto w = W.col(c);
    A(N + m + j, N + m + j) = -own.damping;
    A.block(N + m + j, 0, 1, m) += inertia(j) * own.lift * w.cwiseQuotient(state.scale.head(m)).transpose();
    A.block(N + m + j, N, 1, m) += inertia(j) * own.lift_rate * w.transpose();
    A.block(N, m + j, m, 1) += friction_(c) * own.z / (inertia(j) * state.scale(m + j)) * w;
    A.block(N, N + m + j, m, 1) += friction_(c) * own.z_rate / inertia(j) * w;
  }
  PairForm form = N > 0 ? pair_form(A) : PairForm{};
  for (Eigen::Index j = acting; j < k; ++j) {
    const friction::LoadForm& own = load(contact(j));
    const Eigen::VectorXd w = direction(contact(j));
    const double scale = std::sqrt(own.stiffness);
    const Eigen::Index before = form.g11.size();
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(2, 2 * before);
    B.block(1, 0, 1, m) = inertia(j) * own.lift * w.cwiseQuotient(state.scale.head(m)).transpose();
    B.block(1, before, 1, m) = inertia(j) * own.lift_rate * w.transpose();
    add_driven_pair(form, Eigen::Matrix2d{{0.0, scale}, {-scale, -own.damping}}, B);
    state.scale.conservativeResize(before + 1);
    state.scale(before) = scale;
  }
  check_pair_form(form, state.scale);
  ModalModel& pairs = out.pairs;
  set_blocks(pairs, form);
  const Eigen::VectorXd inverse_scale = state.scale.cwiseInverse();
  const Eigen::MatrixXd first = inverse_scale.asDiagonal() * form.T.topRows(m + k), second = form.T.bottomRows(m + k);
  const Eigen::MatrixXd from_first = form.T_inverse.leftCols(m + k) * state.scale.asDiagonal();
  const Eigen::MatrixXd from_second = form.T_inverse.rightCols(m + k);
  at_.to_y = spread_columns(shapes * first.topRows(m), pairs.np);
  at_.to_rate = spread_columns(shapes * second.topRows(m), pairs.np);
  at_.from_y = spread(from_first.leftCols(m) * shapes.transpose(), pairs.np);
  at_.from_rate = spread(from_second.leftCols(m) * shapes.transpose(), pairs.np);
  const Eigen::MatrixXd zeta = spread_columns(first.bottomRows(k), pairs.np),
                        zeta_rate = spread_columns(second.bottomRows(k), pairs.np);
  const Eigen::MatrixXd from_zeta = spread(from_first.rightCols(k), pairs.np),
                        from_zeta_rate = spread(from_second.rightCols(k), pairs.np);
  for (Eigen::Index j = 0; j < k; ++j) {
    const Eigen::Index own = order[static_cast<std::size_t>(j)];
    at_.to_zeta.row(own) = zeta.row(j) / inertia(j);
    at_.to_zeta_rate.row(own) = zeta_rate.row(j) / inertia(j);
    at_.from_zeta.col(own) = inertia(j) * from_zeta.col(j);
    at_.from_zeta_rate.col(own) = inertia(j) * from_zeta_rate.col(j);
  }
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
  to_modes_.resize(2 * n_, 2 * pairs.np);
  to_modes_ << Z_ * at_.to_y, Z_ * at_.to_rate;
  pairs.measure_rates();
  if ((!pairs.proportional || !damper_.isZero(0.0)) && !bare_ && pairs.n > 0)
    pairs.dissipation_root = square_root(modal_.damping) * to_modes_.bottomRows(n_);
}

void RegimeBuilder::fill(Regime& out) {
  out.roles = roles_;
  out.forces = nk_;
  for (const ContactRole r : roles_) out.follows.push_back(r == ContactRole::kHeld || r == ContactRole::kSprung);
  out.answers = answers_;
  make_pairs(out);
  make_changes(out);
  make_inputs(out);
  make_contact_rows(out);
  refine_stick_rows(out);
  refine_spring_inputs(out);
  out.B_follows = Eigen::VectorXd::Zero(out.B.rows());
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (out.follows[static_cast<std::size_t>(c)]) out.B_follows += out.B.col(c);
  out.forcing.resize(out.B.rows(), out.B.cols() + 1);
  out.forcing << out.B, out.B_follows;
  make_outputs(out);
}

}  // namespace slipmode::dynamics
