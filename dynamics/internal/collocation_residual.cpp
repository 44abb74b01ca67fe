// What the polynomials leave of laws between the nodes. Legendre coefficients that fall foretell the error of a smooth
// force alone: of one that changes between two nodes, or whose curvature jumps, they say nothing.
#include "dynamics/internal/collocation_flow.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// What collocation leaves out of a rate changes sign between the nodes: of it stays this share, where it is resolved.
constexpr double kOscillates = 1.0 / 16.0;
/// Before a reversal a bristle is looked at from this multiple of the Stribeck speed on.
constexpr double kStribeckSpeeds = 1.5;

}  // namespace

/// Polynomials through the nodes at other shares of the step: of degree 7, and of degree 8 through the start too.
struct CollocationFlow::Between {
  Eigen::Matrix<double, Eigen::Dynamic, kNodes> seventh, eighth;
  Eigen::VectorXd begin;  ///< share of the start's value in the latter

  explicit Between(const Eigen::VectorXd& shares) : seventh(shares.size(), kNodes) {
    for (Eigen::Index k = 0; k < shares.size(); ++k) seventh.row(k) = radau().lagrange(shares(k));
    eighth = shares.asDiagonal() * seventh * radau().node.cwiseInverse().asDiagonal();
    begin = 1.0 - eighth.rowwise().sum().array();
  }
};

double CollocationFlow::bristle_error(int c, const Between& at) const {
  const auto i = static_cast<std::size_t>(c);
  const friction::BristleForces& law = laws()[i].bristle;
  const double sign = sign_of(point_.modes[i]), h = tables_.step(step_level_);
  const RadauTables::Vector8 s =
      sign * (drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c));
  const RadauTables::Vector8 z = sign * bristle_nodes_.segment<kNodes>(kNodes * c);
  const RadauTables::Vector8 force = sign * forces_.segment<kNodes>(kNodes * c);
  const double s_begin = sign * (drive_velocity(begin_, 0.0) - resolver_.contact_velocity(c, x_begin_.data())),
               z_begin = sign * internal_begin_(own_at_[i]);
  RadauTables::Vector8 rate;
  for (int j = 0; j < kNodes; ++j) rate(j) = law.rate(1.0, s(j), z(j));
  double worst = 0.0;
  for (Eigen::Index k = 0; k < at.begin.size(); ++k) {
    const double speed = at.eighth.row(k).dot(s) + at.begin(k) * s_begin;
    const double bristle = at.eighth.row(k).dot(z) + at.begin(k) * z_begin;
    const double decay = law.decay(1.0, speed).value, exact = speed - decay * bristle;
    const double off_rate = at.seventh.row(k).dot(rate) - exact;
    const double off_force =
        at.seventh.row(k).dot(force) - (law.stiffness * bristle + law.damping * exact + law.viscous * speed);
    const double lasts = std::min(h, 1.0 / std::max(decay, 1.0 / h));
    worst = std::max(
        {worst, kOscillates * law.stiffness * std::abs(off_rate) * lasts, 0.5 * std::abs(off_force) * h / acting_});
  }
  return worst * over_limit_[i];
}

const CollocationFlow::Between& CollocationFlow::halfway() {
  static const Between at([] {
    const RadauTables::Vector8& node = radau().node;
    Eigen::VectorXd shares = Eigen::VectorXd::Zero(kNodes);
    shares.tail(kNodes - 1) = 0.5 * (node.head<kNodes - 1>() + node.tail<kNodes - 1>());
    return shares;
  }());
  return at;
}

double CollocationFlow::characteristic_error(int c) const {
  const auto i = static_cast<std::size_t>(c);
  const double sign = sign_of(point_.modes[i]);
  const auto slip = drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c);
  const auto between = halfway().seventh.topRows<kNodes>();
  const RadauTables::Vector8 speed = between * slip, force = between * forces_.segment<kNodes>(kNodes * c);
  double worst = 0.0;
  for (Eigen::Index k = 0; k < speed.size(); ++k) {
    if (laws()[i].sticks() && sign * speed(k) <= 0.0) continue;  // beyond the event that ends the step
    worst = std::max(worst, std::abs(force(k) - laws()[i].sliding(sign, speed(k))));
  }
  return 0.5 * worst * over_scale(c);
}

double CollocationFlow::reversal_error(const Guarded& guard) const {
  // A stiff bristle follows g(s), which changes within the Stribeck speed: no node need be there.
  const auto i = static_cast<std::size_t>(guard.contact);
  const double slope = nodes_.lagrange_slope(guard.theta)
                           .dot(drive_nodes_.segment<kNodes>(kNodes * guard.contact) -
                                velocity_.segment<kNodes>(kNodes * guard.contact));
  const double fall = std::min(guard.theta / kStribeckSpeeds, laws()[i].bristle.stribeck_speed / std::abs(slope));
  return bristle_error(guard.contact,
                       Between(Eigen::VectorXd::LinSpaced(4, guard.theta - kStribeckSpeeds * fall, guard.theta)));
}

}  // namespace slipmode::dynamics
