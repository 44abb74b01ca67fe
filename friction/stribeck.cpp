#include <slipmode/friction/stribeck.hpp>

#include <cmath>

namespace slipmode::friction {

double Stribeck::kinetic_coefficient(double speed) const { return mu_k + (mu_s - mu_k) * std::exp(-alpha * speed); }

ContactForces Stribeck::forces(double normal_load) const {
  if (kind() == LawKind::kConstant) return {.kinetic = kinetic_coefficient(0.0) * normal_load, .alpha = alpha};
  return {.kind = kind(), .kinetic = mu_k * normal_load, .drop = (mu_s - mu_k) * normal_load, .alpha = alpha};
}

}  // namespace slipmode::friction
