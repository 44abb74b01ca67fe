// Orbits with stick and slip against closed forms and against figures of an independent program.
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>
#include <slipmode/orbits/shooting.hpp>
#include "fixtures/belt_oscillator.hpp"
#include "fixtures/den_hartog.hpp"
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

using namespace slipmode::fixtures;
using dynamics::EventKind;
using dynamics::HybridSystem;
using dynamics::State;
using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;

/// The ten-mass chain of S4 with the identified numbers.
HybridSystem chain10(double speed) { return belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(speed)); }

std::vector<double> slip_positions(const PeriodicOrbit& orbit) {
  std::vector<double> result;
  for (const dynamics::Event& e : orbit.events)
    if (e.kind == EventKind::kRelease) result.push_back(e.displacement);
  std::sort(result.begin(), result.end());
  return result;
}

PeriodicOrbit chain_orbit(double speed, const State& start, ShootingOptions options = {}) {
  const HybridSystem system = chain10(speed);
  const RecurrenceGuess guess = recurrence_guess(system, start, 15000.0, 1000.0);
  options.period = guess.period;
  return find_orbit(system, guess.state, options);
}

/// Period and slip states come from an independent fixed-step program, to the digits given.
void expect_chain_orbit(const PeriodicOrbit& orbit, double period, const std::vector<double>& slips) {
  EXPECT_NEAR(orbit.period, period, 6e-6);
  EXPECT_THAT(slip_positions(orbit), testing::Pointwise(testing::DoubleNear(6e-6), slips));
  EXPECT_LE(orbit.iterations, 10);
  EXPECT_LT(orbit.residual, 1e-11);
  EXPECT_EQ(orbit.trivial_multipliers, 1);
  EXPECT_LT((orbit.multipliers.array() - 1.0).abs().minCoeff(), 1e-7);
  EXPECT_EQ(orbit.stability, Stability::kStable);
  EXPECT_GE(orbit.zero_multipliers, 1);  // one entry into stick at least
  EXPECT_EQ(orbit.crossings, static_cast<int>(2 * slips.size()));
}

TEST(FrictionOrbits, AContactThatSticksThroughoutHasTheAmplitudeOfRounding) {
  // Two masses that friction holds together move, and their distance does not: it has no range to be measured by.
  const double omega = 0.6;
  const HybridSystem system(
      fem::chain({.masses = 3, .damping = 0.05}), {{unit(3, 2) - unit(3, 0), Coulomb{0.5, 0.3}, 100.0}},
      friction::Force{omega, {{.amplitude = 1.0, .phase = 0.3}}}, {}, Eigen::MatrixXd(unit(3, 1)));
  const PeriodicOrbit orbit = find_orbit(system, system.rest(), {.period = 2.0 * std::numbers::pi / omega});
  EXPECT_EQ(orbit.word, "0");
  EXPECT_LT(contact_amplitudes(system, orbit)[0].alternating, 1e-13);
  EXPECT_GT(amplitude(system, orbit, unit(3, 0)).alternating, 0.1);
}

TEST(FrictionOrbits, ChainPeriodOne) {
  expect_chain_orbit(chain_orbit(0.45, swinging(10, 3, 0.1)), 45.10211, {10.757284});
}
TEST(FrictionOrbits, ChainPeriodFive) {
  expect_chain_orbit(chain_orbit(0.41, swinging(10, 3, 0.1)), 227.26927,
                     {9.18711, 9.72520, 10.86653, 11.09104, 11.46713});
}
TEST(FrictionOrbits, ChainPeriodThree) {
  expect_chain_orbit(chain_orbit(0.39, swinging(10, 4, 1.0)), 45.18680, {5.58699, 7.72127, 9.06322});
}

