#pragma once

#include "fem/eigensolvers.hpp"
#include "fem/modes.hpp"

namespace slipmode::fem::detail {

/// Flips columns so that each one's largest component in magnitude is positive. Among components equal to the largest
/// within 1e-9 of it the first decides, so that rounding does not flip symmetric shapes.
void fix_signs(Eigen::MatrixXd& shapes);

/// Frequencies and signs by the conventions of Modes. λ = φᵀKφ counts as zero when it is within the rounding error of
/// that very sum, 16 ε |φ|ᵀ|K||φ|.
/// @throws InvalidInput  if a λ is negative beyond rounding: K is not positive semi-definite
[[nodiscard]] Modes conventional_modes(const Structure& structure, EigenPairs pairs);

}  // namespace slipmode::fem::detail
