#include <slipmode/friction/clearance.hpp>

#include <slipmode/friction/contact_forces.hpp>

#include <cmath>

namespace slipmode::friction {

double Clearance::fastest_rate(const Pace& pace) const {
  double rate = 0.0;
  for (const Stop& stop : stops()) rate += std::sqrt(stop.stiffness * pace.mobility) + stop.damping * pace.mobility;
  return rate;
}

ContactForces Clearance::forces(double /*normal_load*/) const { return {.kind = kind(), .clearance = *this}; }

std::vector<Stop> Clearance::stops() const {
  std::vector<Stop> all;
  if (left) all.push_back(*left);
  if (right) all.push_back(*right);
  return all;
}

double Clearance::force(int side, double y, double v) const {
  if (side > 0) return -right->stiffness * (y - right->gap) - right->damping * v;
  if (side < 0) return -left->stiffness * (y + left->gap) - left->damping * v;
  return 0.0;
}

double Clearance::force_rate(int side, double v, double acceleration) const {
  if (side > 0) return -right->stiffness * v - right->damping * acceleration;
  if (side < 0) return -left->stiffness * v - left->damping * acceleration;
  return 0.0;
}

}  // namespace slipmode::friction
