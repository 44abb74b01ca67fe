#include <slipmode/diagnostics/exponents/lyapunov.hpp>

#include <slipmode/core/errors.hpp>
#include "models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

TEST(Benettin, LogisticMapGivesLogTwo) {
  // x → 4x(1−x) is conjugate to the tent map of slope 2 everywhere.
  const auto logistic = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return (4.0 * x.array() * (1.0 - x.array())).matrix();
  };
  const LyapunovExponent found =
      benettin(logistic, Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Ones(1), 100'000, 1.0, 1e-9);
  EXPECT_NEAR(found.nats, std::numbers::ln2, 4.0 * found.error);
  EXPECT_LT(found.error, 5e-3);
  EXPECT_DOUBLE_EQ(found.bits, found.nats / std::numbers::ln2);
  EXPECT_EQ(found.renormalisations, 100'000);
}

TEST(Benettin, HenonMapGivesThePublishedExponent) {
  // a = 1.4, b = 0.3: 0.41922 per iteration (Sprott, Chaos and Time-Series Analysis, 2003, appendix A).
  const auto henon = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return Eigen::Vector2d(1.0 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0]);
  };
  const LyapunovExponent found =
      benettin(henon, Eigen::Vector2d(0.1, 0.1), Eigen::Vector2d(1.0, 0.0), 200'000, 1.0, 1e-8);
  EXPECT_NEAR(found.nats, 0.41922, 4.0 * found.error);
  EXPECT_LT(found.error, 2e-3);
}

TEST(Benettin, LinearMapGivesItsLargestEigenvaluePerUnitOfTime) {
  Eigen::Matrix2d A;
  A << 1.5, 1.0, 0.0, 0.25;
  const auto linear = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return A * x; };
  // A step stands for 0.5 units of time. The direction turns to the eigenvector within a few steps: O(1/steps) left.
  const LyapunovExponent found = benettin(linear, Eigen::Vector2d::Zero(), Eigen::Vector2d(0.0, 1.0), 2000, 0.5, 1e-6);
  EXPECT_NEAR(found.nats, std::log(1.5) / 0.5, 5e-3);
}

TEST(Benettin, RefusesNoDirectionAndNoSteps) {
  const auto same = [](const Eigen::VectorXd& x) { return x; };
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  EXPECT_THROW((void)benettin(same, one, Eigen::VectorXd::Zero(1), 10, 1.0, 1e-6), InvalidInput);
  EXPECT_THROW((void)benettin(same, one, Eigen::VectorXd::Ones(2), 10, 1.0, 1e-6), InvalidInput);
  EXPECT_THROW((void)benettin(same, one, one, 0, 1.0, 1e-6), InvalidInput);
  EXPECT_THROW((void)benettin(same, one, one, 10, 0.0, 1e-6), InvalidInput);
}

TEST(LargestExponent, OfALinearStructureIsItsSlowestDecay) {
  // No contact: distances decay with the least damped mode, ζω = ½ c ω₁², ω₁ = 2 sin(π/42).
  const dynamics::HybridSystem chain(fem::chain({.masses = 10, .damping = 0.3}), {}, friction::Belt::constant(0.0));
  dynamics::State start = chain.rest();
  start.q.setOnes();
  const double omega = 2.0 * std::sin(std::numbers::pi / 42.0);
  const LyapunovExponent found =
      largest_exponent(chain, start, {.transient = 500.0, .duration = 20000.0, .interval = 50.0});
  // The higher modes die within a few hundred units; the energy norm ripples by a factor bounded for all time.
  EXPECT_NEAR(found.nats, -0.5 * 0.3 * omega * omega, 2e-4);
}

TEST(LargestExponent, OfAPeriodicOrbitIsZero) {
  // A shift along the orbit neither grows nor shrinks: the sum of logs stays bounded, so the mean falls like 1/T.
  const dynamics::HybridSystem system = tests::chain10(0.45);
  const LyapunovExponent found = largest_exponent(system, system.rest(), {.transient = 20000.0, .duration = 20000.0});
  EXPECT_NEAR(found.nats, 0.0, 2e-4);
}

TEST(LargestExponent, OfTheChaoticChainIsThatOfItsTangentFlow) {
  // The same growth by an independent road: products of fundamental matrices with saltation, no finite differences.
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const dynamics::FlowOptions flow{.audit = false};
  const dynamics::State start = dynamics::simulate(system, system.rest(), {.duration = 5000.0}).final_state;
  constexpr double kStep = 20.0;
  constexpr int kSteps = 40;  // 800 units: rounding grows to 1e-10 on the way, so both follow one trajectory
  const Eigen::Index n = system.size();

  const auto step = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const dynamics::State begin{0.0, x.head(n), x.tail(n), {}};
    const dynamics::State end = dynamics::simulate(system, begin, {.duration = kStep, .flow = flow}).final_state;
    Eigen::VectorXd y(2 * n);
    y << end.q, end.v;
    return y;
  };
  Eigen::VectorXd x(2 * n);
  x << start.q, start.v;
  Eigen::VectorXd direction = Eigen::VectorXd::Ones(2 * n);
  direction[2 * n - 1] = 0.0;  // the driven mass may be stuck
  const LyapunovExponent found = benettin(step, x, direction, kSteps, kStep, 1e-7);

  dynamics::State state = start;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const dynamics::TangentResult part = dynamics::tangent_flow(system, {0.0, state.q, state.v, {}}, kStep, flow);
    direction = part.monodromy * direction.normalized();
    sum += std::log(direction.norm());
    state = part.end;
  }
  // Second-order terms of a separation of 1e-7, per unit of time.
  EXPECT_NEAR(found.nats, sum / (kSteps * kStep), 1e-5);
  EXPECT_GT(found.nats, 0.0);
}

TEST(LargestExponent, DoesNotDependOnTheUnitOfForce) {
  // Mass, damping, stiffness and load times a power of two: the same motion, every rounding of it the same.
  const auto exponent_in = [](double unit) {
    const fem::ChainOptions chain = {.masses = 10, .mass = {unit}, .stiffness = {unit}, .damping = 0.006};
    const dynamics::HybridSystem system(fem::chain(chain),
                                        {{fixtures::unit(10, 9), friction::Stribeck{0.4, 0.2, 8.0}, 3.0 * unit}},
                                        friction::Belt::constant(0.2));
    return largest_exponent(system, system.rest(), {.transient = 500.0, .duration = 1000.0});
  };
  const LyapunovExponent one = exponent_in(1.0);
  EXPECT_GT(one.nats, 0.0);
  for (const double unit : {0x1p-40, 0x1p+60}) {
    EXPECT_EQ(exponent_in(unit).nats, one.nats) << unit;
    EXPECT_EQ(exponent_in(unit).error, one.error) << unit;
  }
}

TEST(LargestExponent, RefusesTimesThatMakeNoSense) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const dynamics::State rest = system.rest();
  EXPECT_THROW((void)largest_exponent(system, rest, {.transient = -1.0}), InvalidInput);
  EXPECT_THROW((void)largest_exponent(system, rest, {.duration = 10.0, .interval = 20.0}), InvalidInput);
  EXPECT_THROW((void)largest_exponent(system, rest, {.separation = 0.0}), InvalidInput);
  const StopFlag stop = true;
  EXPECT_THROW((void)largest_exponent(system, rest, {.transient = 0.0, .stop = &stop}), Interrupted);
}

}  // namespace
}  // namespace slipmode::diagnostics
