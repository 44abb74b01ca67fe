#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include "bench/comparison.hpp"

#include <functional>
#include <vector>

namespace slipmode::bench {

/// A stretch of motion: where it begins, and where it ends in truth.
struct Truth {
  dynamics::State start;
  PeerRun end;
};

/// Consecutive stretches of one motion by the independent reference: Taylor series of order 30 in extended precision,
/// without modal coordinates (tests/fixtures/taylor_reference.hpp).
[[nodiscard]] std::vector<Truth> true_stretches(const dynamics::HybridSystem& system, const dynamics::State& first,
                                                double stretch, int count);

/// Anything that advances a state: slipmode or a peer.
using Method = std::function<PeerRun(const dynamics::State& start, double duration)>;

/// What a run of slipmode keeps an eye on: nothing, the energy audit, or the proof that no event is passed too.
enum class Checks { kNone, kAudit, kCertified };

/// The system must outlive the method.
[[nodiscard]] Method slipmode_method(const dynamics::HybridSystem& system, double tolerance, Checks checks);
[[nodiscard]] Method cvode_method(const ChainProblem& problem, double rtol, double atol);
[[nodiscard]] Method odeint_method(const ChainProblem& problem, double rtol, double atol);
[[nodiscard]] Method tanh_method(const ChainProblem& problem, double epsilon, double rtol, double atol);

/// Errors of a method on all stretches; event_time_error is infinite where an event is missing or extra.
[[nodiscard]] MethodFigures errors_of(const Method& method, const std::vector<Truth>& truth, double stretch);

}  // namespace slipmode::bench