TEST(FrictionOrbits, SingleAndMultipleShootingFindTheSameOrbit) {
  const State start = swinging(10, 3, 0.1);
  const PeriodicOrbit single = chain_orbit(0.41, start);
  const PeriodicOrbit multiple = chain_orbit(0.41, start, {.segments = 7});
  EXPECT_NEAR(multiple.period, single.period, 1e-9);
  EXPECT_EQ(multiple.word, single.word);
  EXPECT_LT((stacked(multiple.start) - stacked(single.start)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((multiple.monodromy - single.monodromy).cwiseAbs().maxCoeff(),
            1e-7 * single.monodromy.cwiseAbs().maxCoeff());
}

TEST(FrictionOrbits, AMultipleOfAnOrbitIsHandedBackAsTheOrbit) {
  const HybridSystem system = chain10(0.45);
  const PeriodicOrbit once = chain_orbit(0.45, swinging(10, 3, 0.1));
  const PeriodicOrbit thrice = find_orbit(system, once.start, {.period = 3.0 * once.period});
  EXPECT_NEAR(thrice.period, once.period, 1e-9);
  EXPECT_EQ(thrice.repeats, 1);
}

TEST(FrictionOrbits, UnstableOrbitsOfTheChaoticChainAreRefined) {
  // Close returns in chaos; an orbit is a true one when the flow closes on it and Φ carries its own rate. Which returns
  // are close enough for Newton's method, rounding decides: some of eight stretches have one.
  const HybridSystem system = chain10(0.2);
  int refined = 0;
  for (const double transient : {4000.0, 8000.0, 12000.0, 16000.0, 20000.0, 24000.0, 28000.0, 32000.0}) {
    const RecurrenceGuess guess = recurrence_guess(system, swinging(10, 1, 0.1), transient, 4000.0, 6);
    const ShootingResult found = shoot(system, guess.state, {.period = guess.period, .segments = 4});
    if (!found.converged() || found.orbit.stability != Stability::kUnstable) continue;
    ++refined;
    EXPECT_LT((found.orbit.multipliers.array() - 1.0).abs().minCoeff(), 1e-6);
    const State end = advanced(system, found.orbit.start, found.orbit.period);
    EXPECT_LT((stacked(end) - stacked(found.orbit.start)).cwiseAbs().maxCoeff(), 1e-7);
  }
  EXPECT_GE(refined, 1);
}

// --- one mass on a belt ---------------------------------------------------------------------------------------------

HybridSystem belt_mass(const BeltOscillator& b, double dashpot) {
  return oscillator(b.mass, b.stiffness, dashpot, Coulomb{b.mu_s, b.mu_k}, b.load, Belt::constant(b.belt));
}

TEST(FrictionOrbits, BeltOscillatorClosedForm) {
  const BeltOscillator b{.mass = 1.3, .stiffness = 2.0, .load = 1.5};
  const HybridSystem system = belt_mass(b, 0.0);
  const State guess = state(Eigen::VectorXd::Constant(1, 0.9 * b.position(1.0)), Eigen::VectorXd::Zero(1));
  const PeriodicOrbit orbit = find_orbit(system, guess, {.period = 1.03 * b.period()});
  EXPECT_NEAR(orbit.period, b.period(), 1e-10);
  EXPECT_EQ(orbit.kind, OrbitKind::kSelfExcited);
  ASSERT_EQ(orbit.multipliers.size(), 2);  // 1 along the orbit, 0 across it: stick forgets
  EXPECT_LT(std::abs(orbit.multipliers[0] - 1.0), 1e-9);
  EXPECT_LT(std::abs(orbit.multipliers[1]), 1e-9);
  EXPECT_TRUE(orbit.superstable);
  EXPECT_EQ(orbit.word, "+ 0");
  EXPECT_EQ(orbit.crossings, 2);
  EXPECT_THAT(slip_positions(orbit), testing::ElementsAre(testing::DoubleNear(b.release_position(), 1e-10)));
  // The origin is the middle of the longer of stick and slip.
  const bool stick_is_longer = b.stick_time() > b.slip_time();
  EXPECT_EQ(orbit.start.modes[0],
            stick_is_longer ? dynamics::ContactMode::kStick : dynamics::ContactMode::kSlipPositive);
  EXPECT_NEAR(orbit.start.q[0],
              b.position(stick_is_longer ? b.slip_time() + 0.5 * b.stick_time() : 0.5 * b.slip_time()), 1e-9);
}

TEST(FrictionOrbits, AmplitudesOfTheBeltOscillatorInClosedForm) {
  // Slip is a cosine about the centre, stick a straight line through it: both have the centre as mean.
  const BeltOscillator b;
  const HybridSystem system = belt_mass(b, 0.0);
  const State guess =
      state(Eigen::VectorXd::Constant(1, b.position(1.0)), Eigen::VectorXd::Constant(1, b.velocity(1.0)));
  const PeriodicOrbit orbit = find_orbit(system, guess, {.period = b.period()});
  const Amplitude a = amplitude(system, orbit, Eigen::VectorXd::Ones(1));
  EXPECT_NEAR(a.max, b.centre() + b.amplitude(), 1e-10);
  EXPECT_NEAR(a.min, b.centre() - b.amplitude(), 1e-10);
  EXPECT_NEAR(a.mean, b.centre(), 1e-10);
  const double square =
      b.amplitude() * b.amplitude() * (0.5 * b.slip_time() + std::sin(2 * b.phase()) / (2 * b.omega())) +
      b.drop() * b.drop() / 3.0 * b.stick_time();
  EXPECT_NEAR(a.effective, std::sqrt(square / b.period()), 1e-10);
}

TEST(FrictionOrbits, WithADashpotStickEndsWhereTheSpringLacksItsForce) {
  // In stick λ = k x + c V; it ends at μ_s N: x = (μ_s N − c V)/k.
  const BeltOscillator b{.belt = 0.2};
  const double c = 0.03;
  const HybridSystem system = belt_mass(b, c);
  const RecurrenceGuess guess =
      recurrence_guess(system, state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, b.belt)), 20.0, 60.0);
  const PeriodicOrbit orbit = find_orbit(system, guess.state, {.period = guess.period});
  EXPECT_THAT(slip_positions(orbit),
              testing::ElementsAre(testing::DoubleNear((b.mu_s * b.load - c * b.belt) / b.stiffness, 1e-10)));
}

