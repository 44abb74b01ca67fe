#include "dynamics/collocation_flow.hpp"

namespace slipmode::dynamics {

void CollocationFlow::account(int level, double tau) {
  const double h = tables_.step(level);
  const kernels::Work done = tau < h ? within_.work(tau) : tables_.work(level, x_begin_.data(), forces_.data());
  work_.add(done.contact, driven_work(h, tau), done.loss);
}

double CollocationFlow::driven_work(double h, double tau) const {
  double driven = 0.0;
  if (tau >= h) {  // Radau's rule is exact to degree 14
    for (int c = 0; c < nc_; ++c)
      driven +=
          h *
          nodes_.weight.cwiseProduct(forces_.segment<kNodes>(kNodes * c)).dot(drive_nodes_.segment<kNodes>(kNodes * c));
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
