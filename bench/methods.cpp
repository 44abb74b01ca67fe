#include "bench/methods.hpp"

#include "bench/chain_system.hpp"
#include "bench/clock.hpp"
#include "bench/cvode_peer.hpp"
#include "bench/odeint_peer.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/taylor_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slipmode::bench {
namespace {

using dynamics::HybridSystem;
using dynamics::State;

std::vector<double> plain(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

}  // namespace

std::vector<Truth> true_stretches(const HybridSystem& system, const State& first, double stretch, int count) {
  fixtures::TaylorReference<long double> reference(fixtures::reference_of(system));
  std::vector<Truth> result;
  for (const State& start : starts_on_attractor(system, first, stretch, count)) {
    const fixtures::ReferenceRun run = reference.run(start.q, start.v, 0.0, stretch);
    PeerRun end{plain(run.q), plain(run.v), {}, 0};
    for (const auto& event : run.events) end.event_times.push_back(event.time);
    result.push_back({start, std::move(end)});
  }
  return result;
}

MethodFigures errors_of(const Method& method, const std::vector<Truth>& truth, double stretch) {
  MethodFigures figures;
  std::vector<double> errors;
  for (const Truth& t : truth) {
    const PeerRun run = method(t.start, stretch);
    figures.events += static_cast<long>(run.event_times.size());
    double error = 0.0;
    for (std::size_t i = 0; i < run.q.size(); ++i) {
      error = std::max({error, std::abs(run.q[i] - t.end.q[i]), std::abs(run.v[i] - t.end.v[i])});
    }
    errors.push_back(error);
    if (run.event_times.size() != t.end.event_times.size()) {
      figures.event_time_error = std::numeric_limits<double>::infinity();
      continue;
    }
    for (std::size_t i = 0; i < run.event_times.size(); ++i) {
      figures.event_time_error =
          std::max(figures.event_time_error, std::abs(run.event_times[i] - t.end.event_times[i]));
    }
  }
  figures.error = median(errors);
  figures.worst_error = *std::max_element(errors.begin(), errors.end());
  return figures;
}

Method slipmode_method(const HybridSystem& system, double tolerance, Checks checks) {
  return [&system, tolerance, checks](const State& start, double duration) {
    const auto run = dynamics::simulate(
        system, start,
        {.duration = duration,
         .flow = {.tolerance = tolerance, .audit = checks != Checks::kNone, .certify = checks == Checks::kCertified}});
    PeerRun result{plain(run.final_state.q), plain(run.final_state.v), {}, 0};
    for (const auto& event : run.events) {
      if (event.before != event.after) result.event_times.push_back(event.time);
    }
    return result;
  };
}

Method cvode_method(const ChainProblem& problem, double rtol, double atol) {
  return [problem, rtol, atol](const State& start, double duration) {
    return run_cvode_adams(problem, plain(start.q), plain(start.v), duration, rtol, atol);
  };
}

Method odeint_method(const ChainProblem& problem, double rtol, double atol) {
  return [problem, rtol, atol](const State& start, double duration) {
    return run_odeint_dopri5(problem, plain(start.q), plain(start.v), duration, rtol, atol);
  };
}

Method tanh_method(const ChainProblem& problem, double epsilon, double rtol, double atol) {
  return [problem, epsilon, rtol, atol](const State& start, double duration) {
    return run_cvode_bdf_tanh(problem, epsilon, plain(start.q), plain(start.v), duration, rtol, atol);
  };
}

}  // namespace slipmode::bench
