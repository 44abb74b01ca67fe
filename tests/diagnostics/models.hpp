#pragma once

#include <slipmode/diagnostics/model.hpp>
#include "fixtures/belt_oscillator.hpp"
#include "fixtures/scenes.hpp"

namespace slipmode::tests {

/// datasets/chain10: S4 chapter 3 with the identified numbers.
[[nodiscard]] inline dynamics::HybridSystem chain10(double speed) {
  return fixtures::belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, friction::Belt::constant(speed));
}

/// A state in the basin of the period-3 orbit T = 45.18680 that exists at belt speed 0.39 beside four other motions.
[[nodiscard]] inline dynamics::State near_period_three() {
  Eigen::VectorXd q(10), v(10);
  q << 0.0649, 0.4402, 0.5477, 0.7367, 1.0640, 1.3978, 1.8766, 2.9646, 4.3887, 5.5870;
  v << 0.0809, -0.3399, -0.1489, 0.3577, 0.4865, 0.3400, 0.0610, -0.0931, 0.1006, 0.3900;
  return {0.0, q, v, {}};
}

/// A state in the basin of the period-5 orbit T = 227.26927 at belt speed 0.41.
[[nodiscard]] inline dynamics::State near_period_five() {
  Eigen::VectorXd q(10), v(10);
  q << 1.0045, 2.1170, 3.1597, 4.1654, 5.2952, 6.4811, 7.5005, 8.4917, 9.6687, 10.8665;
  v << -0.2482, -0.0564, -0.0114, -0.1986, -0.3201, -0.2312, -0.1667, -0.2059, 0.0541, 0.4100;
  return {0.0, q, v, {}};
}

/// The closed-form stick-slip oscillator as a system.
[[nodiscard]] inline dynamics::HybridSystem system_of(const fixtures::BeltOscillator& o) {
  return fixtures::oscillator(o.mass, o.stiffness, 0.0, friction::Coulomb{o.mu_s, o.mu_k}, o.load,
                              friction::Belt::constant(o.belt));
}

/// On the belt oscillator's limit cycle, just released.
[[nodiscard]] inline dynamics::State released(const fixtures::BeltOscillator& o) {
  return {0.0, Eigen::VectorXd::Constant(1, o.release_position()), Eigen::VectorXd::Constant(1, o.belt), {}};
}

}  // namespace slipmode::tests
