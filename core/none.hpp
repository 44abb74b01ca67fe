#pragma once

#include <limits>

namespace slipmode {

/// No value: what was not measured, does not apply, or has no time.
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace slipmode
