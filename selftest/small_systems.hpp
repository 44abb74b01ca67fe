#pragma once

// The systems its cases are made of.

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/chain.hpp>

#include <cmath>
#include <utility>

namespace slipmode::selftest {

/// One mass m on a spring k with a dashpot c and one contact of load N.
[[nodiscard]] inline dynamics::HybridSystem one_mass(friction::Law law, friction::Drive drive, double dashpot = 0.0,
                                                     double load = 1.0, double mass = 1.0, double stiffness = 1.0) {
  const auto one = [](double value) -> fem::Matrix { return Eigen::MatrixXd::Constant(1, 1, value); };
  return {fem::Structure(one(mass), one(dashpot), one(stiffness)),
          {{Eigen::VectorXd::Ones(1), std::move(law), load}},
          std::move(drive)};
}

/// The uniform chain of S4, chapter 3, contact on the last mass, load 3.
[[nodiscard]] inline dynamics::HybridSystem uniform_chain(int masses, friction::Law law, double belt,
                                                          double damping = 0.006, std::vector<double> ground = {}) {
  return {fem::chain({.masses = masses, .ground_stiffness = std::move(ground), .damping = damping}),
          {{Eigen::VectorXd::Unit(masses, masses - 1), std::move(law), 3.0}},
          friction::Belt::constant(belt)};
}

[[nodiscard]] inline dynamics::State state_of(double q, double v) {
  return {0.0, Eigen::VectorXd::Constant(1, q), Eigen::VectorXd::Constant(1, v)};
}

/// 0 if `action` is refused by that exception, else 1.
template <class Expected, class Action>
[[nodiscard]] double refused(const Action& action) {
  try {
    action();
  } catch (const Expected&) {
    return 0.0;
  }
  return 1.0;
}

}  // namespace slipmode::selftest
