#pragma once

#include <slipmode/orbits/branches/continuation.hpp>
#include "clearance_systems.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace slipmode::orbits {

/// The orbit that a motion from a displaced first mass settles to.
[[nodiscard]] inline PeriodicOrbit settled(const dynamics::HybridSystem& system, double x,
                                           const ShootingOptions& options = {}) {
  return find_orbit(system, settle_guess(system, displaced(system, 0, x), 40.0), options);
}

[[nodiscard]] inline std::vector<SpecialPoint> of_kind(const Branch& branch, SpecialKind kind) {
  std::vector<SpecialPoint> found;
  std::copy_if(branch.special.begin(), branch.special.end(), std::back_inserter(found),
               [&](const SpecialPoint& point) { return point.kind == kind; });
  return found;
}

}  // namespace slipmode::orbits
