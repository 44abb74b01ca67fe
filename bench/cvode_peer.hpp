#pragma once

#include "bench/chain_problem.hpp"

namespace slipmode::bench {

/// Event-driven CVODE: Adams, fixed-point iteration, serial vectors, rootfinding on the guards (falling only),
/// restarted at every event.
[[nodiscard]] PeerRun run_cvode_adams(const ChainProblem& problem, const std::vector<double>& q,
                                      const std::vector<double>& v, double duration, double rtol, double atol);

/// What most people do: the tanh-regularised law with BDF, band matrix (interleaved unknowns) and exact Jacobian.
/// λ = N (μ_k + (μ_s − μ_k) e^{−α v tanh(v/ε)}) tanh(v/ε).
[[nodiscard]] PeerRun run_cvode_bdf_tanh(const ChainProblem& problem, double epsilon, const std::vector<double>& q,
                                         const std::vector<double>& v, double duration, double rtol, double atol);

}  // namespace slipmode::bench
