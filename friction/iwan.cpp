#include <slipmode/friction/iwan.hpp>

#include <cmath>

namespace slipmode::friction {

double largest_slip(const Iwan& law) {
  const double centroid = (law.chi + 1.0) / (law.chi + 2.0);  // of the density, over φ_max
  return law.slip_force * (1.0 + law.beta) / (law.stiffness * (law.beta + centroid));
}

std::vector<JenkinsElement> elements_of(const Iwan& law) {
  const double density = law.stiffness / (1.0 + law.beta), reach = largest_slip(law);  // all but the impulse
  const double force = density * reach * (law.chi + 1.0) / (law.chi + 2.0);
  std::vector<JenkinsElement> elements;
  double begin = 0.0;
  for (int m = 1; m <= law.elements; ++m) {
    const double end = m == law.elements ? 1.0 : std::pow(law.finest, double(law.elements - m) / (law.elements - 1));
    const auto share = [&](double power) { return std::pow(end, power) - std::pow(begin, power); };
    elements.push_back({.stiffness = density * share(law.chi + 1.0), .slip_force = force * share(law.chi + 2.0)});
    begin = end;
  }
  if (law.beta > 0.0) elements.push_back({.stiffness = law.beta * density, .slip_force = law.beta * density * reach});
  return elements;
}

}  // namespace slipmode::friction
