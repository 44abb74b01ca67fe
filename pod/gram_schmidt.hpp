#pragma once

#include <slipmode/fem/structure.hpp>

#include <string_view>

namespace slipmode::pod {

/// V = Φ R with ΦᵀMΦ = I and R upper triangular with a positive diagonal.
struct MassOrthonormal {
  Eigen::MatrixXd vectors;   ///< Φ, n x L; the first k columns span those of V for every k
  Eigen::MatrixXd triangle;  ///< R, L x L
};

/// Modified Gram-Schmidt in the inner product xᵀMy, each vector treated twice: what one pass leaves by cancellation the
/// second removes. With M the mass matrix of a beam with its tip body this is ∫ρA φ_i φ_j dx + the body's share.
/// @param V      n x L, independent columns
/// @param M      n x n, symmetric positive definite
/// @param where  the operation, for messages
/// @throws InvalidInput      for sizes that do not fit, values not finite, or a column of which less than 1e-10 is left
///                           outside the span of those before it
/// @throws NumericalFailure  if ΦᵀMΦ differs from I by more than 1e-10
/// Cost O(n L²) and L products with M. Source: S4 section 5.4 and 6.1.4; Giraud, Langou, Rozložník, van den Eshof,
/// Numer. Math. 101 (2005) 87 (twice is enough).
[[nodiscard]] MassOrthonormal mass_orthonormalise(const Eigen::MatrixXd& V, const fem::Matrix& M,
                                                  std::string_view where = "Gram-Schmidt");

/// @throws NumericalFailure  if ΦᵀMΦ differs from I by more than 1e-10
void check_mass_orthonormal(const Eigen::MatrixXd& vectors, const fem::Matrix& M, std::string_view where);

}  // namespace slipmode::pod
