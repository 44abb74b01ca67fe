// Words, crossings, symmetry, Floquet modes, guesses: the parts orbits are described by.
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "clearance_systems.hpp"
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"
#include "orbits/branches/internal/branch_tests.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

using dynamics::ContactMode;
using dynamics::Event;
using dynamics::EventKind;
using dynamics::HybridSystem;
using dynamics::State;

Event change(double time, int contact, ContactMode before, ContactMode after) {
  return {.time = time, .contact = contact, .kind = EventKind::kContact, .before = before, .after = after};
}

TEST(Words, DoNotDependOnTheOrigin) {
  const std::vector<Event> events = {change(1.0, 0, ContactMode::kGap, ContactMode::kRightStop),
                                     change(2.0, 0, ContactMode::kRightStop, ContactMode::kRightFlight),
                                     change(3.0, 0, ContactMode::kGap, ContactMode::kLeftStop),
                                     change(4.0, 0, ContactMode::kLeftStop, ContactMode::kLeftFlight)};
  const auto from_gap = regime_sequence(0.0, {ContactMode::kGap}, events);
  EXPECT_EQ(word_of(from_gap), "g l g r");
  const std::vector<Event> later(events.begin() + 1, events.end());
  std::vector<Event> rotated = later;
  rotated.push_back(change(5.0, 0, ContactMode::kGap, ContactMode::kRightStop));
  EXPECT_EQ(word_of(regime_sequence(1.5, {ContactMode::kRightStop}, rotated)), "g l g r");
}

TEST(Words, ContactsThatChangeTogetherMakeOneRegime) {
  const std::vector<Event> events = {change(1.0, 0, ContactMode::kSlipPositive, ContactMode::kStick),
                                     change(1.0, 1, ContactMode::kSlipNegative, ContactMode::kStick),
                                     change(2.0, 1, ContactMode::kStick, ContactMode::kSlipNegative),
                                     change(3.0, 0, ContactMode::kStick, ContactMode::kSlipPositive)};
  const auto spans = regime_sequence(0.0, {ContactMode::kSlipPositive, ContactMode::kSlipNegative}, events);
  ASSERT_EQ(spans.size(), 4u);
  EXPECT_EQ(word_of(spans), "+- 00 0-");
}

TEST(Words, WhatAChangeIsGoesByEachContactAlone) {
  // A pad beside a stop that is never touched, beside one that always is, and the stop's own changes beside the pad's.
  EXPECT_EQ(kind_of_word_change("g+ g0", "g+ g- g0"), SpecialKind::kWordChange);
  EXPECT_EQ(kind_of_word_change("+r 0r", "+r -r 0r"), SpecialKind::kWordChange);
  EXPECT_EQ(kind_of_word_change("g+ g0", "g+"), SpecialKind::kStickChange);
  EXPECT_EQ(kind_of_word_change("g+ g0", "g+ r+ r0 g0"), SpecialKind::kGrazing);
  EXPECT_EQ(kind_of_word_change("g+ g0 r0", "g+ g0 r0 r+"), SpecialKind::kWordChange);  // another order, no other parts
  EXPECT_EQ(kind_of_word_change("+0 -0 --", "+0 -0 -- -0 --"), SpecialKind::kStickChange);
  EXPECT_EQ(kind_of_word_change("x", "+ x"), SpecialKind::kGrazing);
  EXPECT_EQ(kind_of_word_change("0", "+ 0"), SpecialKind::kStickChange);
  EXPECT_EQ(kind_of_word_change("+0", "++"), SpecialKind::kStickChange);
}

TEST(Words, CrossingsAreChangesOfForce) {
  const auto crossings = [](ContactMode first, const std::vector<Event>& events) {
    return crossings_of(regime_sequence(0.0, {first}, events));
  };
  EXPECT_EQ(crossings(ContactMode::kGap, {change(1.0, 0, ContactMode::kGap, ContactMode::kRightStop),
                                          change(2.0, 0, ContactMode::kRightStop, ContactMode::kRightFlight),
                                          change(3.0, 0, ContactMode::kRightFlight, ContactMode::kGap)}),
            2);
  EXPECT_EQ(crossings(ContactMode::kStick, {{.time = 1.0, .contact = 0, .kind = EventKind::kGrazing},
                                            {.time = 1.0, .contact = -1, .kind = EventKind::kDriveCorner}}),
            0);
}

