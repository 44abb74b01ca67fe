#pragma once

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// Kaplan-Yorke dimension j + (λ_1 + … + λ_j)/|λ_{j+1}|, j the largest number of leading exponents whose sum is not
/// negative; 0 if λ_1 < 0, all of them if no sum is negative. Exponents of −∞ (directions that stick loses) may follow.
/// @param exponents  in any order, any unit [n]
/// @throws InvalidInput  for none, or one that is NaN or +∞
/// Source: Kaplan, Yorke, Lecture Notes in Mathematics 730 (1979) 204.
[[nodiscard]] double kaplan_yorke_dimension(const Eigen::VectorXd& exponents);

}  // namespace slipmode::diagnostics
