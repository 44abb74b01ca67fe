#include "dynamics/regime.hpp"

#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Natural frequencies below this share of the fastest are rigid-body motion.
constexpr double kRigid = 1e-8;

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& A) { return (A + A.transpose()) / 2.0; }

/// Modal pairs of the structure with unit mass, C and K.
ModalModel constrained_pairs(const std::optional<fem::Rayleigh>& rayleigh, const Eigen::MatrixXd& C,
                             const Eigen::MatrixXd& K) {
  const auto m = K.rows();
  if (m == 0) {
    ModalModel none;
    for (auto* matrix : {&none.to_q, &none.to_v, &none.from_q, &none.from_v}) matrix->resize(0, 0);
    return none;
  }
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(m, m);
  const fem::Structure structure =
      rayleigh ? fem::Structure(unit, *rayleigh, symmetric(K)) : fem::Structure(unit, symmetric(C), symmetric(K));
  ModalModel pairs = build_modal_model(HybridSystem(structure, {}, friction::Belt::constant(0.0)), false);
  if (pairs.proportional)
    for (Eigen::Index i = 0; i < pairs.n; ++i)
      if (pairs.omega(i) <= kRigid * pairs.fastest) pairs.omega(i) = pairs.g21(i) = 0.0;
  return pairs;
}

}  // namespace

Regime::Regime(const HybridSystem& system, const ModalModel& slipping, const std::vector<bool>& stuck_contacts)
    : stuck(stuck_contacts) {
  eliminate(system, slipping);
  rate = pairs.fastest > 0 ? pairs.fastest : slipping.fastest > 0 ? slipping.fastest : 1.0;

  row1 = row;
  coefficient1 = coefficient;
  const auto derive = [&](Eigen::MatrixXd& rows, Eigen::MatrixXd& coefficients) {
    for (Eigen::Index c = 0; c < rows.cols(); ++c) {
      Eigen::VectorXd r = rows.col(c), k = coefficients.col(c);
      differentiate(r, k);
      rows.col(c) = r;
      coefficients.col(c) = k;
    }
  };
  derive(row1, coefficient1);
  row2 = row1;
  coefficient2 = coefficient1;
  derive(row2, coefficient2);
  prepare_bounds();
}

