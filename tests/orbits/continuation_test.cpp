// Branches and their special points against closed forms, against orbits found one by one, and against S0 and S1.
#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/orbits/floquet.hpp>
#include <slipmode/orbits/gap_motion.hpp>
#include "clearance_systems.hpp"
#include "fixtures/belt_oscillator.hpp"
#include "fixtures/den_hartog.hpp"
#include "fixtures/scenes.hpp"
#include "special_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::State;

/// S0's single mass from ω = 1.2, where only the large orbit is stable.
Branch backlash_branch(int direction, double to, friction::ContactLoss loss = friction::ContactLoss::kZeroForce) {
  const HybridSystem base = Backlash{.omega = 1.2, .loss = loss}.system();
  return continue_orbit(over_frequency(base), settled(base, -2.0), 1.2,
                        {.from = 0.3, .to = to, .direction = direction, .max_points = 400});
}

// --- smooth ---------------------------------------------------------------------------------------------------------

TEST(Continuation, FollowsTheResonanceCurveOfALinearOscillator) {
  const double c = 0.1, k = 2.0;
  const HybridSystem base = far_from_stops(c, k, 0.8);
  for (const bool arclength : {true, false}) {
    const Branch branch = continue_orbit(over_frequency(base), find_orbit(base, base.rest()), 0.8,
                                         {.from = 0.5, .to = 2.5, .arclength = arclength});
    EXPECT_EQ(branch.end, BranchEnd::kRange);
    EXPECT_DOUBLE_EQ(branch.points.back().parameter, 2.5);
    EXPECT_TRUE(branch.special.empty());
    for (const BranchPoint& point : branch.points) {
      const double omega = point.parameter;
      const double size = 1.0 / std::hypot(k - omega * omega, c * omega),
                   lag = std::atan2(c * omega, k - omega * omega);
      EXPECT_NEAR(point.orbit.start.q[0], size * std::sin(omega * point.orbit.start.time - lag), 1e-9 * size);
    }
  }
}

TEST(Continuation, PassesTheOwnFrequencyOfPlayWithoutDamping) {
  // Nothing is lost, so both multipliers stay on the circle, and no torus is born; the motion grows with the frequency.
  const friction::Stop stop{.stiffness = 4.0, .gap = 1.0};
  const HybridSystem base(fem::masses({.links = {{.stiffness = 1.0}}}),
                          {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop}}}, Backlash::drive(0.3, 1.0), {},
                          Eigen::MatrixXd::Ones(1, 1));
  State guess = base.rest();
  guess.v[0] = 1.2;
  const Branch branch = continue_orbit(over_frequency(base), find_orbit(base, guess), 1.0, {.from = 0.9, .to = 1.1});
  EXPECT_EQ(branch.end, BranchEnd::kRange);
  EXPECT_TRUE(branch.special.empty());
  EXPECT_GT(branch.points.size(), 5U);
  for (const BranchPoint& point : branch.points)
    for (const std::complex<double>& mu : point.orbit.multipliers) EXPECT_NEAR(std::abs(mu), 1.0, 1e-10);
}

TEST(Continuation, FollowsASelfExcitedOrbitInClosedForm) {
  // Belt oscillator without dashpot: period and release position over the belt's speed.
  const fixtures::BeltOscillator at_start;
  const auto system_at = [&](double speed) {
    return fixtures::oscillator(1.0, 1.0, 0.0, friction::Coulomb{0.4, 0.2}, 1.0, friction::Belt::constant(speed));
  };
  const State guess = fixtures::state(Eigen::VectorXd::Constant(1, at_start.position(1.0)),
                                      Eigen::VectorXd::Constant(1, at_start.velocity(1.0)));
  const PeriodicOrbit first = find_orbit(system_at(0.1), guess, {.period = at_start.period()});
  const Branch branch =
      continue_orbit(system_at, first, 0.1, {.from = 0.02, .to = 0.6, .direction = -1, .both_ways = true});
  EXPECT_GT(branch.points.size(), 10u);
  EXPECT_NEAR(std::abs(branch.points.front().parameter - branch.points.back().parameter), 0.58, 1e-12);
  for (const BranchPoint& point : branch.points) {
    const fixtures::BeltOscillator here{.belt = point.parameter};
    EXPECT_NEAR(point.orbit.period, here.period(), 1e-8 * here.period());
    EXPECT_TRUE(point.orbit.superstable);
  }
}

