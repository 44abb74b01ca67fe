#include "bench/basin_peer.hpp"

#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <numbers>

namespace slipmode::bench {
namespace {

namespace odeint = boost::numeric::odeint;
using PlayState = std::array<double, 2>;

}  // namespace

Eigen::Vector2d run_play_with_odeint(const PlayMass& mass, const Eigen::Vector2d& start, int periods,
                                     double tolerance) {
  int side = std::abs(start(0)) > 1.0 ? (start(0) > 0.0 ? 1 : -1) : 0;
  const auto rhs = [&](const PlayState& y, PlayState& dy, double t) {
    dy[0] = y[1];
    dy[1] = mass.amplitude * std::cos(mass.omega * t) - 2.0 * mass.xi * y[1];
    if (side != 0) dy[1] -= y[0] - side;
  };
  const auto guard = [&](const PlayState& y) { return side == 0 ? 1.0 - std::abs(y[0]) : side * y[0] - 1.0; };
  auto stepper = odeint::make_dense_output(tolerance, tolerance, odeint::runge_kutta_dopri5<PlayState>());
  const double duration = periods * 2.0 * std::numbers::pi / mass.omega;
  PlayState y{start(0), start(1)}, work = y;
  double t = 0.0, dt = 0.01;
  stepper.initialize(y, t, dt);
  while (t < duration) {
    const auto [from, to] = stepper.do_step(rhs);
    t = to;
    if (guard(stepper.current_state()) >= 0.0) continue;
    const auto guard_at = [&](double time) {
      stepper.calc_state(time, work);
      return guard(work);
    };
    // After an event the guard starts at zero: begin the bracket just inside.
    const double low = from + 1e-6 * (to - from), g_low = guard_at(low);
    double hit = low;
    if (g_low > 0.0) {
      std::uintmax_t iterations = 60;
      hit = boost::math::tools::toms748_solve(guard_at, low, to, g_low, guard_at(to),
                                              boost::math::tools::eps_tolerance<double>(52), iterations)
                .second;
    }
    if (hit >= duration) continue;
    stepper.calc_state(hit, work);
    side = side != 0 ? 0 : (work[0] > 0.0 ? 1 : -1);
    dt = stepper.current_time_step();
    t = hit;
    y = work;
    stepper.initialize(y, t, dt);
  }
  if (periods > 0) stepper.calc_state(duration, work);
  return {work[0], work[1]};
}

PlayEnd settle_play_with_odeint(const PlayMass& mass, const Eigen::Vector2d& start, double repeat, double tolerance) {
  constexpr int kMost = 1000;
  PlayEnd end{start};
  for (double apart = 1.0; apart >= repeat && end.periods < kMost; ++end.periods) {
    const Eigen::Vector2d next = run_play_with_odeint(mass, end.state, 1, tolerance);
    apart = (next - end.state).norm();
    end.state = next;
  }
  return end;
}

}  // namespace slipmode::bench
