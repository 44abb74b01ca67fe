#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/masses.hpp>
#include <slipmode/orbits/branches/continuation.hpp>

#include <Eigen/Core>
#include <numbers>

namespace slipmode::orbits {

/// Table 2.1 of S0: m = 1, c = 0.05, stops k = 4, c = 0.5, gap 1, force A sin ωt.
struct Backlash {
  double amplitude = 1.0, omega = 1.0;
  friction::ContactLoss loss = friction::ContactLoss::kZeroForce;

  [[nodiscard]] static friction::Drive drive(double amplitude, double omega) {
    return friction::Force{omega, {{.amplitude = amplitude}}};
  }
  [[nodiscard]] dynamics::HybridSystem system() const {
    const friction::Stop stop{.stiffness = 4.0, .damping = 0.5, .gap = 1.0};
    return {fem::masses({.links = {{.damping = 0.05}}}),
            {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop, loss}}},
            drive(amplitude, omega),
            {},
            Eigen::MatrixXd::Ones(1, 1)};
  }
};

/// Table 2.2 of S0 with c_s = 0.5 (see docs/theory/orbits.md): four masses, backlash between the second and the third.
[[nodiscard]] inline dynamics::HybridSystem four_masses(double omega) {
  const friction::Stop stop{.stiffness = 4.0, .damping = 0.5, .gap = 1.0};
  return {fem::masses({.mass = {0.5, 1.0, 1.0, 0.5},
                       .links = {{0, 1, 0.2, 0.02}, {1, 2, 0.2, 0.02}, {2, 3, 0.0, 0.05}, {3, 4, 0.2, 0.02}}}),
          {{Eigen::Vector4d(0.0, -1.0, 1.0, 0.0), friction::Clearance{stop, stop}}},
          Backlash::drive(1.0, omega),
          {},
          Eigen::Vector4d::Unit(0)};
}

/// S2 (1): x″ + 2ξ x′ + g(x) = a cos ωt, g = x ∓ 1 beyond ±1.
[[nodiscard]] inline dynamics::HybridSystem play(double xi, double a, double omega) {
  const friction::Stop stop{.stiffness = 1.0, .gap = 1.0};
  return {fem::masses({.links = {{.damping = 2.0 * xi}}}),
          {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop, friction::ContactLoss::kGap}}},
          friction::Force{omega, {{.amplitude = a, .phase = std::numbers::pi / 2.0}}},
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

/// S1 (6): q″ + Z q′ + Ω h(q) = f_m + f_a cos ηt, multiplied by adj Ω so that stops press along e₁, e₂ with det Ω.
[[nodiscard]] inline dynamics::HybridSystem three_masses(double eta) {
  Eigen::MatrixXd omega(2, 2), zeta(2, 2), adjugate(2, 2);
  omega << 1.0, -0.36, -0.36, 1.21;
  zeta << 0.1, -0.06, -0.06, 0.11;
  adjugate << 1.21, 0.36, 0.36, 1.0;
  const friction::Stop stop{.stiffness = 1.0 * 1.21 - 0.36 * 0.36, .gap = 1.0};
  const friction::Clearance law{stop, stop, friction::ContactLoss::kGap};
  return {fem::Structure(adjugate, Eigen::MatrixXd(adjugate * zeta), Eigen::MatrixXd(0.0 * adjugate)),
          {{Eigen::Vector2d(1.0, 0.0), law}, {Eigen::Vector2d(0.0, 1.0), law}},
          friction::Force{eta, {{.amplitude = 1.0, .phase = std::numbers::pi / 2.0}}},
          adjugate * Eigen::Vector2d(0.5, 0.25),
          adjugate * Eigen::Vector2d(0.25, 0.0)};
}

/// NLvib's third example (datasets/stop_2mass): two masses, the first before a stiff stop, the second under a force.
[[nodiscard]] inline dynamics::HybridSystem before_a_stop(double omega) {
  const friction::Stop stop{.stiffness = 100.0, .gap = 1.0};
  return {fem::masses({.mass = {1.0, 1.0}, .links = {{1, 2, 1.0, 0.03}, {2, 0, 1.0, 0.03}}}),
          {{Eigen::Vector2d(1.0, 0.0),
            friction::Clearance{.left = {}, .right = stop, .loss = friction::ContactLoss::kGap}}},
          Backlash::drive(0.1, omega),
          {},
          Eigen::Vector2d(0.0, 1.0)};
}

/// A linear oscillator under sin ωt: its stops are too far away to be reached.
[[nodiscard]] inline dynamics::HybridSystem far_from_stops(double c, double k, double omega) {
  const friction::Stop far{.stiffness = 1.0, .gap = 500.0};
  return {fem::masses({.links = {{.stiffness = k, .damping = c}}}),
          {{Eigen::VectorXd::Ones(1), friction::Clearance{far, far}}},
          Backlash::drive(1.0, omega),
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

/// The same system under A sin ωt at other frequencies: regimes are shared.
[[nodiscard]] inline dynamics::SystemFamily over_frequency(const dynamics::HybridSystem& base, double amplitude = 1.0) {
  return [base, amplitude](double omega) { return base.with_drive(Backlash::drive(amplitude, omega)); };
}

/// The system over frequency and amplitude of its force.
[[nodiscard]] inline dynamics::PlaneFamily over_force(const dynamics::HybridSystem& base) {
  return [base](double omega, double amplitude) {
    friction::Force force = *base.drive().force();
    force.omega = omega;
    force.harmonics.front().amplitude = amplitude;
    return base.with_drive(force);
  };
}

[[nodiscard]] inline dynamics::SystemFamily at_amplitude(const dynamics::PlaneFamily& family, double amplitude) {
  return [family, amplitude](double omega) { return family(omega, amplitude); };
}

[[nodiscard]] inline dynamics::State displaced(const dynamics::HybridSystem& system, Eigen::Index dof, double x) {
  dynamics::State state = system.rest();
  state.q[dof] = x;
  return state;
}

}  // namespace slipmode::orbits