void Regime::eliminate(const HybridSystem& system, const ModalModel& slipping) {
  const auto n = system.size();
  const auto nc = static_cast<Eigen::Index>(stuck.size());
  const Eigen::LLT<Eigen::MatrixXd> mass(fem::to_dense(system.structure().M()));
  const Eigen::MatrixXd L = mass.matrixL();
  const auto scaled = [&](const Eigen::MatrixXd& A) -> Eigen::MatrixXd {
    const Eigen::MatrixXd half = L.triangularView<Eigen::Lower>().solve(A);
    return symmetric(L.triangularView<Eigen::Lower>().solve(half.transpose()));
  };
  const Eigen::MatrixXd K = scaled(fem::to_dense(system.structure().K()));
  const Eigen::MatrixXd C = scaled(fem::to_dense(system.structure().C()));
  Eigen::MatrixXd W(n, nc);
  for (Eigen::Index c = 0; c < nc; ++c) W.col(c) = system.contacts()[static_cast<std::size_t>(c)].direction;
  if (nc > 0) W = L.triangularView<Eigen::Lower>().solve(W);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(n);
  if (system.load().size() > 0) load = L.triangularView<Eigen::Lower>().solve(system.load());

  // ξ = Lᵀq = Z y + P u: Z orthonormal and orthogonal to the stuck directions, P their pseudo-inverse.
  std::vector<Eigen::Index> held;
  for (Eigen::Index c = 0; c < nc; ++c)
    if (stuck[static_cast<std::size_t>(c)]) held.push_back(c);
  const auto s = static_cast<Eigen::Index>(held.size()), m = n - s;
  const Eigen::MatrixXd W_held = W(Eigen::all, held);
  Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(n, n), P_held(n, s);
  if (s > 0) {
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(W_held).householderQ();
    Z = Q.rightCols(m).eval();
    P_held = W_held * (W_held.transpose() * W_held).inverse();
  }
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(n, nc);
  for (Eigen::Index k = 0; k < s; ++k) P.col(held[static_cast<std::size_t>(k)]) = P_held.col(k);
  const Eigen::VectorXd P_all = P.rowwise().sum();

  const Eigen::MatrixXd KZ = K * Z, CZ = C * Z;
  pairs = constrained_pairs(system.structure().rayleigh(), Z.transpose() * CZ, Z.transpose() * KZ);
  const auto np = pairs.np, V = speed_input(), a = V + 1, one = V + 2;
  const Eigen::MatrixXd to_y = Z * pairs.to_q, to_rate = Z * pairs.to_v, force = pairs.from_v * Z.transpose();

  B = Eigen::MatrixXd::Zero(2 * np, inputs());
  B_stuck = Eigen::VectorXd::Zero(2 * np);
  row = Eigen::MatrixXd::Zero(2 * np, nc);
  coefficient = Eigen::MatrixXd::Zero(inputs(), nc);
  for (Eigen::Index c = 0; c < nc; ++c) {
    if (stuck[static_cast<std::size_t>(c)]) {
      B.col(c) = -force * (K * P.col(c));
      B_stuck += B.col(c);
      row.col(c) = (P.col(c).transpose() * (K * to_y + C * to_rate)).transpose();
      for (Eigen::Index d = 0; d < nc; ++d)
        coefficient(d, c) = stuck[static_cast<std::size_t>(d)] ? P.col(c).dot(K * P.col(d)) : -P.col(c).dot(W.col(d));
      coefficient(V, c) = P.col(c).dot(C * P_all);
      coefficient(a, c) = P.col(c).dot(P_all);
      coefficient(one, c) = -P.col(c).dot(load);
    } else {
      B.col(c) = force * W.col(c);
      row.col(c) = (W.col(c).transpose() * to_rate).transpose();
      coefficient(V, c) = W.col(c).dot(P_all);
    }
  }
  B.col(V) = -force * (C * P_all);
  B.col(one) = force * load;
  viscous_cross = (P_all.transpose() * C * to_rate).transpose();
  viscous_belt = P_all.dot(C * P_all);

  const Eigen::MatrixXd Lt = L.transpose();
  from_slipping =
      pairs.from_q * (Z.transpose() * (Lt * slipping.to_q)) + pairs.from_v * (Z.transpose() * (Lt * slipping.to_v));
  const Eigen::MatrixXd back = mass.matrixU().solve(Eigen::MatrixXd::Identity(n, n));  // L⁻ᵀ
  to_slipping = slipping.from_q * (back * to_y) + slipping.from_v * (back * to_rate);
  inputs_slipping = Eigen::MatrixXd::Zero(2 * slipping.np, inputs());
  for (const Eigen::Index c : held) inputs_slipping.col(c) = slipping.from_q * (back * P.col(c));
  inputs_slipping.col(V) = slipping.from_v * (back * P_all);
}

