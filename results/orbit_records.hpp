#pragma once

#include <slipmode/orbits/periodic_orbit.hpp>
#include <slipmode/results/store.hpp>

#include <string>

namespace slipmode::results {

inline constexpr const char* kOrbitGroup = "orbit";

/// A periodic orbit with its fundamental matrix, multipliers, events and regimes: reads back to the same bits.
void save(StoreWriter& store, const std::string& group, const orbits::PeriodicOrbit& orbit);
/// @throws InvalidInput  when something is missing, of wrong size, or not finite
[[nodiscard]] orbits::PeriodicOrbit load_orbit(const StoreReader& store, const std::string& group = kOrbitGroup);

}  // namespace slipmode::results
