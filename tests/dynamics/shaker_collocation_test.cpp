// A shaken counterpart in the collocation flow.
#include "dynamics/end_differences.hpp"
#include "fixtures/against_reference.hpp"
#include "fixtures/den_hartog.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Coulomb;
using friction::Shaker;
using friction::Stribeck;

constexpr FlowOptions kFlow{.method = FlowMethod::kCollocation, .tolerance = 1e-12};

TEST(ShakerCollocation, AStuckMassFollowsTheShakerAtAnyFrequency) {
  // q = d(t) − d(0); λ = m d'' + c d' + k q: what it takes to move the mass so. Natural frequency 1/(2π).
  const double m = 1.0, k = 1.0, c = 0.05;
  for (const double frequency : {0.01, 0.16, 1.3, 40.0}) {
    const Shaker shaker{0.7, frequency, 0.4};
    const HybridSystem system = oscillator(m, k, c, Coulomb{1.0, 1.0}, 1e9, shaker);
    const State start = state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, shaker.velocity(0.0)));
    const Trajectory run = simulate(system, start, {.duration = 20.0, .sample = 0.0371, .flow = kFlow});
    EXPECT_TRUE(run.events.empty());
    const double speed = shaker.amplitude * shaker.omega();
    for (Eigen::Index i = 0; i < run.times.size(); ++i) {
      const double t = run.times(i), q = shaker.displacement(t) - shaker.displacement(0.0);
      EXPECT_NEAR(run.q(0, i), q, 1e-11);
      EXPECT_NEAR(run.v(0, i), shaker.velocity(t), 1e-12 * (1.0 + speed));
      EXPECT_NEAR(run.lambda(0, i), m * shaker.acceleration(t) + c * shaker.velocity(t) + k * q,
                  1e-10 * (1.0 + speed * shaker.omega()));
    }
    // Work of the drive: kinetic and potential energy, and c∫V² = c (Aω)²/2 (t + sin(2ωt + 2φ)/(2ω))|.
    const auto squares = [&](double t) {
      const double angle = 2.0 * (shaker.omega() * t + shaker.phase);
      return 0.5 * speed * speed * (t + std::sin(angle) / (2.0 * shaker.omega()));
    };
    const double V0 = shaker.velocity(0.0), V1 = shaker.velocity(20.0);
    const double q1 = shaker.displacement(20.0) - shaker.displacement(0.0);
    const double expected = 0.5 * m * (V1 * V1 - V0 * V0) + 0.5 * k * q1 * q1 + c * (squares(20.0) - squares(0.0));
    EXPECT_NEAR(run.audit.drive_work, expected, 1e-10 * run.audit.exchanged);
    EXPECT_NEAR(run.audit.friction_loss, 0.0, 1e-10 * run.audit.exchanged);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
  }
}

TEST(ShakerCollocation, DenHartogsNonStopMotion) {
  for (const double ratio : {0.6, 1.7, 2.5}) {
    const DenHartog d{.ratio = ratio};
    const HybridSystem system = oscillator(d.mass, d.stiffness, 0.0, Coulomb{d.friction, d.friction}, 1.0, d.shaker());
    const State start = state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, d.shaker().velocity(0.0)));
    const double half = std::numbers::pi / d.shaker().omega();
    const Trajectory run = simulate(system, start, {.duration = 40.5 * half, .flow = kFlow});
    ASSERT_EQ(run.events.size(), 40u) << ratio;
    for (std::size_t i = 0; i < run.events.size(); ++i) {
      const Event& e = run.events[i];
      const double sign = i % 2 == 0 ? -1.0 : 1.0;
      EXPECT_EQ(e.kind, EventKind::kReversal);
      EXPECT_NEAR(e.time, static_cast<double>(i + 1) * half, 1e-9);
      EXPECT_NEAR(e.displacement - d.shaker().displacement(e.time), sign * d.amplitude(), 1e-9);
    }
    EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
  }
}

TEST(ShakerCollocation, FrictionTakesFourTimesForceTimesAmplitudePerPeriod) {
  const DenHartog d{.ratio = 0.6};
  const HybridSystem system = oscillator(d.mass, d.stiffness, 0.0, Coulomb{d.friction, d.friction}, 1.0, d.shaker());
  const State start = state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, d.shaker().velocity(0.0)));
  const Trajectory run = simulate(system, start, {.duration = 10.0 * d.shaker().period(), .flow = kFlow});
  EXPECT_NEAR(run.audit.friction_loss, 40.0 * d.friction * d.amplitude(), 1e-9);
  EXPECT_NEAR(run.audit.drive_work, run.audit.friction_loss, 1e-9);  // a period gives back what the spring took
}

