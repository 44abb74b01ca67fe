#include "dynamics/internal/collocation_flow.hpp"

#include <array>

namespace slipmode::dynamics {

void CollocationFlow::account(int level, double tau) {
  const double h = tables_.step(level);
  const auto whole = [&] {
    if (given_ == 0) return tables_.work(level, x_begin_.data(), forces_.data(), velocity_.data());
    Eigen::VectorXd velocities(forces_.size());  // along the drive's forces too
    tables_.collocation(level).velocities(x_begin_.data(), forces_.data(), velocities.data());
    return tables_.work(level, x_begin_.data(), forces_.data(), velocities.data());
  };
  const kernels::Work done = tau < h ? within_.work(tau) : whole();
  work_.add(done.contact, driven_work(h, tau), done.loss, done.force);
}

double CollocationFlow::driven_work(double h, double tau) const {
  double driven = 0.0;
  if (tau >= h) {
    for (int c = 0; c < nc_; ++c)
      driven += h * kernels_.product_integral(nodes_.product, forces_.data() + kNodes * c,
                                              drive_nodes_.data() + kNodes * c, drive().velocity(begin_));
    return driven;
  }
  if (drive().shaker() == nullptr) {  // ∫ λ (V + a t) dt by the powers of t/h in λ
    const double V = drive().velocity(begin_), a = drive().acceleration(begin_), share = tau / h;
    alignas(64) std::array<double, kNodes> power;
    for (int c = 0; c < nc_; ++c) {
      kernels_.matrix8(nodes_.monomial.data(), forces_.data() + kNodes * c, power.data());
      double constant = 0.0, ramp = 0.0;
      for (int k = kNodes - 1; k >= 0; --k) {
        const double of = power[static_cast<std::size_t>(k)];
        constant = constant * share + of / (k + 1);
        ramp = ramp * share + of / (k + 2);
      }
      driven += tau * (constant * V + ramp * a * tau);
    }
    return driven;
  }
  static const GaussRule rule = gauss_rule(kNodes);
  for (Eigen::Index k = 0; k < rule.node.size(); ++k) {
    const RadauTables::Vector8 basis = nodes_.lagrange(rule.node(k) * tau / h);
    double force = 0.0;
    for (int c = 0; c < nc_; ++c) force += forces_.segment<kNodes>(kNodes * c).dot(basis);
    driven += rule.weight(k) * tau * force * drive_velocity(begin_, rule.node(k) * tau);
  }
  return driven;
}

}  // namespace slipmode::dynamics
