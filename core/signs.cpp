#include <slipmode/core/signs.hpp>

#include <cmath>

namespace slipmode {

void fix_signs(Eigen::MatrixXd& vectors) {
  constexpr double kTie = 1e-9;
  for (auto vector : vectors.colwise()) {
    const double nearly_largest = (1.0 - kTie) * vector.cwiseAbs().maxCoeff();
    for (const double component : vector) {
      if (std::abs(component) < nearly_largest) continue;
      if (component < 0.0) vector = -vector;
      break;
    }
  }
}

}  // namespace slipmode