TEST(Continuation, KeepsWhatWasFoundWhereTheFamilyIsStopped) {
  const HybridSystem base = Backlash{.omega = 1.2}.system();
  const dynamics::SystemFamily family = over_frequency(base);
  const PeriodicOrbit first = find_orbit(base, settle_guess(base, base.rest(), 50.0));
  const ContinuationOptions options{.from = 1.1, .to = 1.4, .both_ways = true};
  const Branch whole = continue_orbit(family, first, 1.2, {.from = 1.1, .to = 1.4});
  int left = 0;
  const dynamics::SystemFamily stopped = [&](double omega) {
    if (left-- == 0) throw Interrupted();
    return family(omega);
  };
  std::size_t before = 0;
  for (const int after : {20, 60, 100}) {
    left = after;
    const Branch branch = continue_orbit(stopped, first, 1.2, options);
    EXPECT_EQ(branch.end, BranchEnd::kInterrupted) << branch.reason;
    ASSERT_GT(branch.points.size(), before);  // one way alone: the other one is not begun
    before = branch.points.size();
    ASSERT_LT(before, whole.points.size());
    for (std::size_t k = 0; k < before; ++k) EXPECT_EQ(branch.points[k].parameter, whole.points[k].parameter);
  }
  left = 0;
  EXPECT_THROW((void)continue_orbit(stopped, first, 1.2, options), Interrupted);
}

TEST(Continuation, ChainOverBeltSpeedArrivesAtTheOrbitFoundThere) {
  const auto chain = [](double speed) {
    return fixtures::belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, friction::Belt::constant(speed));
  };
  const RecurrenceGuess guess = recurrence_guess(chain(0.45), fixtures::swinging(10, 3, 0.1), 15000.0, 500.0);
  const PeriodicOrbit first = find_orbit(chain(0.45), guess.state, {.period = guess.period});
  const Branch branch = continue_orbit(chain, first, 0.45, {.from = 0.45, .to = 0.46, .step = 0.1, .max_step = 0.3});
  ASSERT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  const PeriodicOrbit& last = branch.points.back().orbit;
  const PeriodicOrbit there = find_orbit(chain(0.46), last.start, {.period = 1.001 * last.period});
  EXPECT_NEAR(last.period, there.period, 1e-8);
  EXPECT_NEAR(last.leading_modulus, there.leading_modulus, 1e-6);
}

// --- special points -------------------------------------------------------------------------------------------------

TEST(Continuation, FoldsOfS0) {
  // Printed: near 1.42 and near 1. At a fold Φ has a multiplier 1, and there is no orbit beyond.
  const Branch branch = backlash_branch(+1, 1.6);
  const std::vector<SpecialPoint> folds = of_kind(branch, SpecialKind::kFold);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_NEAR(folds[0].parameter, 1.42, 0.005);
  EXPECT_NEAR(folds[1].parameter, 1.0, 0.005);
  EXPECT_LT(folds[0].uncertainty, 1e-8);
  EXPECT_LT((folds[0].orbit.multipliers.array() - 1.0).abs().minCoeff(), 1e-5);
  const auto four_crossings_at = [&](double omega) {
    const ShootingResult result = shoot(Backlash{.omega = omega}.system(), folds[0].orbit.start, {.half_period = true});
    return result.converged() && result.orbit.crossings == 4;
  };
  EXPECT_TRUE(four_crossings_at(folds[0].parameter - 1e-7));
  EXPECT_FALSE(four_crossings_at(folds[0].parameter + 1e-7));
}

TEST(Continuation, TheOtherLossOfContactMovesTheFoldBelowOrbitsBAndC) {
  const std::vector<SpecialPoint> folds =
      of_kind(backlash_branch(+1, 1.6, friction::ContactLoss::kGap), SpecialKind::kFold);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_LT(folds[0].parameter, 1.4);
}

TEST(Continuation, GrazingOfFloatingOrbitsInClosedForm) {
  // In the gap the amplitude is A/(ω √(ω² + c²)): the stops are reached where it is 1. Orbits in the gap are followed
  // although each is one of a family.
  const Branch branch = backlash_branch(+1, 1.6);
  const std::vector<SpecialPoint> grazings = of_kind(branch, SpecialKind::kGrazing);
  ASSERT_EQ(grazings.size(), 1u);
  const double c2 = 0.05 * 0.05;
  EXPECT_NEAR(grazings[0].parameter, std::sqrt(0.5 * (std::sqrt(c2 * c2 + 4.0) - c2)), 1e-8);
  EXPECT_THAT(grazings[0].note, testing::HasSubstr("\"g\""));
  EXPECT_EQ(branch.points.back().orbit.family.cols(), 1);
}

