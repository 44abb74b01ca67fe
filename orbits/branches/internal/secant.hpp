#pragma once

#include <cmath>
#include <optional>
#include <utility>

namespace slipmode::orbits {

/// The root of a function by secants from `start` and a point beside it.
/// @param value      x → its value, or nothing where there is none; last called at most `tolerance` from the root
/// @param reach      from the start, beyond which no root is looked for
/// @return           nothing where the function ends, is flat, or keeps its root back
template <class Function>
[[nodiscard]] std::optional<double> secant_root(const Function& value, double start, double beside, double tolerance,
                                                double reach) {
  constexpr int kMaxSteps = 30;
  double last = start, here = beside;
  std::optional<double> at_last = value(last);
  for (int k = 0; at_last && k < kMaxSteps; ++k) {
    const std::optional<double> at_here = value(here);
    if (!at_here || *at_here == *at_last) return std::nullopt;
    const double next = here - *at_here * (here - last) / (*at_here - *at_last);
    if (std::abs(next - here) <= tolerance) return next;
    if (std::abs(next - start) > reach) return std::nullopt;
    at_last = at_here;
    last = std::exchange(here, next);
  }
  return std::nullopt;
}

}  // namespace slipmode::orbits
