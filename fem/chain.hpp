#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/fem/structure.hpp>

#include <tuple>
#include <vector>

namespace slipmode::fem {

/// A chain of masses joined by springs along one line (S4 Figure 3.1, any N, any values).
///
/// Spring i joins mass i to mass i+1 (1-based); spring 0 joins mass 1 to the left wall when `left_fixed`, spring N
/// joins mass N to the right wall when `right_fixed`. So `springs` has N - 1 + left_fixed + right_fixed entries, from
/// left to right, or one entry used for all.
struct ChainOptions {
  int masses = 10;
  std::vector<double> mass = {1.0}, stiffness = {1.0}, ground_stiffness = {};
  double damping = 0.0, mass_damping = 0.0;
  bool left_fixed = true, right_fixed = false;
  std::string units = "dimensionless";

  static constexpr auto fields() {
    using Own = ChainOptions;
    return std::tuple{required("masses", &Own::masses, "", "number of masses", {.low = 1.0, .high = 1e7}),
                      optional("mass", &Own::mass, "kg", "one, or one per mass", kPositive).per_item(),
                      optional("stiffness", &Own::stiffness, "N/m", "one, or one per spring", kPositive).per_item(),
                      optional("ground_stiffness", &Own::ground_stiffness, "N/m",
                               "of a spring from each mass to ground: none, one, or one per mass", kNonNegative)
                          .per_item(),
                      optional("damping", &Own::damping, "s", "C = damping K", kNonNegative),
                      optional("mass_damping", &Own::mass_damping, "1/s", "C += mass_damping M", kNonNegative)};
  }
};

/// Assembles the chain (sparse). S4 (3.1)-(3.3) for the defaults with damping = c. Dofs are named "x1".."xN".
/// @throws InvalidInput  for N < 1, a wrong number of values, a mass ≤ 0, a stiffness ≤ 0, a negative damping
[[nodiscard]] Structure chain(const ChainOptions& options);

}  // namespace slipmode::fem