void Regime::prepare_bounds() {
  const auto np = pairs.np, nc = row.cols(), V = speed_input(), a = V + 1;
  scale1 = scale2 = pair_rate = Eigen::VectorXd::Zero(np);
  particular = Eigen::MatrixXd::Zero(2 * np, inputs());
  Eigen::MatrixXd polynomial_row = row;  // of components without scale
  weight = Eigen::MatrixXd::Zero(np, nc);
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    Eigen::Matrix2d G;
    G << pairs.g11(i), pairs.g12(i), pairs.g21(i), pairs.g22(i);
    if (pairs.proportional) {
      scale1(i) = pairs.omega(i);
      scale2(i) = pairs.omega(i) > 0 || pairs.damping(i) > 0 ? 1.0 : 0.0;
      pair_rate(i) = pairs.damping(i) / 2.0 + std::hypot(pairs.omega(i), pairs.damping(i) / 2.0);
    } else {
      const bool oscillates = pairs.g12(i) != 0.0;
      scale1(i) = oscillates || pairs.g11(i) != 0.0 ? 1.0 : 0.0;
      scale2(i) = oscillates || pairs.g22(i) != 0.0 ? 1.0 : 0.0;
      pair_rate(i) = oscillates ? std::hypot(pairs.g11(i), pairs.g12(i))
                                : std::max(std::abs(pairs.g11(i)), std::abs(pairs.g22(i)));
    }
    // x_p = −G⁻¹ f − G⁻² ḟ − G⁻³ f̈ with f = B ι, ḟ = B_stuck V + B_V a, f̈ = B_stuck a.
    Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
    if (scale1(i) > 0 && scale2(i) > 0)
      inverse = G.inverse();
    else if (scale2(i) > 0)
      inverse(1, 1) = 1.0 / G(1, 1);
    else if (scale1(i) > 0)
      inverse(0, 0) = 1.0 / G(0, 0);
    const auto pair_of = [&](const auto& column) { return Eigen::Vector2d(column(i), column(np + i)); };
    const auto put = [&](Eigen::Index k, const Eigen::Vector2d& value) {
      particular(i, k) += value(0);
      particular(np + i, k) += value(1);
    };
    for (Eigen::Index k = 0; k < inputs(); ++k) put(k, -inverse * pair_of(B.col(k)));
    const Eigen::Vector2d held = pair_of(B_stuck);
    put(V, -inverse * inverse * held);
    put(a, -inverse * inverse * pair_of(B.col(V)) - inverse * inverse * inverse * held);
    for (Eigen::Index c = 0; c < nc; ++c) {
      weight(i, c) =
          std::hypot(scale1(i) > 0 ? row(i, c) / scale1(i) : 0.0, scale2(i) > 0 ? row(np + i, c) / scale2(i) : 0.0);
      if (scale1(i) > 0) polynomial_row(i, c) = 0.0;
      if (scale2(i) > 0) polynomial_row(np + i, c) = 0.0;
    }
  }
  weight2 = pair_rate.cwiseAbs2().asDiagonal() * weight;
  weight3 = pair_rate.asDiagonal() * weight2;
  polynomial2 = polynomial3 = Eigen::MatrixXd::Zero(inputs(), nc);
  for (Eigen::Index c = 0; c < nc; ++c) {
    // What follows the inputs at once, and the components that merely integrate them.
    Eigen::VectorXd r = polynomial_row.col(c);
    Eigen::VectorXd k = coefficient.col(c) + particular.transpose() * (row.col(c) - r);
    differentiate(r, k);
    differentiate(r, k);
    polynomial2.col(c) = k;
    differentiate(r, k);
    polynomial3.col(c) = k;
  }
}

void Regime::advance_inputs(Eigen::VectorXd& inputs, double t) const {
  const Eigen::Index V = speed_input();
  const double way = t * (inputs(V) + 0.5 * t * inputs(V + 1));
  for (std::size_t c = 0; c < stuck.size(); ++c)
    if (stuck[c]) inputs(static_cast<Eigen::Index>(c)) += way;
  inputs(V) += t * inputs(V + 1);
}

double Regime::output(int c, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) const {
  return dot_padded(row.col(c).data(), x.data(), x.size()) + coefficient.col(c).dot(inputs);
}

void Regime::differentiate(Eigen::VectorXd& r, Eigen::VectorXd& k) const {
  const auto np = pairs.np;
  const Eigen::Index V = speed_input();
  Eigen::VectorXd next = B.transpose() * r;
  for (std::size_t c = 0; c < stuck.size(); ++c)
    if (stuck[c]) next(V) += k(static_cast<Eigen::Index>(c));
  next(V + 1) += k(V);
  k = next;
  Eigen::VectorXd out(2 * np);
  out.head(np) = pairs.g11.cwiseProduct(r.head(np)) + pairs.g21.cwiseProduct(r.tail(np));
  out.tail(np) = pairs.g12.cwiseProduct(r.head(np)) + pairs.g22.cwiseProduct(r.tail(np));
  r = out;
}

double Regime::viscous_power(const Eigen::VectorXd& x, double belt_velocity) const {
  const double own = pairs.n > 0 ? pairs.viscous_power(x) : 0.0;
  return own + belt_velocity * (2.0 * viscous_cross.dot(x) + belt_velocity * viscous_belt);
}

}  // namespace slipmode::dynamics
