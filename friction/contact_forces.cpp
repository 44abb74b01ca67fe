#include <slipmode/friction/contact_forces.hpp>

#include <slipmode/friction/characteristic.hpp>

#include <algorithm>
#include <cmath>

namespace slipmode::friction {

ContactForces ContactForces::under(double normal_load) const {
  ContactForces now = *this;
  now.load = normal_load;
  now.static_limit = std::max(now.limit(-1.0), now.limit(1.0));
  now.kinetic = now.mu_k[1] * normal_load;
  return now;
}

double ContactForces::smooth(double v, double& slope) const {
  if (kind != LawKind::kSmooth) return slope = 0.0;
  const double th = std::tanh(v / epsilon), dth = (1 - th * th) / epsilon;
  const double magnitude = v * th, d_magnitude = th + v * dth;
  const double e = drop * std::exp(-alpha * magnitude);
  slope = (kinetic + e) * dth - alpha * d_magnitude * e * th;
  return (kinetic + e) * th;
}

double ContactForces::sliding(double direction, double v) const {
  double slope;
  if (!sticks()) return smooth(v, slope);
  if (kind != LawKind::kSpeedDependent) return direction * onset(direction);
  if (characteristic != nullptr) return direction * load * characteristic->mu(std::abs(v));
  return direction * (kinetic + drop * std::exp(-alpha * std::abs(v)));
}

double ContactForces::onset_slope() const {
  return characteristic != nullptr ? std::abs(slope(1.0, 0.0)) : alpha * drop;
}

double ContactForces::slope(double direction, double v) const {
  if (characteristic != nullptr && sticks()) return load * characteristic->slope(direction * v);
  if (kind == LawKind::kSpeedDependent) return -alpha * drop * std::exp(-alpha * (direction * v));
  double slope;
  static_cast<void>(smooth(v, slope));
  return slope;
}

}  // namespace slipmode::friction