TEST(ShakerCollocation, FromRestTheNonStopMotionIsReached) {
  const DenHartog d{.ratio = 0.6};
  const HybridSystem system = oscillator(d.mass, d.stiffness, 0.0, Coulomb{d.friction, d.friction}, 1.0, d.shaker());
  const Trajectory run =
      simulate(system, system.rest(),
               {.duration = 400.0 * d.shaker().period(), .transient = 398.0 * d.shaker().period(), .flow = kFlow});
  ASSERT_GE(run.events.size(), 3u);
  for (const Event& e : run.events)
    EXPECT_NEAR(std::abs(e.displacement - d.shaker().displacement(e.time)), d.amplitude(), 1e-9);
}

TEST(ShakerCollocation, TheSteadyMotionTurnsItsSignEveryHalfPeriod) {
  // M q̈ + C q̇ + K q = W λ(V − v), λ odd: with V(t + T/2) = −V(t) also q(t + T/2) = −q(t) is a motion, and here the
  // attractor.
  const Shaker shaker{1.0, 0.11, 0.0};
  for (const friction::Law& law : {friction::Law(Stribeck{0.5, 0.3, 2.0}), friction::Law(Coulomb{0.5, 0.3})}) {
    const HybridSystem system(fem::chain({.masses = 4, .damping = 0.3}), {{unit(4, 3), law, 1.0}}, shaker);
    const double half = 0.5 * shaker.period();
    const Trajectory run =
        simulate(system, swinging(4, 3, 1.0),
                 {.duration = 200.5 * half, .transient = 198.0 * half, .sample = half, .flow = kFlow});
    ASSERT_EQ(run.times.size(), 3);
    EXPECT_GT(run.q.col(0).norm(), 0.1);
    EXPECT_LT((run.q.col(1) + run.q.col(0)).norm(), 1e-9);
    EXPECT_LT((run.v.col(2) - run.v.col(0)).norm(), 1e-9);
  }
}

Shaker random_shaker(Draws& random) {
  return {random.uniform(0.05, 1.5), 0.03 * std::exp(random.uniform(0.0, 4.6)), random.uniform(-3.0, 3.0)};
}

TEST(ShakerCollocation, AgreesWithTheTaylorReferenceOnRandomScenes) {
  std::size_t events = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed, Laws::kAll, 8);
    Draws random(1000 + seed);
    events += expect_near_reference(scene.system.with_drive(random_shaker(random)), scene.start, 15.0, kFlow);
  }
  EXPECT_GT(events, 500u);
}

TEST(ShakerCollocation, TheEnergyBalanceCloses) {
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    const RandomScene scene = random_scene(seed, Laws::kAll, 12);
    Draws random(seed);
    const HybridSystem system = scene.system.with_drive(random_shaker(random));
    const Trajectory run =
        simulate(system, scene.start, {.duration = 60.0, .flow = {.method = FlowMethod::kCollocation}});
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9) << "seed " << seed;
    EXPECT_GE(run.audit.friction_loss, -1e-12 * run.audit.exchanged);
  }
}

TEST(ShakerCollocation, TheTangentFlowAgreesWithDifferences) {
  const HybridSystem system(fem::chain({.masses = 3, .damping = 0.02}),
                            {{unit(3, 2), Stribeck{0.4, 0.2, 2.0}, 1.5}, {unit(3, 0), Coulomb{0.3, 0.15}, 0.7}},
                            Shaker{0.6, 0.21, 0.3});
  const FlowOptions flow{.method = FlowMethod::kCollocation, .tolerance = 1e-13};
  const State start = swinging(3, 2, 1.5);
  const TangentResult tangent = tangent_flow(system, start, 12.0, flow);
  EXPECT_GE(tangent.events.size(), 3u);
  EXPECT_LT((tangent.monodromy - slopes_of_end(system, start, 12.0, flow)).cwiseAbs().maxCoeff(), 1e-7);
}

}  // namespace
}  // namespace slipmode::dynamics