TEST(FrictionOrbits, SteadySlidingIsNoOrbit) {
  const BeltOscillator b{.belt = 3.0};
  const ShootingResult result =
      shoot(belt_mass(b, 0.5), state(Eigen::VectorXd::Constant(1, 0.5), Eigen::VectorXd::Zero(1)), {.period = 6.0});
  EXPECT_EQ(result.status, ShootingStatus::kPeriodLost);
  EXPECT_THAT(result.message, testing::HasSubstr("equilibrium"));
}

// --- Den Hartog -----------------------------------------------------------------------------------------------------

HybridSystem shaken_mass(const DenHartog& d, double mu_s_over_mu_k = 1.0) {
  return oscillator(d.mass, d.stiffness, 0.0, Coulomb{d.friction * mu_s_over_mu_k, d.friction}, 1.0, d.shaker());
}

/// (x, ẋ) → −(x, ẋ) half a period on, x = q − d: free rotation times the saltation of the turning point, where the
/// acceleration jumps from (−k x₀ + P sin ψ − F)/m to (… + F)/m, P = A(mω² − k).
Eigen::Matrix2d den_hartog_half_map(const DenHartog& d) {
  const double omega = std::sqrt(d.stiffness / d.mass), angle = std::numbers::pi / d.ratio;
  const double pull = -d.stiffness * d.amplitude() +
                      d.base * (d.mass * d.omega() * d.omega() - d.stiffness) * std::sin(d.shaker().phase);
  Eigen::Matrix2d rotation;
  rotation << std::cos(angle), std::sin(angle) / omega, -omega * std::sin(angle), std::cos(angle);
  return -rotation * Eigen::Vector2d(1.0, (pull + d.friction) / (pull - d.friction)).asDiagonal();
}

TEST(FrictionOrbits, AMotionThatSettlesIsWatchedUntilItComesBack) {
  const HybridSystem system = chain10(0.45);
  const RecurrenceGuess guess = recurrence_guess(system, swinging(10, 3, 0.1), 0.0, 1000.0, 1);
  EXPECT_LT(guess.mismatch, 1e-3);
  EXPECT_GT(guess.state.time, 1000.0) << "not yet in the first stretch";
  EXPECT_NEAR(guess.period, 45.10211, 0.1);  // the period that expect_chain_orbit has of the independent program
}

TEST(FrictionOrbits, TheSectionIsOfWhateverContactComesBack) {
  // The motion of a chain on a belt, whichever of its contacts is named first; a stop that is never met, a tanh law.
  const auto chain = [](bool swapped) {
    const HybridSystem belt = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2), 3);
    std::vector<friction::Contact> contacts = belt.contacts();
    friction::Contact stop = contacts[0], smooth = contacts[0];
    stop.law = friction::Clearance{friction::Stop{.stiffness = 10.0, .gap = 1e3}, std::nullopt};
    smooth.law = friction::TanhRegularised{.mu_s = 1e-3, .mu_k = 1e-3, .alpha = 0.0, .epsilon = 0.1};
    smooth.direction = unit(3, 0);
    contacts.insert(swapped ? contacts.begin() : contacts.end(), {stop, smooth});
    return HybridSystem(belt.structure(), contacts, belt.drive());
  };
  const RecurrenceGuess last = recurrence_guess(chain(true), swinging(3, 2, 0.1), 2000.0, 500.0);
  const RecurrenceGuess first = recurrence_guess(chain(false), swinging(3, 2, 0.1), 2000.0, 500.0);
  EXPECT_NEAR(last.period, first.period, 1e-9);
  EXPECT_LT(last.mismatch, 1e-4);
}

