#include <slipmode/friction/bristle_forces.hpp>

#include <cmath>

namespace slipmode::friction {

BristleForces::Decay BristleForces::decay(double direction, double s) const {
  const double share = s / stribeck_speed, e = drop * std::exp(-share * share);
  const double g = kinetic + e, g_slope = -2.0 * share / stribeck_speed * e;
  const double scale = direction * stiffness / g;
  return {scale * s, scale * (1.0 - s * g_slope / g)};
}

double BristleForces::force_rate(double direction, double s, double z, double s_rate) const {
  // d²z/dt² = (1 − κ′z) ṡ − κ ż
  const Decay at = decay(direction, s);
  const double z_rate = s - at.value * z;
  return (stiffness - damping * at.value) * z_rate + (damping * (1.0 - at.slope * z) + viscous) * s_rate;
}

}  // namespace slipmode::friction
