#pragma once

#include <Eigen/Core>

namespace slipmode::bench {

/// S2's oscillator between stops, x″ + 2ξx′ + g(x) = a cos ωt, for a peer.
struct PlayMass {
  double xi = 0.2, amplitude = 0.3, omega = 0.5005;
};

/// What is done today: Boost.odeint's dopri5 with dense output, stops located by TOMS 748 on the interpolant, restart
/// at every event. @return  x, x′ after so many periods of the force
[[nodiscard]] Eigen::Vector2d run_play_with_odeint(const PlayMass& mass, const Eigen::Vector2d& start, int periods,
                                                   double tolerance);

/// A start run until two states a period apart differ by less than `repeat`, as is done where nothing is known of the
/// attractors' neighbourhoods; at most 1,000 periods.
struct PlayEnd {
  Eigen::Vector2d state;
  int periods = 0;
};
[[nodiscard]] PlayEnd settle_play_with_odeint(const PlayMass& mass, const Eigen::Vector2d& start, double repeat,
                                              double tolerance);

}  // namespace slipmode::bench