TEST(Words, CrossingsAreThoseOfTheWord) {
  // At the point where sticking is gained it lasts no time: said was "+ -" with four crossings.
  const std::vector<Event> events = {change(1.0, 0, ContactMode::kSlipPositive, ContactMode::kStick),
                                     change(1.0 + 1e-12, 0, ContactMode::kStick, ContactMode::kSlipNegative),
                                     change(2.0, 0, ContactMode::kSlipNegative, ContactMode::kStick),
                                     change(2.0 + 1e-12, 0, ContactMode::kStick, ContactMode::kSlipPositive)};
  const auto regimes = regime_sequence(0.0, {ContactMode::kSlipPositive}, events);
  EXPECT_EQ(word_of(regimes), "+ -");
  EXPECT_EQ(crossings_of(regimes), 2);
}

TEST(Floquet, ModesAreEigenvectorsByDescendingModulus) {
  Eigen::Matrix4d matrix;
  matrix << 0.3, -0.9, 0.2, 0.0, 0.9, 0.3, 0.1, 0.4, 0.0, 0.0, -1.4, 0.2, 0.0, 0.0, 0.0, 0.1;
  const std::vector<FloquetMode> modes = floquet_modes(matrix);
  ASSERT_EQ(modes.size(), 4u);
  double last = 1e9;
  for (const FloquetMode& mode : modes) {
    EXPECT_LE(std::abs(mode.multiplier), last * (1 + 1e-13));
    last = std::abs(mode.multiplier);
    const Eigen::VectorXcd image = matrix.cast<std::complex<double>>() * mode.direction;
    EXPECT_LT((image - mode.multiplier * mode.direction).norm(), 1e-13);
    EXPECT_NEAR(mode.direction.norm(), 1.0, 1e-14);
  }
  EXPECT_NEAR(modes[0].multiplier.real(), -1.4, 1e-14);  // triangular blocks: read off
  EXPECT_GT(modes[1].multiplier.imag(), 0.0);
}

TEST(Floquet, TrivialMultipliersAreNotJudged) {
  PeriodicOrbit orbit;
  orbit.monodromy = Eigen::Vector3d(1.0, -0.5, 0.0).asDiagonal();
  orbit.trivial_multipliers = 1;
  set_stability(orbit, 1e-9);
  EXPECT_EQ(orbit.stability, Stability::kStable);
  EXPECT_DOUBLE_EQ(orbit.leading_modulus, 0.5);
  EXPECT_EQ(orbit.zero_multipliers, 1);
  EXPECT_FALSE(orbit.superstable);
  orbit.trivial_multipliers = 0;
  set_stability(orbit, 1e-9);
  EXPECT_EQ(orbit.stability, Stability::kMarginal);
}

TEST(Floquet, AMultiplierIsZeroInAnyUnitsOrInNone) {
  // Eigenvalues 1e-3 and 1e-4. At 1e12 rad/s velocities are that much larger than displacements, and so is Φ.
  for (const double omega : {1.0, 1e-12, 1e12}) {
    PeriodicOrbit orbit;
    orbit.start = {.q = Eigen::VectorXd::Zero(1), .v = Eigen::VectorXd::Zero(1)};
    orbit.period = 2.0 * std::numbers::pi / omega;
    orbit.monodromy = Eigen::Matrix2d{{1e-3, 1.0 / omega}, {0.0, 1e-4}};
    set_stability(orbit, 1e-9);
    EXPECT_EQ(orbit.zero_multipliers, 0) << omega;
    orbit.monodromy = Eigen::Matrix2d{{1e-3, 0.0}, {omega, 0.0}};
    set_stability(orbit, 1e-9);
    EXPECT_EQ(orbit.zero_multipliers, 1) << omega;
  }
}

