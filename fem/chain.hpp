#pragma once

#include <slipmode/fem/structure.hpp>

#include <vector>

namespace slipmode::fem {

/// A chain of masses joined by springs along one line (S4 Figure 3.1, any N, any values).
///
/// Spring i joins mass i to mass i+1 (1-based); spring 0 joins mass 1 to the left wall when `left_fixed`, spring N
/// joins mass N to the right wall when `right_fixed`. So `springs` has N - 1 + left_fixed + right_fixed entries, from
/// left to right, or one entry used for all.
struct ChainOptions {
  int masses = 10;                            ///< N ≥ 1
  std::vector<double> mass = {1.0};           ///< 1 or N values, > 0 [kg]
  std::vector<double> stiffness = {1.0};      ///< 1 or one per spring, > 0 [N/m]
  std::vector<double> ground_stiffness = {};  ///< empty, 1 or N values, ≥ 0 [N/m]: a spring from each mass to ground
  double damping = 0.0;                       ///< C = damping·K, ≥ 0 [s]
  double mass_damping = 0.0;                  ///< C += mass_damping·M, ≥ 0 [1/s]
  bool left_fixed = true;
  bool right_fixed = false;
  std::string units = "dimensionless";
};

/// Assembles the chain (sparse). S4 (3.1)-(3.3) for the defaults with damping = c. Dofs are named "x1".."xN".
/// @throws InvalidInput  for N < 1, a wrong number of values, a mass ≤ 0, a stiffness ≤ 0, a negative damping
[[nodiscard]] Structure chain(const ChainOptions& options);

}  // namespace slipmode::fem
