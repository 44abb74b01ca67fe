#include <slipmode/friction/lugre.hpp>

#include <cmath>

namespace slipmode::friction {

double LuGre::kinetic_coefficient(double speed) const {
  const double share = speed / stribeck_speed;
  return mu_k + (mu_s - mu_k) * std::exp(-share * share);
}

double LuGre::fastest_rate(const Pace& pace) const {
  return std::sqrt(stiffness * pace.mobility) + (damping + viscous) * pace.mobility +
         stiffness * pace.speed / (mu_k * pace.load) + pace.acceleration / stribeck_speed;
}

ContactForces LuGre::forces(double normal_load) const {
  return {.kind = kind(),
          .bristle = {.stiffness = stiffness,
                      .damping = damping,
                      .viscous = viscous,
                      .kinetic = mu_k * normal_load,
                      .drop = (mu_s - mu_k) * normal_load,
                      .stribeck_speed = stribeck_speed}};
}

}  // namespace slipmode::friction
