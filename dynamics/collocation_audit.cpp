#include "dynamics/collocation_flow.hpp"
#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace slipmode::dynamics {

void CollocationFlow::account(int level, double tau) {
  if (tau >= tables_.step(level))
    return account_whole(level, x_begin_.data(), forces_.data(), velocity_.data(), begin_);
  double t = begin_;
  Eigen::VectorXd x = x_begin_, next(x.size()), velocity(kNodes * nc_);
  walk_pieces(
      tables_, forces_.data(), level, tau,
      [&](int piece, const double* forces) {
        const Collocation& table = tables_.collocation(piece);
        velocity.noalias() = table.kernel * Eigen::Map<const Eigen::VectorXd>(forces, kNodes * nc_);
        for (int c = 0; c < nc_; ++c)
          velocity.segment<kNodes>(kNodes * c) +=
              table.free.middleCols(2 * model_.np * c, 2 * model_.np) * x + table.load.col(c);
        account_whole(piece, x.data(), forces, velocity.data(), t);
        propagate(tables_.propagator(piece), x.data(), forces, nc_, model_.np, next.data());
        x.swap(next);
        t += tables_.step(piece);
      },
      [&](int piece, const double* forces, double rest) { account_rest(piece, x.data(), forces, t, rest); });
}

void CollocationFlow::account_whole(int level, const double* x, const double* forces, const double* velocities,
                                    double begin) {
  const double length = tables_.step(level);
  const RadauTables::Vector8 drive_speed = drive_velocities(begin, length);
  double contact = 0.0, driven = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const Eigen::Map<const RadauTables::Vector8> force(forces + kNodes * c), speed(velocities + kNodes * c);
    const RadauTables::Vector8 weighted = length * nodes_.weight.cwiseProduct(force);
    contact += weighted.dot(speed);
    driven += weighted.dot(drive_speed);
  }
  work_.add(contact, driven, viscous_loss(tables_, level, x, forces));
}

void CollocationFlow::account_rest(int level, const double* x, const double* forces, double begin, double rest) {
  // Five points suffice for what a Taylor series covers.
  static const GaussRule rule = gauss_rule(5);
  Eigen::VectorXd at(x_begin_.size());
  double contact = 0.0, driven = 0.0, viscous = 0.0;
  for (Eigen::Index k = 0; k < rule.node.size(); ++k) {
    const double tau = rule.node(k) * rest, weight = rule.weight(k) * rest, t = begin + tau;
    advance_within(tables_, x, forces, level, tau, at.data());
    const RadauTables::Vector8 basis = nodes_.lagrange(tau / tables_.step(level));
    for (int c = 0; c < nc_; ++c) {
      const double force = Eigen::Map<const RadauTables::Vector8>(forces + kNodes * c).dot(basis);
      contact += weight * force * resolver_.contact_velocity(c, at.data());
      driven += weight * force * drive().velocity(t);
    }
    viscous += weight * model_.viscous_power(at);
  }
  work_.add(contact, driven, viscous);
}

}  // namespace slipmode::dynamics
