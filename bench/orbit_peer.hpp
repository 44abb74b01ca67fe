#pragma once

#include <Eigen/Core>
#include <complex>

namespace slipmode::bench {

/// S0's single mass between stops (Table 2.1) for a peer: contact is lost where the stop's force is zero.
struct BacklashMass {
  double omega = 1.0, amplitude = 1.0;
  double damping = 0.05, stop_stiffness = 4.0, stop_damping = 0.5, gap = 1.0;
};

/// What is done today: CVODE (Adams, root finding, restart at every event), shooting with forward differences.
struct PeerOrbit {
  Eigen::Vector2d start;
  Eigen::Vector2cd multipliers;
  double residual = 0.0;  ///< |x(T) − x(0)|
  int iterations = 0, runs = 0;
};

/// @param guess      x, ẋ at time 0
/// @param tolerance  relative tolerance of CVODE; Newton ends where steps no longer help, at about this
/// @throws std::runtime_error  when CVODE fails or Newton does not converge in 20 steps
[[nodiscard]] PeerOrbit shoot_with_cvode(const BacklashMass& mass, const Eigen::Vector2d& guess, double tolerance);

}  // namespace slipmode::bench
