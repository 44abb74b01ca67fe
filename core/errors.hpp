#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <utility>

namespace slipmode {

/// Something the user can mend: a value, a key, a file. The message says what was expected, what was found, and where.
class InvalidInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A computation that could not be completed: no convergence, too many events in too short a time, a value that is not
/// finite. Carries where it happened so that the caller can report it and keep what was computed before.
class NumericalFailure : public std::runtime_error {
 public:
  /// @param what       what failed, what was expected, what was found
  /// @param at_time    simulated time of the failure (NaN where time has no meaning)
  /// @param at_state   state at the failure, in the coordinates the message names (may be empty)
  /// @param remaining  size of what should have been zero (NaN where there is none)
  NumericalFailure(const std::string& what, double at_time, Eigen::VectorXd at_state, double remaining)
      : std::runtime_error(what), time(at_time), state(std::move(at_state)), residual(remaining) {}

  double time;
  Eigen::VectorXd state;
  double residual;
};

}  // namespace slipmode
