#pragma once

#include <slipmode/fem/structure.hpp>

#include <string>
#include <vector>

namespace slipmode::fem {

/// A spring and a damper side by side, between two masses or between a mass and ground.
struct Link {
  int first = 0;           ///< a mass, from 1; 0 is ground
  int second = 1;          ///< a mass, from 1, not `first`
  double stiffness = 0.0;  ///< ≥ 0 [N/m]
  double damping = 0.0;    ///< ≥ 0 [N s/m]
};

/// Masses that move along one line, joined as `links` say. Nothing need hold them: parts may float.
struct MassesOptions {
  std::vector<double> mass = {1.0};  ///< one per mass, > 0 [kg]
  std::vector<Link> links = {};      ///< in any order; several between the same two add up
  std::string units = "dimensionless";
};

/// Assembles them (sparse): each link adds k (x_second − x_first) and c (ẋ_second − ẋ_first). Dofs are "x1".."xN".
/// @throws InvalidInput  for no mass, a mass ≤ 0, a link to a mass that is not there or to itself, a negative value
/// Source: S0 (2.10)-(2.13).
[[nodiscard]] Structure masses(const MassesOptions& options);

}  // namespace slipmode::fem
