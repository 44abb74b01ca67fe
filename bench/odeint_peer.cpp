#include "bench/odeint_peer.hpp"

#include "bench/event_chain.hpp"
#include "bench/loop_algebra.hpp"

#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <utility>

namespace slipmode::bench {
namespace {

namespace odeint = boost::numeric::odeint;

/// True when the guard of the current mode has been passed; `out_g` is its value, positive before the event.
double guard_value(const EventChain& chain, const double* y) {
  return chain.mode() != 0 ? chain.slip_guard(y) : chain.static_limit() - std::abs(chain.holding_force(y));
}

template <class State>
PeerRun integrate(const ChainProblem& problem, State y, const std::vector<double>& q, const std::vector<double>& v,
                  double duration, double rtol, double atol) {
  EventChain chain(problem);
  chain.start(q, v, y.data());
  const auto rhs = [&chain](const State& x, State& dx, double) { chain.derivative(x.data(), dx.data()); };
  auto stepper =
      odeint::make_dense_output(atol, rtol, odeint::runge_kutta_dopri5<State, double, State, double, LoopAlgebra>());

  PeerRun run;
  State work = y;
  double t = 0.0, dt = 0.01;
  stepper.initialize(y, t, dt);
  while (t < duration) {
    const auto [from, to] = stepper.do_step(rhs);
    ++run.steps;
    if (guard_value(chain, stepper.current_state().data()) >= 0.0) {
      t = to;
      continue;
    }
    const auto guard_at = [&](double time) {
      stepper.calc_state(time, work);
      return guard_value(chain, work.data());
    };
    // After a release the guard starts at zero: begin the bracket just inside.
    const double low = from + 1e-6 * (to - from);
    double hit = to;
    const double g_low = guard_at(low), g_high = guard_at(to);
    if (g_low <= 0.0) {
      hit = low;
    } else if (g_high < 0.0) {
      std::uintmax_t iterations = 60;
      hit = boost::math::tools::toms748_solve(guard_at, low, to, g_low, g_high,
                                              boost::math::tools::eps_tolerance<double>(52), iterations)
                .second;
    }
    if (hit >= duration) {
      t = to;
      continue;
    }
    stepper.calc_state(hit, work);
    dt = stepper.current_time_step();
    y = work;
    chain.resolve(y.data());
    run.event_times.push_back(hit);
    t = hit;
    stepper.initialize(y, t, dt);
  }
  stepper.calc_state(duration, work);
  chain.finish(work.data(), run);
  return run;
}

}  // namespace

PeerRun run_odeint_dopri5(const ChainProblem& problem, const std::vector<double>& q, const std::vector<double>& v,
                          double duration, double rtol, double atol) {
  if (problem.n == 10) return integrate(problem, std::array<double, 20>{}, q, v, duration, rtol, atol);
  return integrate(problem, std::vector<double>(2 * problem.n), q, v, duration, rtol, atol);
}

}  // namespace slipmode::bench
