#pragma once

#include <slipmode/pod/basis.hpp>

#include <string_view>

namespace slipmode::rom {

/// Checks a basis for a structure of n dofs: sizes, finite values, columns that are not zero and not dependent.
/// @param n      expected number of rows; -1 takes the basis's own
/// @param where  the operation, for messages
/// @throws InvalidInput  with the measured figure
void check_basis(const pod::Basis& basis, Eigen::Index n, std::string_view where);

/// Orthonormal columns that span those of Φ [n x L].
[[nodiscard]] Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& vectors);

/// q̄, or zeros when the basis has none.
[[nodiscard]] Eigen::VectorXd mean_or_zero(const pod::Basis& basis);

}  // namespace slipmode::rom
