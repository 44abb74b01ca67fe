#pragma once

#include "bench/chain_problem.hpp"

namespace slipmode::bench {

/// Event-driven Boost.odeint dopri5: controlled steps with dense output, guards checked after every step and bracketed
/// by TOMS 748 on the interpolant, restarted at every event. States are contiguous and the algebra is a plain loop the
/// compiler vectorises; fixed-size arrays for ten masses.
[[nodiscard]] PeerRun run_odeint_dopri5(const ChainProblem& problem, const std::vector<double>& q,
                                        const std::vector<double>& v, double duration, double rtol, double atol);

}  // namespace slipmode::bench