// Started aside in the gap the branch goes on in its middle, where stops leave most room: both are met at once, and it
// leads on to orbit B of S0 (Table 4.1, an independent computation agrees). Aside it would creep along one stop for
// ever.
TEST(Continuation, AFloatingOrbitAsideLeadsOverBothStopsToOrbitB) {
  const HybridSystem base = Backlash{.omega = 1.4}.system();
  State aside = linear_response(base);
  aside.q(0) += 0.2;
  const PeriodicOrbit orbit = find_orbit(base, aside);
  ASSERT_EQ(orbit.word, "g");
  const Branch branch = continue_orbit(over_frequency(base), orbit, 1.4, {.from = 0.9, .to = 1.4, .direction = -1});
  ASSERT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  const std::vector<SpecialPoint> grazings = of_kind(branch, SpecialKind::kGrazing);
  ASSERT_EQ(grazings.size(), 1u);
  const double c2 = 0.05 * 0.05;
  EXPECT_NEAR(grazings[0].parameter, std::sqrt(0.5 * (std::sqrt(c2 * c2 + 4.0) - c2)), 1e-8);
  const PeriodicOrbit& last = branch.points.back().orbit;
  EXPECT_EQ(last.crossings, 4);
  EXPECT_NEAR(last.multipliers(0).real(), 1.4210, 5e-5);
  EXPECT_NEAR(last.multipliers(1).real(), 0.1482, 5e-5);
}

TEST(Continuation, FloatingOrbitsHaveNoSymmetryToLose) {
  // Up to the stops the float's half-period multiplier −1 belongs to its family, however little room there is.
  const HybridSystem base = four_masses(1.3);
  State guess = base.rest();
  const PeriodicOrbit orbit = find_orbit(base, guess, {.half_period = true});
  ASSERT_EQ(orbit.word, "g");
  const Branch branch =
      continue_orbit(over_frequency(base), orbit, 1.3, {.from = 1.1, .to = 1.4, .direction = -1, .max_points = 60});
  EXPECT_EQ(of_kind(branch, SpecialKind::kGrazing).size(), 1u);
  EXPECT_TRUE(of_kind(branch, SpecialKind::kSymmetryBreaking).empty());
}

TEST(Continuation, GrazingOfTheOscillatorWithPlayInClosedForm) {
  // S2: √(ω⁴ + 4ξ²ω²) = 1.00080 for ξ = 0.02, ω = 1; the text's 1.00330 is wrong.
  const HybridSystem base = play(0.02, 1.0833, 1.0);
  const auto over_amplitude = [&](double a) {
    return base.with_drive(friction::Force{1.0, {{.amplitude = a, .phase = std::numbers::pi / 2.0}}});
  };
  const PeriodicOrbit orbit = find_orbit(base, settle_guess(base, base.rest(), 400.0));
  const Branch branch = continue_orbit(over_amplitude, orbit, 1.0833, {.from = 0.9, .to = 1.3, .direction = -1});
  const std::vector<SpecialPoint> grazings = of_kind(branch, SpecialKind::kGrazing);
  ASSERT_EQ(grazings.size(), 1u);
  EXPECT_NEAR(grazings[0].parameter, std::sqrt(1.0 + 4.0 * 0.02 * 0.02), 1e-8);
}

/// Where a half-period multiplier is −1, by Illinois' rule over orbits found one by one.
double symmetry_breaking_between(double low, double high) {
  const auto excess = [](double omega) {
    const HybridSystem system = Backlash{.omega = omega}.system();
    const PeriodicOrbit orbit = settled(system, 0.0, {.half_period = true});
    return 1.0 + orbit.half_multipliers.real().minCoeff();
  };
  double at_low = excess(low), at_high = excess(high);
  for (int k = 0; k < 60 && high - low > 1e-11; ++k) {
    const double middle = high - at_high * (high - low) / (at_high - at_low), here = excess(middle);
    if ((here < 0) == (at_low < 0)) {
      low = middle, at_low = here, at_high *= 0.5;
    } else {
      high = middle, at_high = here, at_low *= 0.5;
    }
  }
  return 0.5 * (low + high);
}