TEST(FrictionOrbits, ACycleWithoutEventsIsFoundByItsSwing) {
  // A tanh law that falls with the speed: the cycle never reaches the belt's speed.
  const HybridSystem system = fixtures::oscillator(
      1.0, 1.0, 0.05, friction::TanhRegularised{.mu_s = 0.4, .mu_k = 0.2, .alpha = 3.0, .epsilon = 0.1}, 1.0,
      Belt::constant(0.55));
  const RecurrenceGuess guess =
      recurrence_guess(system, state(Eigen::VectorXd::Constant(1, 0.6), Eigen::VectorXd::Zero(1)), 400.0, 100.0);
  const PeriodicOrbit orbit = find_orbit(system, guess.state, {.period = guess.period});
  EXPECT_EQ(orbit.crossings, 0);
  EXPECT_NEAR(orbit.period, guess.period, 1e-3);
  EXPECT_EQ(orbit.stability, Stability::kStable);
}

TEST(FrictionOrbits, DenHartogSliding) {
  const DenHartog d;
  const HybridSystem system = shaken_mass(d);
  State guess = settle_guess(system, system.rest(), 40.25);  // undamped but for friction: near, not settled
  for (const bool half : {false, true}) {
    const PeriodicOrbit orbit = find_orbit(system, guess, {.half_period = half});
    EXPECT_EQ(orbit.kind, OrbitKind::kDriven);
    EXPECT_TRUE(orbit.symmetric);
    EXPECT_EQ(orbit.word, "+ -");
    ASSERT_EQ(orbit.events.size(), 2u);
    for (const dynamics::Event& e : orbit.events) {
      EXPECT_EQ(e.kind, EventKind::kReversal);
      EXPECT_NEAR(std::abs(e.displacement - system.drive().shaker()->displacement(e.time)), d.amplitude(), 1e-9);
    }
    const Eigen::VectorXcd expected = sorted_eigenvalues(den_hartog_half_map(d));
    for (Eigen::Index i = 0; i < 2; ++i) {
      const double distance = (orbit.multipliers.array() - expected[i] * expected[i]).abs().minCoeff();
      EXPECT_LT(distance, 1e-8);
      if (!half) continue;
      EXPECT_LT((orbit.half_multipliers.array() - expected[i]).abs().minCoeff(), 1e-8);
    }
  }
}

TEST(FrictionOrbits, ShakenWithStopsKeepsOneMultiplier) {
  // Two stops per cycle. Stick leaves one direction; the other multiplier is compared with differences of the flow.
  const HybridSystem system = shaken_mass(DenHartog{}).with_drive(friction::Shaker{0.9, 0.05, 0.3});
  const PeriodicOrbit orbit = find_orbit(system, settle_guess(system, system.rest(), 30.0));
  EXPECT_THAT(orbit.word, testing::HasSubstr("0"));
  EXPECT_GE(orbit.zero_multipliers, 1);
  const auto end_of = [&](State from) {
    from.modes.clear();
    return stacked(advanced(system, from, orbit.period));
  };
  EXPECT_LT((fixtures::slopes(orbit.start, end_of, 1e-5, 2) - orbit.monodromy).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(FrictionOrbits, BadInputIsNamed) {
  const HybridSystem chain = chain10(0.45);
  EXPECT_THROW(static_cast<void>(shoot(chain, chain.rest())), InvalidInput);  // no period
  EXPECT_THROW(static_cast<void>(shoot(chain, chain.rest(), {.period = 45.0, .segments = 0})), InvalidInput);
  EXPECT_THROW(static_cast<void>(shoot(chain, chain.rest(), {.period = 45.0, .half_period = true})), InvalidInput);
  const HybridSystem shaken = shaken_mass(DenHartog{});
  try {
    static_cast<void>(shoot(shaken, shaken.rest(), {.period = 1.0}));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("order × the drive's"));
  }
}

TEST(FrictionOrbits, AFailedSearchSaysHowFarItCame) {
  const HybridSystem system = chain10(0.2);
  const ShootingResult result = shoot(system, swinging(10, 5, 2.0), {.period = 20.0, .max_iterations = 2});
  ASSERT_FALSE(result.converged());
  EXPECT_THAT(result.message, testing::HasSubstr("residual"));
  EXPECT_EQ(result.orbit.residuals.size(), static_cast<std::size_t>(result.orbit.iterations) + 1);
  EXPECT_LE(result.orbit.residuals.back(), result.orbit.residuals.front());
  EXPECT_THROW(static_cast<void>(find_orbit(system, swinging(10, 5, 2.0), {.period = 20.0, .max_iterations = 2})),
               NumericalFailure);
}

}  // namespace
}  // namespace slipmode::orbits
