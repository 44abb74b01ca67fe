#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/fem/structure.hpp>

#include <string>
#include <tuple>
#include <vector>

namespace slipmode::fem {

/// A spring and a damper side by side, between two masses or between a mass and ground.
struct Link {
  int first = 0;   ///< a mass, from 1; 0 is ground
  int second = 1;  ///< a mass, from 1, not `first`
  double stiffness = 0.0, damping = 0.0;

  static constexpr auto fields() {
    return std::tuple{optional("stiffness", &Link::stiffness, "N/m", "of the spring", kNonNegative),
                      optional("damping", &Link::damping, "N s/m", "of the damper", kNonNegative)};
  }
};

/// Masses that move along one line, joined as `links` say. Nothing need hold them: parts may float.
struct MassesOptions {
  std::vector<double> mass = {1.0};
  std::vector<Link> links = {};  ///< in any order; several between the same two add up
  std::string units = "dimensionless";

  static constexpr auto fields() {
    return std::tuple{required("mass", &MassesOptions::mass, "kg", "one per mass", kPositive).per_item()};
  }
};

/// Assembles them (sparse): each link adds k (x_second − x_first) and c (ẋ_second − ẋ_first). Dofs are "x1".."xN".
/// @throws InvalidInput  for no mass, a mass ≤ 0, a link to a mass that is not there or to itself, a negative value
/// Source: S0 (2.10)-(2.13).
[[nodiscard]] Structure masses(const MassesOptions& options);

}  // namespace slipmode::fem