TEST(Continuation, SymmetryBreakingOfS0) {
  // Printed: near 0.7.
  const std::vector<SpecialPoint> found = of_kind(backlash_branch(-1, 1.3), SpecialKind::kSymmetryBreaking);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].parameter, 0.7, 0.005);
  EXPECT_NEAR(found[0].parameter, symmetry_breaking_between(0.68, 0.72), 1e-8);
  EXPECT_NEAR(found[0].multiplier.real(), -1.0, 1e-6);
}

TEST(Continuation, SwitchesToAsymmetricOrbits) {
  const HybridSystem base = Backlash{.omega = 1.2}.system();
  const SpecialPoint breaking = of_kind(backlash_branch(-1, 1.3), SpecialKind::kSymmetryBreaking).front();
  ContinuationOptions options{.from = 0.5, .to = 1.3, .direction = -1};
  const std::vector<BranchPoint> sides = switch_branch(over_frequency(base), breaking, options);
  ASSERT_EQ(sides.size(), 2u);
  for (const BranchPoint& side : sides) {
    EXPECT_FALSE(side.orbit.symmetric);
    EXPECT_LT(side.parameter, breaking.parameter);  // supercritical: stable orbits below
    EXPECT_EQ(side.orbit.stability, Stability::kStable);
  }
  // Mirror images: the same multipliers. A pitchfork: parameter ~ asymmetry².
  EXPECT_NEAR(sides[0].orbit.leading_modulus, sides[1].orbit.leading_modulus, 2e-3);
  const std::vector<BranchPoint> nearer = switch_branch(over_frequency(base), breaking, options, 0.01);
  EXPECT_NEAR((breaking.parameter - sides[0].parameter) / (breaking.parameter - nearer[0].parameter), 4.0, 0.4);
  // S0: the asymmetric branch turns unstable above the window without stable solutions, 0.54.
  const Branch branch = continue_orbit(over_frequency(base), sides[0].orbit, sides[0].parameter, options);
  const std::vector<SpecialPoint> doublings = of_kind(branch, SpecialKind::kPeriodDoubling);
  ASSERT_EQ(doublings.size(), 2u);
  EXPECT_NEAR(doublings[1].parameter, 0.54, 0.005);
}

TEST(Continuation, AnAsymmetricBranchEndsWhereTheSymmetricOneBreaks) {
  // Both branches locate the point in their own way: by a multiplier −1 of the half-period map, by the asymmetry.
  const HybridSystem base = Backlash{.omega = 1.2}.system();
  const std::vector<SpecialPoint> breakings = of_kind(backlash_branch(-1, 1.3), SpecialKind::kSymmetryBreaking);
  ASSERT_GE(breakings.size(), 2u);
  const ContinuationOptions options{.from = 0.3, .to = 1.3, .direction = -1, .max_points = 300};
  const BranchPoint side = switch_branch(over_frequency(base), breakings[0], options).front();
  const Branch branch = continue_orbit(over_frequency(base), side.orbit, side.parameter, options);
  EXPECT_EQ(branch.end, BranchEnd::kMerged) << branch.reason;
  const std::vector<SpecialPoint> met = of_kind(branch, SpecialKind::kSymmetryBreaking);
  ASSERT_EQ(met.size(), 1u);
  EXPECT_NEAR(met[0].parameter, breakings[1].parameter, 1e-8);
}

TEST(Continuation, SwitchesToTwiceThePeriod) {
  const HybridSystem base = Backlash{.omega = 0.65}.system();
  const Branch branch =
      continue_orbit(over_frequency(base), settled(base, 0.0), 0.65, {.from = 0.616, .to = 0.68, .direction = -1});
  const std::vector<SpecialPoint> doublings = of_kind(branch, SpecialKind::kPeriodDoubling);
  ASSERT_EQ(doublings.size(), 1u);
  EXPECT_NEAR(doublings[0].multiplier.real(), -1.0, 1e-6);
  const std::vector<BranchPoint> beside = switch_branch(over_frequency(base), doublings[0], {.from = 0.6, .to = 0.68});
  ASSERT_EQ(beside.size(), 1u);
  EXPECT_EQ(beside[0].orbit.order, 2);
  EXPECT_EQ(beside[0].orbit.repeats, 1);
  // The orbit closes after two periods of the drive and not after one.
  const HybridSystem there = base.with_drive(Backlash::drive(1.0, beside[0].parameter));
  const State half = advanced(there, beside[0].orbit.start, 0.5 * beside[0].orbit.period);
  const State whole = advanced(there, beside[0].orbit.start, beside[0].orbit.period);
  EXPECT_GT((stacked(half) - stacked(beside[0].orbit.start)).norm(), 1e-3);
  EXPECT_LT((stacked(whole) - stacked(beside[0].orbit.start)).norm(), 1e-9);
}

