#include <slipmode/dynamics/step_tables.hpp>

#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Values at the points of a Gauss rule on [0, 1] → ∫₀ to each point of the polynomial through them.
Eigen::MatrixXd running_integrals(const GaussRule& rule) {
  const auto count = rule.node.size();
  Eigen::MatrixXd P(count, count + 1);  // Legendre polynomials at 2t − 1
  for (Eigen::Index k = 0; k < count; ++k) {
    const double z = 2.0 * rule.node(k) - 1.0;
    P(k, 0) = 1.0;
    P(k, 1) = z;
    for (Eigen::Index l = 2; l <= count; ++l)
      P(k, l) = (static_cast<double>(2 * l - 1) * z * P(k, l - 1) - static_cast<double>(l - 1) * P(k, l - 2)) /
                static_cast<double>(l);
  }
  // ∫₀ᵗ P_l(2s − 1) ds = (P_{l+1} − P_{l−1})(2t − 1) / (2 (2l + 1)).
  Eigen::MatrixXd antiderivatives(count, count);
  antiderivatives.col(0) = rule.node;
  for (Eigen::Index l = 1; l < count; ++l)
    antiderivatives.col(l) = (P.col(l + 1) - P.col(l - 1)) / static_cast<double>(2 * (2 * l + 1));
  Eigen::MatrixXd to_legendre = P.leftCols(count).transpose() * rule.weight.asDiagonal();
  for (Eigen::Index l = 0; l < count; ++l) to_legendre.row(l) *= static_cast<double>(2 * l + 1);
  return antiderivatives * to_legendre;
}

}  // namespace

void StepTables::make(LossForm& out, int level) const {
  // Everything at the points of one rule: e^{Gt}, and the motion that each force polynomial (and the load) causes,
  // e^{Gt} ∫₀ᵗ e^{−Gs} b ℓ_j(s/h) ds.
  const ModalModel& m = model_;
  const auto np = m.np;
  const int nc = m.contacts;
  const double h = step(level);
  const GaussRule rule = gauss_rule(18 + static_cast<int>(std::ceil(m.fastest * h)));
  const auto points = rule.node.size();
  const Eigen::MatrixXd integrate = h * running_integrals(rule);
  const Eigen::VectorXd weight = h * rule.weight;
  const Eigen::Index columns = kNodes * nc, all = columns + (loaded_ ? 1 : 0);  // the last: the load's
  Eigen::MatrixXd basis(points, kNodes);
  for (Eigen::Index k = 0; k < points; ++k) basis.row(k) = radau().lagrange(rule.node(k)).transpose();

  out.by_force = Eigen::MatrixXd::Zero(kNodes, 2 * np * nc);
  out.load = Eigen::MatrixXd::Zero(kNodes, nc);
  out.kernel = Eigen::MatrixXd::Zero(kNodes * kNodes, nc * nc);
  out.s11 = out.s12 = out.s22 = Eigen::VectorXd::Zero(np);
  out.linear = Eigen::VectorXd::Zero(2 * np);

  Eigen::MatrixXd losses = Eigen::MatrixXd::Zero(all, all);
  Eigen::MatrixXd forward(points, 4), back(points, 4), first(points, all), second(points, all), rate;
  for (Eigen::Index i = 0; i < m.n; ++i) {
    for (Eigen::Index k = 0; k < points; ++k) {
      const double t = h * rule.node(k);
      const Eigen::Matrix2d E = m.exponential(i, t), F = m.exponential(i, -t);
      forward.row(k) << E(0, 0), E(0, 1), E(1, 0), E(1, 1);
      back.row(k) << F(0, 0), F(0, 1), F(1, 0), F(1, 1);
    }
    const auto e21 = forward.col(2), e22 = forward.col(3);
    for (int c = 0; c <= nc; ++c) {
      if (c == nc && !loaded_) break;
      const double b1 = c < nc ? m.input(i, c) : m.load(i), b2 = c < nc ? m.input(np + i, c) : m.load(np + i);
      const Eigen::VectorXd u1 = back.col(0) * b1 + back.col(1) * b2, u2 = back.col(2) * b1 + back.col(3) * b2;
      if (c == nc) {
        first.col(columns) = u1;
        second.col(columns) = u2;
      } else {
        first.middleCols(kNodes * c, kNodes) = u1.asDiagonal() * basis;
        second.middleCols(kNodes * c, kNodes) = u2.asDiagonal() * basis;
      }
    }
    rate = e21.asDiagonal() * (integrate * first) + e22.asDiagonal() * (integrate * second);
    const Eigen::VectorXd damped = m.damping(i) * weight, on1 = damped.cwiseProduct(e21),
                          on2 = damped.cwiseProduct(e22);
    out.s11(i) = on1.dot(e21);
    out.s12(i) = 2.0 * on1.dot(e22);
    out.s22(i) = on2.dot(e22);
    for (int c = 0; c < nc; ++c) {
      const auto caused = rate.middleCols(kNodes * c, kNodes);
      out.by_force.col(2 * np * c + i) = 2.0 * caused.transpose() * on1;
      out.by_force.col(2 * np * c + np + i) = 2.0 * caused.transpose() * on2;
    }
    if (loaded_) {
      out.linear(i) = 2.0 * on1.dot(rate.col(columns));
      out.linear(np + i) = 2.0 * on2.dot(rate.col(columns));
    }
    losses.noalias() += rate.transpose() * damped.asDiagonal() * rate;
  }
  for (int c = 0; c < nc; ++c) {
    for (int d = 0; d < nc; ++d)
      Eigen::Map<RadauTables::Matrix8>(out.kernel.col(nc * c + d).data()) =
          losses.block(kNodes * c, kNodes * d, kNodes, kNodes);
    if (loaded_) out.load.col(c) = 2.0 * losses.block(kNodes * c, columns, kNodes, 1);
  }
  if (loaded_) out.constant = losses(columns, columns);
}

kernels::Work StepTables::work(int level, const double* x, const double* forces, const double* velocities) const {
  const kernels::Kernels& k = kernels::kernels();
  const double h = step(level);
  kernels::Work sum;
  for (int c = 0; c < model_.contacts; ++c) {
    const double start = k.dot(model_.velocity_row.col(c).data(), x, 2 * model_.np);
    sum.contact += h * k.product_integral(radau().product, forces + kNodes * c, velocities + kNodes * c, start);
  }
  if (model_.proportional) {
    const LossForm& form = losses_.get(level, [&](LossForm& out) { make(out, level); });
    sum.loss = k.loss(form.arrays(model_.n, loaded_), x, forces);
    return sum;
  }
  const NodeStates& nodes = node_states_.get(level, [&](NodeStates& out) { make(out, level); });
  Eigen::VectorXd state(2 * model_.np);
  for (std::size_t j = 0; j < nodes.node.size(); ++j) {
    k.propagate(nodes.node[j].arrays(loaded_), x, forces, state.data());
    sum.loss += h * nodes.rule.weight(static_cast<Eigen::Index>(j)) * model_.viscous_power(state);
  }
  return sum;
}

}  // namespace slipmode::dynamics
