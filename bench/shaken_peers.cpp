#include "bench/shaken_peers.hpp"

#include "bench/event_beam.hpp"
#include "bench/loop_algebra.hpp"
#include "bench/shaken_cvode.hpp"

#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <limits>
#include <utility>

namespace slipmode::bench {
namespace {

namespace odeint = boost::numeric::odeint;

/// @tparam State  of the run's size already
template <class Real, class State>
ShakenRun integrate(const ShakenProblem& problem, State y, const ShakenPoint& start, Real duration, Real tolerance) {
  EventBeam<Real> beam(problem, start);
  std::copy(start.y.begin(), start.y.end(), y.begin());
  const auto rhs = [&beam](const State& x, State& dx, Real t) { beam.derivative(x.data(), dx.data(), t); };
  const Real absolute = tolerance * static_cast<Real>(energy_norm(start.y));
  auto stepper = odeint::make_dense_output(absolute, tolerance,
                                           odeint::runge_kutta_dopri5<State, Real, State, Real, LoopAlgebra>());
  ShakenRun run;
  State work = y;
  const Real first = 1e-6, end = static_cast<Real>(start.time) + duration;
  Real t = static_cast<Real>(start.time);
  stepper.initialize(y, t, first);
  while (t < end) {
    const auto [from, to] = stepper.do_step(rhs);
    ++run.steps;
    const Real g_high = beam.guard(stepper.current_state().data(), to);
    if (g_high >= 0) {
      t = to;
      continue;
    }
    const auto guard_at = [&](Real time) {
      stepper.calc_state(time, work);
      return beam.guard(work.data(), time);
    };
    Real hit = from;
    if (const Real g_low = guard_at(from); g_low > 0) {
      std::uintmax_t iterations = 60;
      const boost::math::tools::eps_tolerance<Real> to_rounding(std::numeric_limits<Real>::digits - 1);
      hit = boost::math::tools::toms748_solve(guard_at, from, to, g_low, g_high, to_rounding, iterations).second;
    }
    if (hit >= end) break;
    stepper.calc_state(hit, work);
    const Real dt = stepper.current_time_step();
    y = work;
    beam.change(y.data(), hit);
    run.event_times.push_back(static_cast<double>(hit));
    t = hit;
    stepper.initialize(y, t, dt);
  }
  stepper.calc_state(end, work);
  run.y.assign(work.begin(), work.end());
  return run;
}

}  // namespace

ShakenRun run_shaken(ShakenMethod method, const ShakenProblem& problem, const ShakenPoint& start, double duration,
                     double tolerance) {
  if (method != ShakenMethod::kDopri5) return run_shaken_cvode(method, problem, start, duration, tolerance);
  if (problem.n == 3) return integrate<double>(problem, std::array<double, 6>{}, start, duration, tolerance);
  if (problem.n == 10) return integrate<double>(problem, std::array<double, 20>{}, start, duration, tolerance);
  return integrate<double>(problem, std::vector<double>(start.y.size()), start, duration, tolerance);
}

ShakenRun run_shaken_reference(const ShakenProblem& problem, const ShakenPoint& start, double duration,
                               double tolerance) {
  return integrate<long double>(problem, std::vector<long double>(start.y.size()), start,
                                static_cast<long double>(duration), static_cast<long double>(tolerance));
}

}  // namespace slipmode::bench
