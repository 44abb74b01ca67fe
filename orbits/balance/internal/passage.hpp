#pragma once

#include <slipmode/dynamics/system.hpp>

#include <vector>

namespace slipmode::orbits {

/// What a contact does over a period of a series.
struct Passage {
  struct Switch {
    double theta = 0.0;  ///< in [0, 2π)
    dynamics::ContactMode after = dynamics::ContactMode::kStick;
  };
  dynamics::ContactMode first = dynamics::ContactMode::kStick;  ///< at θ = 0
  std::vector<Switch> switches;                                 ///< ascending
};

}  // namespace slipmode::orbits
