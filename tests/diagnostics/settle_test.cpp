#include <slipmode/diagnostics/attractors/settle.hpp>

#include <slipmode/core/errors.hpp>
#include "models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace slipmode::diagnostics {
namespace {

using fixtures::BeltOscillator;

std::vector<double> sorted_slips(const Settled& settled) {
  std::vector<double> x;
  for (const SlipState& slip : settled.slips) x.push_back(slip.displacement);
  std::ranges::sort(x);
  return x;
}

TEST(Settle, FindsTheBeltOscillatorsLimitCycle) {
  // Closed form: fixtures/belt_oscillator.hpp.
  const BeltOscillator o;
  const Settled found = settle(tests::system_of(o), tests::released(o), {.transient = 100.0, .block = 1000.0});
  EXPECT_EQ(found.period.motion, Motion::kPeriodic);
  EXPECT_EQ(found.period.period, 1);
  EXPECT_NEAR(found.period.T, o.period(), 1e-9);
  ASSERT_EQ(found.slips.size(), 1u);
  EXPECT_NEAR(found.slips[0].displacement, o.release_position(), 1e-9);
  EXPECT_EQ(found.time, 1100.0);
  // A block holds a whole number of periods to one: shares are that of the cycle to one period in the block.
  EXPECT_NEAR(found.stick_fraction, o.stick_time() / o.period(), o.period() / 1000.0);
  EXPECT_NEAR(found.slip_rate, 1.0 / o.period(), 1.0 / 1000.0);
  EXPECT_LT(found.audit_residual, 1e-9);
}

TEST(Settle, MeanEnergyIsThatOfTheCycle) {
  // Mean of ½v² + ½kx² over the closed-form cycle, by the midpoint rule with 10⁶ points.
  const BeltOscillator o;
  double mean = 0.0;
  constexpr int kPoints = 1'000'000;
  for (int i = 0; i < kPoints; ++i) {
    const double t = (i + 0.5) / kPoints * o.period();
    mean += 0.5 * (std::pow(o.velocity(t), 2) + o.stiffness * std::pow(o.position(t), 2)) / kPoints;
  }
  const Settled found = settle(tests::system_of(o), tests::released(o), {.block = 1000.0, .energy_samples = 4096});
  // The rectangle rule over a period whose integrand has corners is of second order in 1/4096.
  EXPECT_NEAR(found.mean_energy, mean, 1e-5 * mean);
  const Settled without = settle(tests::system_of(o), tests::released(o), {.block = 1000.0, .energy_samples = 0});
  EXPECT_TRUE(std::isnan(without.mean_energy));
}

struct KnownOrbit {
  double speed;
  int period;
  double T;
  std::vector<double> x10;
};

void PrintTo(const KnownOrbit& orbit, std::ostream* out) { *out << "period " << orbit.period; }

class SettleChain : public testing::TestWithParam<KnownOrbit> {};

TEST_P(SettleChain, FindsTheOrbitsOfAnEventDrivenFixedStepProgram) {
  const KnownOrbit& known = GetParam();
  const dynamics::HybridSystem system = tests::chain10(known.speed);
  const std::map<int, dynamics::State> starts = {
      {1, system.rest()}, {3, tests::near_period_three()}, {5, tests::near_period_five()}};
  const Settled found = settle(system, starts.at(known.period));
  EXPECT_EQ(found.period.motion, Motion::kPeriodic);
  EXPECT_EQ(found.period.period, known.period);
  // The waiting ends when slips repeat to 1e-5 of their reach (13): the motion may be this far from the orbit still.
  EXPECT_NEAR(found.period.T, known.T, 2e-4);
  const std::vector<double> x = sorted_slips(found);
  ASSERT_EQ(x.size(), known.x10.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], known.x10[i], 2e-4);
}

// Origin: datasets/chain10/expected.toml.
INSTANTIATE_TEST_SUITE_P(Chain10, SettleChain,
                         testing::Values(KnownOrbit{0.45, 1, 45.10211, {10.757284}},
                                         KnownOrbit{0.39, 3, 45.18680, {5.58699, 7.72127, 9.06322}},
                                         KnownOrbit{
                                             0.41, 5, 227.26927, {9.18711, 9.72520, 10.86653, 11.09104, 11.46713}}),
                         [](const auto& instance) { return "period" + std::to_string(instance.param.period); });

// A verdict on chaos needs 4 · 64 slips: with a fifth too few the rest is waited for, with half too few it is not.
TEST(Settle, WaitsALittleLongerForTheLastSlipsThatTell) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  SettleOptions options{.transient = 1000.0, .block = 5000.0, .limit = 5000.0};
  const double rate = settle(system, system.rest(), options).slip_rate;
  const auto with = [&](double slips, double patience) {
    options.block = options.limit = slips / rate;
    options.patience = patience;
    return settle(system, system.rest(), options);
  };
  EXPECT_EQ(with(200.0, 0.0).period.motion, Motion::kUndecided);
  const Settled waited = with(200.0, 0.5);
  EXPECT_EQ(waited.period.motion, Motion::kAperiodic);
  EXPECT_DOUBLE_EQ(waited.time, 1000.0 + 1.5 * options.limit);  // a sum of blocks
  const Settled hopeless = with(100.0, 0.5);
  EXPECT_EQ(hopeless.period.motion, Motion::kUndecided);
  EXPECT_DOUBLE_EQ(hopeless.time, 1000.0 + options.limit);
}

