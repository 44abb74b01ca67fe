#pragma once

#include <slipmode/orbits/orbit_series.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::orbits {

/// y(t) = cosine_0 + Σ_{k ≥ 1} cosine_k cos kΩt + sine_k sin kΩt, t the time that the drive's phase counts from.
struct Harmonics {
  Eigen::VectorXd cosine, sine;  ///< orders 0 … K; sine_0 = 0 [unit of y]

  [[nodiscard]] int order() const { return static_cast<int>(cosine.size()) - 1; }
  /// hypot(cosine, sine) of each order.
  [[nodiscard]] Eigen::VectorXd amplitude() const { return (cosine.cwiseAbs2() + sine.cwiseAbs2()).cwiseSqrt(); }
};

/// Fourier coefficients of an exact orbit.
struct Spectrum {
  double omega = 0.0;   ///< Ω = 2π / period of the orbit [rad/s]
  double defect = 0.0;  ///< OrbitSeries::defect: the coefficients' error as a share of their quantity's size
  std::vector<Harmonics> displacement, velocity, force;   ///< of each contact [m], [m/s], [N]
  std::vector<Harmonics> row_displacement, row_velocity;  ///< of each row asked for
};

/// The spectrum up to an order. No series is truncated: the coefficients are those of the orbit, one by one.
/// @param order  K ≥ 0
/// @param rows   r as columns [n x nr], for rᵀq and rᵀq̇
/// @throws InvalidInput  for an order < 0; and as OrbitSeries
[[nodiscard]] Spectrum orbit_spectrum(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, int order,
                                      const Eigen::MatrixXd& rows = {});

}  // namespace slipmode::orbits
