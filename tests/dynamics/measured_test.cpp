// Friction by measured points on the collocation flow: a force whose curvature jumps at each point.
#include <slipmode/dynamics/nodes.hpp>
#include <slipmode/fem/masses.hpp>
#include "fixtures/runge_kutta_reference.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Characteristic;
using friction::Measured;
using friction::Shaker;
using friction::Stribeck;

/// A curve as one measures it: falls, has a dip, rises; a static peak above it.
const Measured kMeasured{.mu_s = 0.35,
                         .speeds = {0.0, 0.03, 0.08, 0.15, 0.3, 0.5, 0.8},
                         .coefficients = {0.3, 0.24, 0.19, 0.17, 0.18, 0.21, 0.2}};

/// Its functions, which the reference takes.
Characteristic functions_of(const Measured& law) { return *law.forces(1.0).characteristic; }

/// The points of a Stribeck law, h apart.
Measured points_of(const Stribeck& law, double h) {
  Measured points{.mu_s = law.mu_s, .speeds = {}, .coefficients = {}};
  for (int k = 0; k * h <= 3.0; ++k) {
    points.speeds.push_back(k * h);
    points.coefficients.push_back(law.mu_k + (law.mu_s - law.mu_k) * std::exp(-law.alpha * k * h));
  }
  return points;
}

// Runge-Kutta in long double: steps of 1e-4 and 2e-4 end within 4e-14 of each other. Without a look between the nodes
// the flow's error stayed at 3.5e-8 whatever the tolerance.
TEST(Measured, FollowsRungeKuttaAtEveryTolerance) {
  const auto chain = [](const friction::Law& law) { return belt_chain(law, Belt::constant(0.15), 3, 0.006, 1.0); };
  const State start{.q = Eigen::VectorXd::Zero(3), .v = Eigen::VectorXd::Zero(3)};
  constexpr double kDuration = 40.0;
  RungeKuttaReference reference(chain(functions_of(kMeasured)), RungeKuttaReference::Mode::kPositive);
  reference.run(kDuration, 1e-4L);
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    const Trajectory run = simulate(chain(kMeasured), start, {.duration = kDuration, .flow = {.tolerance = tolerance}});
    ASSERT_EQ(run.events.size(), reference.changes().size());
    double worst = 0.0;
    for (std::size_t k = 0; k < run.events.size(); ++k) {
      EXPECT_EQ(static_cast<int>(run.events[k].after), reference.changes()[k].mode);
      worst = std::max(worst, std::abs(run.events[k].time - reference.changes()[k].time));
    }
    worst = std::max({worst, (run.final_state.q - reference.q()).cwiseAbs().maxCoeff(),
                      (run.final_state.v - reference.v()).cwiseAbs().maxCoeff()});
    EXPECT_LT(worst, 30.0 * tolerance) << tolerance;
  }
}

// A force so large that the law has changed before a step's first node: no coefficient of the step shows it, and the
// speed was off by 2e-7, by Stribeck's law 3e-8, at any tolerance. Both by v' = F − N μ(v) alone.
TEST(Measured, WhatChangesBeforeAStepsFirstNodeIsSeen) {
  constexpr double F = 1e5, N = 1.3, duration = 1e-3, tolerance = 1e-11;
  const auto speed = [&](const friction::Law& law) {
    const HybridSystem system(fem::masses({.mass = {1.0}, .links = {{0, 1, 0.0, 0.0}}}),
                              {{Eigen::VectorXd::Ones(1), law, N}}, Belt::constant(0.0),
                              Eigen::VectorXd::Constant(1, F));
    return simulate(system, system.rest(), {.duration = duration, .flow = {.tolerance = tolerance}}).final_state.v(0);
  };
  const Measured line{.mu_s = 2.0, .speeds = {0.0, 0.155}, .coefficients = {0.1, 0.42}};
  const GaussRule rule = gauss_rule(16);
  double reach = 0.0;  // when the speed of the last point is: ∫ dv / (F − N μ)
  for (Eigen::Index k = 0; k < rule.node.size(); ++k)
    reach += rule.weight(k) * line.speeds[1] / (F - N * line.kinetic_coefficient(rule.node(k) * line.speeds[1]));
  EXPECT_NEAR(speed(line), line.speeds[1] + (F - N * line.coefficients[1]) * (duration - reach), 30.0 * tolerance);
  const Stribeck steep{0.7, 0.1, 200.0};
  const double away = F - N * steep.mu_k;
  EXPECT_NEAR(speed(steep), away * duration + std::log1p(-N * (steep.mu_s - steep.mu_k) / away) / steep.alpha,
              30.0 * tolerance);
}

