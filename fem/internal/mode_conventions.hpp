#pragma once

#include <slipmode/fem/modes.hpp>
#include "fem/internal/eigensolvers.hpp"

namespace slipmode::fem::detail {

/// Rounding error of φᵀKφ: 16 ε √(Σ_ij (φ_i K_ij φ_j)²). The terms' own errors add up like a random walk; their sum of
/// magnitudes would be so large that the first mode of a beam of 2000 elements counted as zero.
[[nodiscard]] double rounding_of_quotient(const Matrix& K, const Eigen::VectorXd& shape);

/// Frequencies and signs by the conventions of Modes. λ = φᵀKφ counts as zero when it is within rounding_of_quotient,
/// or is no more than what a solver's error of 4 ε λ_max in K makes of zero: (4 ε λ_max)² over the lowest λ that is
/// clear of that error. (Several parts that float apart have rigid-body shapes of zero stiffness, whose own rounding is
/// zero.)
/// @throws InvalidInput  if a λ is negative beyond rounding: K is not positive semi-definite
[[nodiscard]] Modes conventional_modes(const Structure& structure, EigenPairs pairs);

}  // namespace slipmode::fem::detail
