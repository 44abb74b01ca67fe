#pragma once

#include <slipmode/core/none.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace slipmode {

/// The middle one of the values in order, the mean of the middle two of an even number; kNone of no values. Cost O(n).
/// @param values  none of them NaN
[[nodiscard]] inline double median(std::vector<double> values) {
  if (values.empty()) return kNone;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

}  // namespace slipmode
