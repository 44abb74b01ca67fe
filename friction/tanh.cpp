#include <slipmode/friction/tanh.hpp>

#include <cmath>

namespace slipmode::friction {

double TanhRegularised::kinetic_coefficient(double speed) const {
  const double th = std::tanh(speed / epsilon);
  return (mu_k + (mu_s - mu_k) * std::exp(-alpha * (speed * th))) * th;
}

}  // namespace slipmode::friction
