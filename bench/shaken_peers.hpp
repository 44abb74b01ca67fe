#pragma once

#include "bench/shaken_problem.hpp"

namespace slipmode::bench {

/// One event-driven run of a peer.
struct ShakenRun {
  std::vector<double> y;            ///< unknowns at the end [2n]
  std::vector<double> event_times;  ///< every change of the contact, jumps of its point included
  long steps = 0;
};

enum class ShakenMethod {
  kAdams,   ///< CVODE, fixed-point iteration
  kBdf,     ///< CVODE, Newton with the exact dense Jacobian
  kDopri5,  ///< Boost.odeint, dense output, guards bracketed after every step
};

/// Runs from `start` with guards located by the method's own means, restarted at every event.
/// @param tolerance  relative; times the norm of the start it is the absolute one
/// @throws std::runtime_error  when the solver fails, or contact is lost
[[nodiscard]] ShakenRun run_shaken(ShakenMethod method, const ShakenProblem& problem, const ShakenPoint& start,
                                   double duration, double tolerance);

/// The same in long double by dopri5, for use as truth.
[[nodiscard]] ShakenRun run_shaken_reference(const ShakenProblem& problem, const ShakenPoint& start, double duration,
                                             double tolerance);

}  // namespace slipmode::bench
