#pragma once

#include <Eigen/Core>

namespace slipmode::pod {

/// Replaces the upper triangle R by that of the QR factorisation of [R; rows]: RᵀR grows by rowsᵀrows.
///
/// Householder reflectors that touch one row of R and all of `rows`, gathered into panels (compact WY form), as in
/// LAPACK's DTPQRT. Each column's error is relative to that column's own norm, so badly scaled columns keep their
/// digits. Cost 2 b n² for b rows.
/// @param R     n x n, or such a block on the diagonal of one; only the upper triangle is read and written
/// @param rows  b x n, destroyed
void absorb_rows(Eigen::Ref<Eigen::MatrixXd> R, Eigen::Ref<Eigen::MatrixXd> rows);

}  // namespace slipmode::pod
