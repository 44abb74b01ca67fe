#include "bench/long_chain_cases.hpp"

#include "bench/chain_system.hpp"
#include "bench/clock.hpp"
#include "bench/methods.hpp"
#include "bench/odeint_peer.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::bench {
namespace {

constexpr double kUnits = 1e4, kPeerUnits = 1e3, kErrorAfter = 100.0;
constexpr double kChainTolerance = 3e-5;  // the one that stribeck1000 is run at: errors below dopri5's
constexpr int kCutOff = 400;

dynamics::Trajectory contact_run(const dynamics::HybridSystem& system, double duration) {
  return dynamics::simulate(system, system.rest(),
                            {.duration = duration,
                             .sample = duration,
                             .output = dynamics::SimulateOptions::Output::kContacts,
                             .flow = {.tolerance = kChainTolerance}});
}

PeerRun dopri5_run(const ChainProblem& problem, double duration) {
  const std::vector<double> rest(static_cast<std::size_t>(problem.n), 0.0);
  return run_odeint_dopri5(problem, rest, rest, duration, 1e-9, 1e-9);
}

/// The contact (q, v) after kErrorAfter.
std::pair<double, double> true_contact(ChainProblem problem) {
  problem.n = std::min(problem.n, kCutOff);
  const dynamics::HybridSystem system = system_of(problem);
  const PeerRun end = true_stretches(system, system.rest(), kErrorAfter, 1).front().end;
  return {end.q.back(), end.v.back()};
}

}  // namespace

Row measure_long_chain(bool quick) {
  const ChainProblem problem{.name = "chain", .n = quick ? 1000 : 10000, .ground = 0.25};
  const dynamics::HybridSystem system = system_of(problem);
  const dynamics::Trajectory early = contact_run(system_of(problem), kErrorAfter);
  const PeerRun peer_early = dopri5_run(problem, kErrorAfter);
  const auto [q, v] = true_contact(problem);
  const auto error = [&q = q, &v = v](double contact_q, double contact_v) {
    return std::max(std::abs(contact_q - q), std::abs(contact_v - v));
  };
  const double own_error = error(early.contact_q(0, 1), early.contact_v(0, 1));
  const double peer_error = error(peer_early.q.back(), peer_early.v.back());

  dynamics::Trajectory run;
  const double first = thread_seconds_of([&] { run = contact_run(system, kUnits); });
  const double again = thread_seconds_of([&] { run = contact_run(system, kUnits); });
  const double peer = kUnits / kPeerUnits * thread_seconds_of([&] { (void)dopri5_run(problem, kPeerUnits); });
  Row row;
  row.lines = {
      fmt::format(
          "{} masses from rest, {:.0f} units, balance on: set-up {:.3f} s, then {:.2f} s ({} events, audit {:.0e}); "
          "dopri5 {:.1f} s: {:.1f} times as long, {:.1f} with the set-up",
          problem.n, kUnits, std::max(0.0, first - again), again, run.statistics.events, std::abs(run.audit.residual()),
          peer, peer / again, peer / first),
      fmt::format("  error of the contact after {:.0f} units: slipmode {:.1e}, dopri5 {:.1e}", kErrorAfter, own_error,
                  peer_error)};
  row.figures = {{"setup_s", std::max(0.0, first - again)},
                 {"run_s", again},
                 {"dopri5_s", peer},
                 {"error", own_error},
                 {"dopri5_error", peer_error}};
  row.timed = {{.name = "chain10000", .ms = 1e3 * again, .ratio_dopri5 = peer / first, .error = own_error}};
  return row;
}

}  // namespace slipmode::bench
