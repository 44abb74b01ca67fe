#include <slipmode/friction/bristle_forces.hpp>

#include <cmath>

namespace slipmode::friction {

BristleForces::Decay BristleForces::decay(double direction, double s) const {
  const double share = s / stribeck_speed, e = drop * std::exp(-share * share);
  const double g = kinetic + e, g_slope = -2.0 * share / stribeck_speed * e;
  const double scale = direction * stiffness / g;
  return {scale * s, scale * (1.0 - s * g_slope / g)};
}

BristleForces::Slopes BristleForces::slopes(double direction, double s, double z) const {
  const Decay at = decay(direction, s);
  return {stiffness - damping * at.value, damping * (1.0 - at.slope * z) + viscous};
}

double BristleForces::force_rate(double direction, double s, double z, double s_rate) const {
  const Slopes by = slopes(direction, s, z);
  return by.by_deflection * rate(direction, s, z) + by.by_speed * s_rate;
}

}  // namespace slipmode::friction
