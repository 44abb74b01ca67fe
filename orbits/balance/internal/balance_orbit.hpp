#pragma once

#include <slipmode/orbits/balance/balance.hpp>

namespace slipmode::orbits {

/// The balance in the terms of an orbit, for what judges and follows orbits: a state of it at time 0, word, symmetry,
/// multipliers by Hill's method, none and a stability unknown where a contact remembers. It closes only as a series;
/// events and monodromy are not told.
/// @param marginal_band, symmetry_tolerance  as ShootingOptions; the asymmetry is that of the even orders' sum
[[nodiscard]] PeriodicOrbit in_terms_of_an_orbit(const dynamics::HybridSystem& system, const Balance& balance,
                                                 double marginal_band, double symmetry_tolerance);

}  // namespace slipmode::orbits
