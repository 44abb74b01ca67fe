#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

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
  /// @param what      what failed, what was expected, what was found
  /// @param time      simulated time of the failure (NaN where time has no meaning)
  /// @param state     state at the failure, in the coordinates the message names (may be empty)
  /// @param residual  size of what should have been zero (NaN where there is none)
  NumericalFailure(const std::string& what, double time, Eigen::VectorXd state, double residual)
      : std::runtime_error(what), time(time), state(std::move(state)), residual(residual) {}

  double time;
  Eigen::VectorXd state;
  double residual;
};

}  // namespace slipmode