TEST(Settle, WaitsOutASlowDecayAndReportsTheShortPeriod) {
  // One of the motions at 0.39 is a period-1 orbit reached so slowly (time constant about 5000) that multiples of the
  // period pass the test for a repeat long before the period itself does.
  const dynamics::HybridSystem system = tests::chain10(0.39);
  Eigen::VectorXd q(10), v(10);
  q << 1.422, 2.819, 4.113, 5.454, 6.892, 8.337, 9.693, 11.001, 12.293, 13.491;
  v << -0.010, -0.094, 0.056, 0.123, -0.111, -0.111, 0.187, 0.141, 0.056, 0.390;
  const dynamics::State start{0.0, q, v, {}};  // in its basin: four other motions coexist
  const Settled found = settle(system, start);
  EXPECT_EQ(found.period.motion, Motion::kPeriodic);
  EXPECT_EQ(found.period.period, 1);
  EXPECT_GT(found.time, 10000.0);
  // Against the same orbit settled a hundred times closer.
  SettleOptions close;
  close.period.tolerance = 1e-7;
  EXPECT_NEAR(found.period.T, settle(system, start, close).period.T, 1e-3);
}

TEST(Settle, CallsChaosAperiodicAtTheLimitAndKeepsTheLastSlips) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const SettleOptions options{.limit = 20000.0, .max_slips = 100};
  const Settled found = settle(system, system.rest(), options);
  EXPECT_EQ(found.period.motion, Motion::kAperiodic);
  EXPECT_EQ(found.time, 21000.0);
  ASSERT_EQ(found.slips.size(), 100u);
  EXPECT_GT(found.slips.back().time, 20900.0);
  EXPECT_TRUE(std::ranges::is_sorted(found.slips, {}, &SlipState::time));
}

TEST(Settle, TellsSteadySlidingAndRestOnAStoppedBelt) {
  // μ_s = μ_k and a dashpot: sliding is stable, nothing ever sticks.
  const auto sliding =
      fixtures::oscillator(1.0, 1.0, 0.1, friction::Coulomb{0.3, 0.3}, 1.0, friction::Belt::constant(1.0));
  const Settled slides = settle(sliding, sliding.rest(), {.transient = 0.0, .block = 500.0});
  EXPECT_EQ(slides.period.motion, Motion::kSliding);
  EXPECT_EQ(slides.stick_fraction, 0.0);
  EXPECT_EQ(slides.time, 500.0);
  EXPECT_NEAR(slides.mean_energy, 0.5 * 0.3 * 0.3, 1e-9);  // at x = μN/k

  const auto stopped =
      fixtures::oscillator(1.0, 1.0, 0.1, friction::Coulomb{0.3, 0.2}, 1.0, friction::Belt::constant(0.0));
  const dynamics::State held{0.0, Eigen::VectorXd::Constant(1, 0.25), Eigen::VectorXd::Zero(1), {}};
  const Settled sticks = settle(stopped, held, {.transient = 0.0, .block = 500.0});
  EXPECT_EQ(sticks.period.motion, Motion::kSticking);
  EXPECT_EQ(sticks.stick_fraction, 1.0);
  EXPECT_EQ(sticks.time, 500.0);
  EXPECT_TRUE(sticks.slips.empty());
}

TEST(Settle, GoesOnWhereAVerySlowBeltSlipsLessThanOncePerBlock) {
  const BeltOscillator o{.belt = 1e-3};  // period about 403
  const Settled found = settle(tests::system_of(o), tests::released(o), {.transient = 0.0, .block = 150.0});
  EXPECT_EQ(found.period.motion, Motion::kPeriodic);
  EXPECT_EQ(found.period.period, 1);
  EXPECT_NEAR(found.period.T, o.period(), 1e-9 * o.period());
}

TEST(Settle, RefusesTimesThatMakeNoSenseAndStopsWhenAsked) {
  const BeltOscillator o;
  const auto run = [&](const SettleOptions& options) {
    (void)settle(tests::system_of(o), tests::released(o), options);
  };
  EXPECT_THROW(run({.block = 0.0}), InvalidInput);
  EXPECT_THROW(run({.transient = -1.0}), InvalidInput);
  EXPECT_THROW(run({.block = 10.0, .limit = 5.0}), InvalidInput);
  EXPECT_THROW(run({.max_slips = 0}), InvalidInput);
  const StopFlag stop = true;
  EXPECT_THROW(run({.stop = &stop}), Interrupted);
}

TEST(Orbit, RepeatsFromEachOfItsSlipStates) {
  const dynamics::HybridSystem system = tests::chain10(0.41);
  SettleOptions options;
  options.period.tolerance = 1e-9;
  const Orbit orbit = settle_to_orbit(system, tests::near_period_five(), options);
  ASSERT_EQ(orbit.period, 5);
  ASSERT_EQ(orbit.states.size(), 5u);
  EXPECT_LT(orbit.mismatch, 1e-8);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(orbit.states[k].q[9], orbit.displacements[k], 1e-12);
    EXPECT_NEAR(orbit.states[k].v[9], 0.41, 1e-12);  // released from the belt's speed
    const dynamics::State after = dynamics::simulate(system, orbit.states[k], {.duration = orbit.T}).final_state;
    EXPECT_LT((after.q - orbit.states[k].q).norm(), 1e-7);
    EXPECT_LT((after.v - orbit.states[k].v).norm(), 1e-7);
  }
}

TEST(Orbit, ChaosHasNoneAndSaysWhatItWas) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  try {
    (void)settle_to_orbit(system, system.rest(), {.limit = 10000.0});
    FAIL() << "expected NumericalFailure";
  } catch (const NumericalFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("aperiodic"), std::string::npos) << failure.what();
  }
}

}  // namespace
}  // namespace slipmode::diagnostics
