#pragma once

#include <Eigen/Core>

namespace slipmode::dynamics {

/// Interpolation of degree 7 at the eight Chebyshev-Lobatto points of [0, 1].
struct LobattoTables {
  Eigen::Matrix<double, 8, 1> point;
  Eigen::Matrix<double, 8, 8> bernstein;  ///< values at the points → Bernstein coefficients of the interpolant
};
[[nodiscard]] const LobattoTables& lobatto();

/// |f − p| over a window of length h for a function whose k-th derivatives are bounded by rateᵏ: this times the bound
/// on |f|. Above 1 the interpolant says nothing.
[[nodiscard]] double interpolation_share(double rate, double h);

/// 1 + the Lebesgue constant of the points (2.2), rounded up: what leaving out |f| ≤ 1 costs at most.
inline constexpr double kInterpolationGain = 3.3;

}  // namespace slipmode::dynamics
