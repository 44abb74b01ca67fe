#include <slipmode/friction/engaged.hpp>

#include <algorithm>

namespace slipmode::friction {

double engaged_stiffness(const Law& law) {
  double stiffness = spring_stiffness(law);
  if (const Clearance* play = clearance(law))
    for (const Stop& stop : play->stops()) stiffness = std::max(stiffness, stop.stiffness);
  return stiffness;
}

}  // namespace slipmode::friction