TEST(Symmetry, IsLostByLoadsOffsetsAndEvenHarmonics) {
  const Backlash backlash;
  const HybridSystem plain = backlash.system();
  EXPECT_TRUE(is_symmetric(plain));
  EXPECT_TRUE(
      is_symmetric(plain.with_drive(friction::Force{1.0, {{.amplitude = 1.0}, {.amplitude = 0.3, .order = 3}}})));
  EXPECT_FALSE(is_symmetric(plain.with_drive(friction::Force{1.0, {{.amplitude = 0.3, .order = 2}}})));
  friction::Contact contact = plain.contacts()[0];
  contact.offset = 0.1;
  const Eigen::MatrixXd along = plain.force_directions();
  EXPECT_FALSE(is_symmetric(HybridSystem(plain.structure(), {contact}, plain.drive(), {}, along)));
  EXPECT_FALSE(
      is_symmetric(HybridSystem(plain.structure(), plain.contacts(), plain.drive(), Eigen::VectorXd::Ones(1), along)));
  std::get<friction::Clearance>(contact.law).right->gap = 1.1;
  contact.offset = 0.0;
  EXPECT_FALSE(is_symmetric(HybridSystem(plain.structure(), {contact}, plain.drive(), {}, along)));
  EXPECT_FALSE(is_symmetric(fixtures::belt_chain(friction::Coulomb{0.4, 0.2}, friction::Belt::constant(0.1))));
}

TEST(Guesses, NameWhatTheyLack) {
  const HybridSystem chain = fixtures::belt_chain(friction::Coulomb{0.4, 0.2}, friction::Belt::constant(0.1));
  EXPECT_THROW(static_cast<void>(settle_guess(chain, chain.rest(), 10.0)), InvalidInput);  // no period
  EXPECT_THROW(static_cast<void>(recurrence_guess(chain, chain.rest(), 0.0, 1e-3)), NumericalFailure);
  EXPECT_THROW(static_cast<void>(recurrence_guess(chain, chain.rest(), 0.0, -1.0)), InvalidInput);
}

// --- contacts with states of their own
// --------------------------------------------------------------------------------

/// Fourth-order differences of the flow in all coordinates, the contacts' own included.
Eigen::MatrixXd by_differences(const HybridSystem& system, const PeriodicOrbit& orbit, double h) {
  return fixtures::slopes(
      orbit.start, [&](const State& from) { return stacked(advanced(system, from, orbit.period)); }, h);
}

TEST(ContactStates, AShakenContactSpringHasAnOrbit) {
  // The stretch of the contact spring is the third coordinate. Started in stick, where it is free.
  const HybridSystem system = fixtures::oscillator(1.0, 1.0, 0.05, friction::CompliantCoulomb{0.3, 0.3, 6.0}, 1.0,
                                                   friction::Shaker{0.8, 0.11, 0.0});
  State guess = settle_guess(system, system.rest(), 30.0);
  while (guess.modes[0] != ContactMode::kStick) guess = advanced(system, guess, 0.1);
  const PeriodicOrbit orbit = find_orbit(system, guess);
  EXPECT_EQ(orbit.multipliers.size(), 3);
  EXPECT_LT(orbit.residual, 1e-11);
  EXPECT_LE(orbit.iterations, 10);
  EXPECT_THAT(orbit.word, testing::HasSubstr("0"));
  const Eigen::MatrixXd differences = by_differences(system, orbit, 1e-4);
  EXPECT_LT((differences - orbit.monodromy).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_GE(orbit.zero_multipliers, 1);  // sliding forgets the stretch
}

TEST(ContactStates, ABeltUnderAContactSpringHasASelfExcitedOrbit) {
  // A slow belt: the contact spring's ringing after a stick begins must die out before the next slip, or so does the
  // cycle.
  const double speed = 0.01;
  const HybridSystem system = fixtures::oscillator(1.0, 1.0, 0.2, friction::CompliantCoulomb{0.4, 0.2, 2000.0}, 1.0,
                                                   friction::Belt::constant(speed));
  const RecurrenceGuess guess = recurrence_guess(
      system, fixtures::state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, speed)), 100.0, 200.0);
  const PeriodicOrbit orbit = find_orbit(system, guess.state, {.period = guess.period});
  EXPECT_LT((orbit.multipliers.array() - 1.0).abs().minCoeff(), 1e-7);
  EXPECT_EQ(orbit.stability, Stability::kStable);
  EXPECT_LT(orbit.residual, 1e-11);
}

}  // namespace
}  // namespace slipmode::orbits
