#pragma once

#include "cli/session.hpp"

#include <cmath>

namespace slipmode::cli {

/// A number, null if it is not finite: JSON has neither infinities nor NaN.
[[nodiscard]] inline Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace slipmode::cli
