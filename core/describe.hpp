#pragma once

#include <slipmode/core/errors.hpp>

#include <string>

namespace slipmode {

/// What went wrong, when and in which state, for people.
[[nodiscard]] std::string describe(const NumericalFailure& failure);

}  // namespace slipmode
