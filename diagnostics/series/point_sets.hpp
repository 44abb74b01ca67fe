#pragma once

#include <span>

namespace slipmode::diagnostics {

/// Wasserstein-1 (earth mover's) distance of two sets on a line, every point of a set with the same weight:
/// ∫ |F_a⁻¹(u) − F_b⁻¹(u)| du over u in (0, 1). Sizes may differ. Unit of the points. O(n log n).
/// @throws InvalidInput  if a set is empty or a value is not finite
[[nodiscard]] double wasserstein(std::span<const double> a, std::span<const double> b);

/// Hausdorff distance of two sets on a line: the largest distance from a point of one set to the nearest of the other.
/// @throws InvalidInput  as wasserstein
[[nodiscard]] double hausdorff(std::span<const double> a, std::span<const double> b);

}  // namespace slipmode::diagnostics
