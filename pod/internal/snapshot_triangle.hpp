#pragma once

#include <Eigen/Core>
#include <functional>

namespace slipmode::pod {

/// What a decomposition needs of some snapshots: how many, their mean q̄, and the triangle R with
/// RᵀR = Σ (x − q̄)(x − q̄)ᵀ.
struct SnapshotTriangle {
  Eigen::Index count = 0;
  /// A snapshot near the others, from which they are measured: small motion about a large offset keeps its digits [m]
  Eigen::VectorXd origin;
  Eigen::VectorXd mean;  ///< q̄ − origin [m]; with the origin zero where the mean stays
  Eigen::MatrixXd R;     ///< n x n, zero below the diagonal
};

/// Rows of a triangle that travel at once: with n columns at most, a small share of it.
inline constexpr Eigen::Index kTriangleRows = 256;

/// Of no snapshots.
[[nodiscard]] SnapshotTriangle empty_triangle(const Eigen::VectorXd& origin);

/// Adds snapshots to `sum`. With T_a snapshots of mean m_a before, and T_b of mean m_b now,
///
///     RᵀR ← RᵀR + Σ_b (x − m_b)(x − m_b)ᵀ + T_a T_b / (T_a + T_b) (m_b − m_a)(m_b − m_a)ᵀ,
///
/// that is, by QR of R, the snapshots less their own mean and one more row. All three terms are positive, so one pass
/// loses nothing against two. Cost 2 n² per snapshot.
/// @param group        n x b, measured from sum.origin [m]
/// @param remove_mean  false: both means stay zero
void absorb(SnapshotTriangle& sum, const Eigen::Ref<const Eigen::MatrixXd>& group, bool remove_mean);

/// The same with snapshots of which only the triangle is left. Its zeros are left out: cost (2/3) n³.
/// @param other  its R need not be there
/// @param rows   rows k … min(k + 256, n) − 1 of its R from column k on, zero below the diagonal; asked for
///               k = 0, 256, …
void join(SnapshotTriangle& sum, const SnapshotTriangle& other,
          const std::function<Eigen::MatrixXd(Eigen::Index k)>& rows);

/// The same with a triangle that is here.
void join(SnapshotTriangle& sum, const SnapshotTriangle& other);

/// What join() asks for, of a triangle that is here.
[[nodiscard]] Eigen::MatrixXd rows_of(const SnapshotTriangle& triangle, Eigen::Index k);

}  // namespace slipmode::pod
