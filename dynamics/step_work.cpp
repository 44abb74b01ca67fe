#include <slipmode/dynamics/step_tables.hpp>

#include <cmath>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// Values at the points of a Gauss rule on [0, 1] → ∫₀ to each of the ends of the polynomial through them.
Eigen::MatrixXd running_integrals(const GaussRule& rule, const Eigen::VectorXd& ends) {
  const auto count = rule.node.size();
  const auto legendre = [&](const Eigen::VectorXd& at) {  // polynomials of degree 0 … count at 2t − 1
    const Eigen::ArrayXd z = 2.0 * at.array() - 1.0;
    Eigen::ArrayXXd P(at.size(), count + 1);
    P.col(0).setOnes();
    P.col(1) = z;
    for (Eigen::Index l = 2; l <= count; ++l)
      P.col(l) = (static_cast<double>(2 * l - 1) * z * P.col(l - 1) - static_cast<double>(l - 1) * P.col(l - 2)) /
                 static_cast<double>(l);
    return P;
  };
  // ∫₀ᵗ P_l(2s − 1) ds = (P_{l+1} − P_{l−1})(2t − 1) / (2 (2l + 1)).
  const Eigen::ArrayXXd at_ends = legendre(ends);
  Eigen::MatrixXd antiderivatives(ends.size(), count);
  antiderivatives.col(0) = ends;
  for (Eigen::Index l = 1; l < count; ++l)
    antiderivatives.col(l) = (at_ends.col(l + 1) - at_ends.col(l - 1)) / static_cast<double>(2 * (2 * l + 1));
  Eigen::MatrixXd to_legendre = legendre(rule.node).leftCols(count).matrix().transpose() * rule.weight.asDiagonal();
  for (Eigen::Index l = 0; l < count; ++l) to_legendre.row(l) *= static_cast<double>(2 * l + 1);
  return antiderivatives * to_legendre;
}

}  // namespace

void StepTables::make(LossForm& out, int level) const {
  // ∫ damping η̇² dt by one rule. At each of its points the velocities that each force polynomial (and the load) causes,
  // those of e^{Gt} ∫₀ᵗ e^{−Gs} b ℓ_j(s/h) ds, from the points of another.
  const ModalModel& m = acted_on_;
  const kernels::Kernels& vector = kernels::kernels();
  const auto np = m.np;
  const int nc = m.contacts, sources = nc + (loaded_ ? 1 : 0);  // the last: the load
  const double h = step(level), phase = m.fastest * h;
  const GaussRule outer = gauss_rule(12 + static_cast<int>(std::ceil(1.5 * phase)));
  const GaussRule inner = gauss_rule(18 + static_cast<int>(std::ceil(phase)));
  const auto points = inner.node.size();
  const Eigen::MatrixXd integrate = h * running_integrals(inner, outer.node);
  Eigen::MatrixXd basis(kNodes, points), constant = Eigen::MatrixXd::Zero(kNodes, points);
  for (Eigen::Index l = 0; l < points; ++l) basis.col(l) = radau().lagrange(inner.node(l));
  constant.row(0).setOnes();

  out.by_force = Eigen::MatrixXd::Zero(kNodes, 2 * np * nc);
  out.load = Eigen::MatrixXd::Zero(kNodes, nc);
  out.kernel = Eigen::MatrixXd::Zero(kNodes * kNodes, nc * nc);
  out.s11 = out.s12 = out.s22 = Eigen::VectorXd::Zero(np);
  out.linear = Eigen::VectorXd::Zero(2 * np);

  const Eigen::MatrixXd forward = exponentials(h * outer.node), back = exponentials(-h * inner.node);
  std::vector<Eigen::MatrixXd> first, second;  // e^{−Gs} b of each source
  for (int c = 0; c < sources; ++c) {
    const Eigen::VectorXd b = c < nc ? m.input.col(c) : m.load;
    const auto b1 = b.head(np).asDiagonal(), b2 = b.tail(np).asDiagonal();
    first.emplace_back(b1 * back.topRows(np) + b2 * back.middleRows(np, np));
    second.emplace_back(b1 * back.middleRows(2 * np, np) + b2 * back.bottomRows(np));
  }
  std::vector<Eigen::MatrixXd> rate(first.size(), Eigen::MatrixXd(np, kNodes)), on1 = rate, on2 = rate;
  for (auto* sums : {&on1, &on2})
    for (Eigen::MatrixXd& sum : *sums) sum.setZero();
  Eigen::MatrixXd losses = Eigen::MatrixXd::Zero(kNodes * kNodes, sources * sources);
  for (Eigen::Index k = 0; k < outer.node.size(); ++k) {
    const auto e21 = forward.col(k).segment(2 * np, np), e22 = forward.col(k).tail(np);
    const Eigen::VectorXd damped = h * outer.weight(k) * m.damping, d1 = damped.cwiseProduct(e21),
                          d2 = damped.cwiseProduct(e22);
    out.s11 += d1.cwiseProduct(e21);
    out.s12 += 2.0 * d1.cwiseProduct(e22);
    out.s22 += d2.cwiseProduct(e22);
    for (int c = 0; c < sources; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const Eigen::MatrixXd weights = (c < nc ? basis : constant) * integrate.row(k).asDiagonal();
      vector.caused(np, points, e21.data(), e22.data(), first[i].data(), second[i].data(), weights.data(),
                    rate[i].data());
      on1[i] += (2.0 * d1).asDiagonal() * rate[i];
      on2[i] += (2.0 * d2).asDiagonal() * rate[i];
      for (int d = 0; d <= c; ++d)
        vector.weighted_products(np, rate[i].data(), rate[static_cast<std::size_t>(d)].data(), damped.data(),
                                 losses.col(sources * c + d).data());
    }
  }
  const auto block = [&](int c, int d) { return Eigen::Map<RadauTables::Matrix8>(losses.col(sources * c + d).data()); };
  for (int c = 0; c < nc; ++c) {
    const auto i = static_cast<std::size_t>(c);
    out.by_force.middleCols(2 * np * c, np) = on1[i].transpose();
    out.by_force.middleCols(2 * np * c + np, np) = on2[i].transpose();
    for (int d = 0; d <= c; ++d) {
      Eigen::Map<RadauTables::Matrix8>(out.kernel.col(nc * c + d).data()) = block(c, d);
      Eigen::Map<RadauTables::Matrix8>(out.kernel.col(nc * d + c).data()) = block(c, d).transpose();
    }
    if (loaded_) out.load.col(c) = 2.0 * block(nc, c).row(0).transpose();
  }
  if (!loaded_) return;
  out.linear << on1.back().col(0), on2.back().col(0);
  out.constant = block(nc, nc)(0, 0);
}

kernels::Work StepTables::work(int level, const double* x, const double* forces, const double* velocities) const {
  const kernels::Kernels& k = kernels::kernels();
  const double h = step(level);
  kernels::Work sum;
  for (int c = 0; c < acted_on_.contacts; ++c) {
    const double start = k.dot(acted_on_.velocity_row.col(c).data(), x, 2 * model_.np);
    (c < model_.contacts ? sum.contact : sum.force) +=
        h * k.product_integral(radau().product, forces + kNodes * c, velocities + kNodes * c, start);
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