// Without static friction, the points of a straight line are a dashpot, whose motion is known; a program's own line
// too.
TEST(Measured, AForceThatRisesFromNothingIsADashpots) {
  constexpr double kDamping = 0.3, kDuration = 20.0;
  const double decay = kDamping / 2.0, omega = std::sqrt(1.0 - decay * decay);
  const double q =
      std::exp(-decay * kDuration) * (std::cos(omega * kDuration) + decay / omega * std::sin(omega * kDuration));
  const Measured points{.mu_s = 0.0, .speeds = {0.0, 0.4, 1.0, 2.0}, .coefficients = {0.0, 0.12, 0.3, 0.6}};
  const Characteristic line{
      .mu_s = 0.0, .mu = [](double v) { return kDamping * v; }, .slope = [](double) { return kDamping; }};
  for (const friction::Law& law : {friction::Law(points), friction::Law(line)}) {
    const dynamics::HybridSystem system = belt_chain(law, Belt::constant(0.0), 1, 0.0, 1.0);
    const Trajectory run = simulate(system, {.q = Eigen::VectorXd::Ones(1), .v = Eigen::VectorXd::Zero(1)},
                                    {.duration = kDuration, .flow = {.tolerance = 1e-11}});
    EXPECT_NEAR(run.final_state.q(0), q, 1e-11);
    EXPECT_TRUE(run.events.empty());
    EXPECT_LT(std::abs(run.audit.residual()), 1e-14);
  }
}

// The reference decides at every zero of the speed anew; its steps of 1e-4 and 2e-4 end within 2e-13 of each other.
TEST(Measured, WithoutStaticFrictionPassesZeroAsRungeKuttaDoes) {
  Measured points = kMeasured;
  points.mu_s = points.coefficients.front() = 0.0;
  const Shaker shaker{.amplitude = 0.4, .frequency_hz = 0.12};
  const auto chain = [&](const friction::Law& law) { return belt_chain(law, shaker, 3, 0.006, 1.0); };
  const State start{.q = Eigen::VectorXd::Zero(3), .v = Eigen::VectorXd::Zero(3)};
  constexpr double kDuration = 40.0;
  RungeKuttaReference reference(chain(functions_of(points)), RungeKuttaReference::Mode::kPositive);
  reference.run(kDuration, 1e-4L);
  ASSERT_GE(reference.changes().size(), 8U);
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    const Trajectory run = simulate(chain(points), start, {.duration = kDuration, .flow = {.tolerance = tolerance}});
    EXPECT_TRUE(run.events.empty());
    EXPECT_LT((run.final_state.q - reference.q()).cwiseAbs().maxCoeff(), 30.0 * tolerance) << tolerance;
    EXPECT_LT((run.final_state.v - reference.v()).cwiseAbs().maxCoeff(), 30.0 * tolerance) << tolerance;
  }
}

TEST(Measured, WithoutStaticFrictionWhatRestsUnderNoForceRestsOn) {
  const Measured points{.mu_s = 0.0, .speeds = {0.0, 0.4, 1.0}, .coefficients = {0.0, 0.12, 0.3}};
  const dynamics::HybridSystem system = belt_chain(points, Belt::constant(0.0), 3);
  const Trajectory run = simulate(system, system.rest(), {.duration = 20.0});
  EXPECT_TRUE(run.events.empty());
  EXPECT_EQ(run.final_state.q, Eigen::VectorXd::Zero(3));
}

// The curve through points of a smooth law is off by the order of h³, and so is the motion.
TEST(Measured, ConvergesToTheLawItsPointsAreOf) {
  const Stribeck law{0.4, 0.2, 2.0};
  const auto end = [](const friction::Law& own) {
    return simulate(belt_chain(own, Belt::constant(0.3), 4), swinging(4, 1, 1.5),
                    {.duration = 8.0, .flow = {.tolerance = 1e-11}})
        .final_state.q;
  };
  const Eigen::VectorXd exact = end(law);
  const double coarse = (end(points_of(law, 0.1)) - exact).norm(), fine = (end(points_of(law, 0.025)) - exact).norm();
  EXPECT_GT(std::log(coarse / fine) / std::log(4.0), 2.5);
}

TEST(Measured, EnergyClosesInLongRuns) {
  const HybridSystem chain = belt_chain(kMeasured, Belt::constant(0.2));
  const Trajectory run = simulate(chain, swinging(10, 1, 1.5), {.duration = 500.0});
  EXPECT_GE(run.events.size(), 20u);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-9);
  EXPECT_GT(run.audit.friction_loss, 0.0);
}

}  // namespace
}  // namespace slipmode::dynamics