TEST(Continuation, SymmetryBreakingOfFourMasses) {
  // Printed: 0.98 on the main peak (with c_s = 0.5; Table 2.2's 0.05 would give 0.996). The asymmetric orbit at 0.93 is
  // the one that settles (clearance_orbits_test).
  const HybridSystem base = four_masses(1.05);
  State start = base.rest();
  start.q << 0.0, 0.0, 2.0, 2.0;
  const PeriodicOrbit orbit = find_orbit(base, settle_guess(base, start, 300.0));
  const Branch branch = continue_orbit(over_frequency(base), orbit, 1.05, {.from = 0.93, .to = 1.1, .direction = -1});
  const std::vector<SpecialPoint> breakings = of_kind(branch, SpecialKind::kSymmetryBreaking);
  ASSERT_EQ(breakings.size(), 1u);
  EXPECT_NEAR(breakings[0].parameter, 0.98, 0.0005);
  EXPECT_EQ(branch.points.back().orbit.stability, Stability::kUnstable);
  EXPECT_TRUE(branch.points.back().orbit.symmetric);
}

TEST(Continuation, NeimarkSackerBoundsTheNonPeriodicBandOfS1) {
  // Printed: no periodic motion for 0.77 < η < 0.94.
  const HybridSystem base = three_masses(1.0);
  const auto over_eta = [&](double eta) {
    return base.with_drive(friction::Force{eta, {{.amplitude = 1.0, .phase = std::numbers::pi / 2.0}}});
  };
  const PeriodicOrbit orbit = find_orbit(base, settle_guess(base, base.rest(), 200.0));
  const Branch branch = continue_orbit(over_eta, orbit, 1.0, {.from = 0.7, .to = 1.0, .direction = -1});
  const std::vector<SpecialPoint> tori = of_kind(branch, SpecialKind::kNeimarkSacker);
  ASSERT_EQ(tori.size(), 2u);
  EXPECT_NEAR(tori[0].parameter, 0.94, 0.005);
  EXPECT_NEAR(tori[1].parameter, 0.77, 0.005);
  for (const SpecialPoint& torus : tori) {
    EXPECT_NEAR(std::abs(torus.multiplier), 1.0, 1e-6);
    EXPECT_GT(std::abs(torus.multiplier.imag()), 0.1);
  }
  const PeriodicOrbit inside = find_orbit(over_eta(0.85), branch.points[branch.points.size() / 2].orbit.start);
  EXPECT_EQ(inside.stability, Stability::kUnstable);
}

TEST(Continuation, StickAppearsWhereDenHartogsOscillatorFirstStops) {
  // At the turning point the mass stays when spring and base pull less than friction: |−k x₀ + P sin ψ| = F, by
  // bisection over the closed form without stops (valid down to there).
  const auto excess = [](double base) {
    const fixtures::DenHartog d{.base = base};
    const double P = base * (d.mass * d.omega() * d.omega() - d.stiffness);
    return std::abs(-d.stiffness * d.amplitude() + P * std::sin(d.shaker().phase)) - d.friction;
  };
  const fixtures::DenHartog start;
  double low = 1.0001 * std::abs(start.deviation()), high = start.base;
  ASSERT_LT(excess(low) * excess(high), 0.0);
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (excess(middle) < 0 ? low : high) = middle;
  }
  const friction::Shaker shaker = start.shaker();
  const HybridSystem base = fixtures::oscillator(start.mass, start.stiffness, 0.0,
                                                 friction::Coulomb{start.friction, start.friction}, 1.0, shaker);
  const auto over_amplitude = [&](double amplitude) {
    return base.with_drive(friction::Shaker{amplitude, shaker.frequency_hz, 0.3});
  };
  const HybridSystem first = over_amplitude(1.0);
  const PeriodicOrbit orbit = find_orbit(first, settle_guess(first, first.rest(), 60.0));
  const Branch branch = continue_orbit(over_amplitude, orbit, 1.0, {.from = 0.8 * low, .to = 1.0, .direction = -1});
  const std::vector<SpecialPoint> changes = of_kind(branch, SpecialKind::kStickChange);
  ASSERT_GE(changes.size(), 1u);
  EXPECT_NEAR(changes[0].parameter, low, 1e-8);
  EXPECT_THAT(branch.points.back().orbit.word, testing::HasSubstr("0"));
}

