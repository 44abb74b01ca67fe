#pragma once

#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/basis.hpp>

namespace slipmode::pod {

/// Share of each natural mode in each basis vector, in the mass metric:
///
///     share(i, k) = (φ_kᵀ M ψ_i)² / (ψ_iᵀ M ψ_i).
///
/// Rows are basis vectors, columns natural modes, as in S4 Tables 5.1 and 5.2. A row sums to 1 over all n modes, and
/// over the first k when the vector was fitted by those.
/// @param modes  natural modes of the structure, mass-normalised [n x k]
/// @param M      the structure's mass matrix [n x n]
/// @throws InvalidInput  for sizes that do not fit or a basis vector that is zero
[[nodiscard]] Eigen::MatrixXd mode_shares(const Basis& basis, const fem::Modes& modes, const fem::Matrix& M);

}  // namespace slipmode::pod
