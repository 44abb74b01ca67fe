#pragma once

#include <slipmode/orbits/balance/balance.hpp>
#include "orbits/branches/internal/curve_condition.hpp"

namespace slipmode::orbits {

/// As of an orbit (curve_condition.hpp), by the extremes of the contacts' series.
[[nodiscard]] Touch touch_near(const dynamics::HybridSystem& system, const Balance& balance,
                               const CurveCondition& condition, double share);
/// @throws InvalidInput  as of an orbit
[[nodiscard]] CurveCondition grazed(const dynamics::HybridSystem& system, const Balance& balance,
                                    const CurveCondition& like);

}  // namespace slipmode::orbits