// --- bad input ------------------------------------------------------------------------------------------------------

TEST(Continuation, WithoutArclengthAFoldEndsTheBranchAndSaysSo) {
  const HybridSystem base = Backlash{.omega = 1.3}.system();
  const Branch branch =
      continue_orbit(over_frequency(base), settled(base, -2.0), 1.3, {.from = 1.2, .to = 1.6, .arclength = false});
  EXPECT_EQ(branch.end, BranchEnd::kLost);
  EXPECT_THAT(branch.reason, testing::HasSubstr("fold"));
  EXPECT_NEAR(branch.points.back().parameter, 1.42084, 1e-3);
}

TEST(Continuation, AFamilyWithAJumpKeepsThePartialBranch) {
  const HybridSystem base = Backlash{.omega = 1.1}.system();
  const auto jumping = [&](double omega) { return base.with_drive(Backlash::drive(omega > 1.2 ? 0.2 : 1.0, omega)); };
  const Branch branch = continue_orbit(jumping, settled(base, -2.0), 1.1, {.from = 1.0, .to = 1.5});
  EXPECT_EQ(branch.end, BranchEnd::kLost);
  EXPECT_GT(branch.points.size(), 2u);
  EXPECT_NEAR(branch.points.back().parameter, 1.2, 1e-3);
  EXPECT_THAT(branch.reason, testing::HasSubstr("not continuous"));
}

TEST(Continuation, TheFamilyIsNotAskedBeyondTheRange) {
  const HybridSystem base = Backlash{.omega = 1.1}.system();
  double lowest = 2.0, highest = 0.0;
  const auto family = [&](double omega) {
    lowest = std::min(lowest, omega), highest = std::max(highest, omega);
    return base.with_drive(Backlash::drive(1.0, omega));
  };
  const Branch branch = continue_orbit(family, settled(base, -2.0), 1.1, {.from = 1.0, .to = 1.2, .both_ways = true});
  EXPECT_EQ(branch.end, BranchEnd::kRange);
  EXPECT_DOUBLE_EQ(lowest, 1.0);
  EXPECT_DOUBLE_EQ(highest, 1.2);
  EXPECT_NEAR(std::abs(branch.points.front().parameter - branch.points.back().parameter), 0.2, 1e-12);
}

TEST(Continuation, AParameterTheFamilyRefusesKeepsThePartialBranch) {
  const HybridSystem base = Backlash{.omega = 1.1}.system();
  const auto family = [&](double omega) {
    if (omega > 1.15) throw InvalidInput("no such amplifier");
    return base.with_drive(Backlash::drive(1.0, omega));
  };
  const Branch branch = continue_orbit(family, settled(base, -2.0), 1.1, {.from = 1.0, .to = 1.3});
  EXPECT_EQ(branch.end, BranchEnd::kLost);
  EXPECT_GT(branch.points.size(), 1u);
  EXPECT_THAT(branch.reason, testing::HasSubstr("no such amplifier"));
}

TEST(Continuation, BadInputIsNamed) {
  const HybridSystem base = Backlash{.omega = 1.1}.system();
  const PeriodicOrbit orbit = settled(base, -2.0);
  const dynamics::SystemFamily family = over_frequency(base);
  EXPECT_THROW(static_cast<void>(continue_orbit(family, orbit, 1.1, {.from = 1.0, .to = 1.0})), InvalidInput);
  EXPECT_THROW(static_cast<void>(continue_orbit(family, orbit, 1.1, {.from = 1.2, .to = 1.5})), InvalidInput);
  EXPECT_THROW(static_cast<void>(continue_orbit(family, orbit, 1.1, {.from = 1.0, .to = 1.5, .step = 0.0})),
               InvalidInput);
  EXPECT_THROW(static_cast<void>(switch_branch(family, SpecialPoint{}, {.from = 1.0, .to = 1.5})), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
