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

double ContactForces::most() const {
  return characteristic == nullptr ? static_limit : std::max(static_limit, load * characteristic->most);
}

double ContactForces::smooth(double v, double& slope) const {
  if (kind != LawKind::kSmooth) return slope = 0.0;
  if (characteristic != nullptr) {
    slope = load * characteristic->slope(std::abs(v));
    const double forward = load * characteristic->mu(std::abs(v));
    return v < 0.0 ? -forward : forward;
  }
  const double th = std::tanh(v / epsilon), dth = (1 - th * th) / epsilon;
  const double magnitude = v * th, d_magnitude = th + v * dth;
  const double e = drop * std::exp(-alpha * magnitude);
  slope = (kinetic + e) * dth - alpha * d_magnitude * e * th;
  return (kinetic + e) * th;
}

double ContactForces::sliding(double direction, double v) const {
  return continued(direction, sticks() ? direction * std::abs(v) : v);
}

double ContactForces::continued(double direction, double v) const {
  double slope = 0.0;
  if (!sticks()) return smooth(v, slope);
  if (kind != LawKind::kSpeedDependent) return direction * onset(direction);
  if (characteristic != nullptr) return direction * load * characteristic->mu(direction * v);
  return direction * (kinetic + drop * std::exp(-alpha * (direction * v)));
}

double ContactForces::onset_slope() const {
  return characteristic != nullptr ? std::abs(slope(1.0, 0.0)) : alpha * drop;
}

double ContactForces::slope(double direction, double v) const {
  if (characteristic != nullptr && sticks()) return load * characteristic->slope(direction * v);
  if (kind == LawKind::kSpeedDependent) return -alpha * drop * std::exp(-alpha * (direction * v));
  double slope = 0.0;
  static_cast<void>(smooth(v, slope));
  return slope;
}

std::optional<LawBounds> ContactForces::bounds(double from, double to) const {
  if (characteristic != nullptr) {
    if (!characteristic->bounds) return std::nullopt;
    const LawBounds mu = sticks() ? characteristic->bounds(from, to)
                                  : characteristic->bounds(std::max({0.0, from, -to}), std::max(to, -from));
    return LawBounds{load * mu.slope, load * mu.curve};
  }
  if (kind == LawKind::kSpeedDependent) {
    const double steepest = alpha * drop * std::exp(-alpha * from);
    return LawBounds{steepest, alpha * steepest};
  }
  if (kind == LawKind::kBristle) return std::nullopt;  // no function of the speed alone
  if (kind != LawKind::kSmooth) return LawBounds{};
  // (k + e) tanh x, x = v/ε, e = d e^{−αm}, m = v tanh x: what is largest at the slowest speed, at that.
  constexpr double kMostOfM = 1.2, kMostOfTh = 0.77;  // m′; 2 tanh x sech²x
  const double slowest = std::max({0.0, from, -to}), x = slowest / epsilon, th = std::tanh(x),
               sech2 = 1.0 / std::pow(std::cosh(x), 2);
  const double e = drop * std::exp(-alpha * slowest * th), rise = sech2 / epsilon,
               bend = std::min(kMostOfTh, 2.0 * sech2) / (epsilon * epsilon),
               m_bend = 2.0 / epsilon * std::min(1.0, (1.0 + x) * sech2);  // |m″| = (2/ε) sech²x |1 − x tanh x|
  return LawBounds{(kinetic + e) * rise + kMostOfM * alpha * e,
                   (kinetic + e) * bend + alpha * e * (kMostOfM * (2.0 * rise + kMostOfM * alpha) + m_bend)};
}

}  // namespace slipmode::friction
