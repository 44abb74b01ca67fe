// Branches and their special points against closed forms, against orbits found one by one, and against S0 and S1.
#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "clearance_systems.hpp"
#include "fixtures/belt_oscillator.hpp"
#include "fixtures/den_hartog.hpp"
#include "fixtures/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::State;

PeriodicOrbit settled(const HybridSystem& system, double x, const ShootingOptions& options = {}) {
  return find_orbit(system, settle_guess(system, displaced(system, 0, x), 40.0), options);
}

std::vector<SpecialPoint> of_kind(const Branch& branch, SpecialKind kind) {
  std::vector<SpecialPoint> found;
  std::copy_if(branch.special.begin(), branch.special.end(), std::back_inserter(found),
               [&](const SpecialPoint& point) { return point.kind == kind; });
  return found;
}

/// S0's single mass from ω = 1.2, where only the large orbit is stable.
Branch backlash_branch(int direction, double to, friction::ContactLoss loss = friction::ContactLoss::kZeroForce) {
  const HybridSystem base = Backlash{.omega = 1.2, .loss = loss}.system();
  return continue_orbit(over_frequency(base), settled(base, -2.0), 1.2,
                        {.from = 0.3, .to = to, .direction = direction, .max_points = 400});
}

// --- smooth ---------------------------------------------------------------------------------------------------------

TEST(Continuation, FollowsTheResonanceCurveOfALinearOscillator) {
  const double c = 0.1, k = 2.0;
  const friction::Stop far{.stiffness = 1.0, .gap = 500.0};
  const HybridSystem base(fem::masses({.links = {{.stiffness = k, .damping = c}}}),
                          {{Eigen::VectorXd::Ones(1), friction::Clearance{far, far}}}, Backlash::drive(1.0, 0.8), {},
                          Eigen::MatrixXd::Ones(1, 1));
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

TEST(Continuation, OrbitsOfTwiceThePeriodEndWhereThePeriodDoublesAgain) {
  // Between unlike stops the period doubles twice, and orbits of twice the period lead from one point to the other: no
  // further, where they would be the same ones with their two periods exchanged.
  const friction::Clearance stops{friction::Stop{.stiffness = 1e6, .gap = 4e-6},
                                  friction::Stop{.stiffness = 2e6, .gap = 6e-6}, friction::ContactLoss::kGap};
  const auto drive = [](double omega) { return friction::Force{omega, {{.amplitude = 2.0}}}; };
  const HybridSystem base{fem::masses({.mass = {5e-3}, .links = {{.stiffness = 2e5, .damping = 1.5}}}),
                          {{Eigen::VectorXd::Ones(1), stops}},
                          drive(8400.0),
                          {},
                          Eigen::MatrixXd::Ones(1, 1)};
  const dynamics::SystemFamily family = [&](double omega) { return base.with_drive(drive(omega)); };
  const ContinuationOptions options{.from = 7500.0, .to = 9000.0, .both_ways = true};
  const Branch single = continue_orbit(family, settled(base, 0.0), 8400.0, options);
  const std::vector<SpecialPoint> doublings = of_kind(single, SpecialKind::kPeriodDoubling);
  ASSERT_EQ(doublings.size(), 2u) << single.reason;
  for (const std::size_t from : {0u, 1u}) {
    const BranchPoint first = switch_branch(family, doublings[from], options).at(0);
    const Branch doubled = continue_orbit(family, first.orbit, first.parameter,
                                          {.from = 7500.0,
                                           .to = 9000.0,
                                           .direction = first.parameter > doublings[from].parameter ? 1 : -1,
                                           .shooting = {.order = 2}});
    EXPECT_EQ(doubled.end, BranchEnd::kMerged) << doubled.reason;
    ASSERT_FALSE(doubled.special.empty());
    const SpecialPoint& last = doubled.special.back();
    EXPECT_EQ(last.kind, SpecialKind::kPeriodDoubling);
    EXPECT_NEAR(last.parameter, doublings[1 - from].parameter, 1e-7);
    EXPECT_EQ(last.orbit.order, 1);
    EXPECT_EQ(of_kind(doubled, SpecialKind::kPeriodDoubling).size(), 1u);
    for (const SpecialPoint& fold : of_kind(doubled, SpecialKind::kFold))
      EXPECT_NEAR(std::abs(fold.multiplier), 1.0, 1e-3);
  }
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

/// The belt speed at which the free swing after a release just reaches the belt's speed again: an oscillator about the
/// steady position, released at u = (F_s − F_k − cV)/k with speed V; its next greatest speed is V.
double last_stick_slip_speed(double c, double drop) {
  const auto excess = [&](double V) {
    const double half = c / 2, w = std::sqrt(1.0 - half * half);
    // Slip force F_k: u″ + c u′ + u = 0 with u measured from F_k. Release: u + c V = drop.
    const double u = drop - c * V, b = (V + half * u) / w;
    const auto speed = [&](double t) {
      const double e = std::exp(-half * t);
      return e * ((b * w - half * u) * std::cos(w * t) - (u * w + half * b) * std::sin(w * t));
    };
    double best = -1e9;
    for (int k = 0; k <= 4000; ++k) best = std::max(best, speed(3.0 + 6.0 * k / 4000.0));
    double at = 3.0;
    for (int k = 0; k <= 4000; ++k)
      if (speed(3.0 + 6.0 * k / 4000.0) == best) at = 3.0 + 6.0 * k / 4000.0;
    for (double h = 1e-3; h > 1e-12; h *= 0.5) {
      if (speed(at + h) > speed(at)) at += h;
      if (speed(at - h) > speed(at)) at -= h;
    }
    return speed(at) - V;
  };
  double low = 0.01, high = 5.0;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

TEST(Continuation, AStickSlipCycleEndsWhereItNoLongerSticks) {
  const double c = 0.1;
  const auto system_at = [&](double speed) {
    return fixtures::oscillator(1.0, 1.0, c, friction::Coulomb{0.4, 0.2}, 1.0, friction::Belt::constant(speed));
  };
  const RecurrenceGuess guess = recurrence_guess(
      system_at(0.1), fixtures::state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.1)), 50.0, 100.0);
  const PeriodicOrbit orbit = find_orbit(system_at(0.1), guess.state, {.period = guess.period});
  const Branch branch = continue_orbit(system_at, orbit, 0.1, {.from = 0.05, .to = 2.0});
  EXPECT_EQ(branch.end, BranchEnd::kLost);
  EXPECT_THAT(branch.reason, testing::HasSubstr("the motion jumps there"));
  EXPECT_GT(branch.points.size(), 10u);
  EXPECT_NEAR(branch.points.back().parameter, last_stick_slip_speed(c, 0.2), 1e-6);
}

/// Unit mass, spring and load on a belt, μ = 0.2 + 0.2 e^{−8v}.
dynamics::SystemFamily stribeck_oscillator(double c) {
  return [c](double speed) {
    return fixtures::oscillator(1.0, 1.0, c, friction::Stribeck{0.4, 0.2, 8.0}, 1.0, friction::Belt::constant(speed));
  };
}

void expect_turn_and_hopf_point(const Branch& branch, double turn, double hopf) {
  EXPECT_TRUE(is_complete(branch.end)) << branch.reason;
  ASSERT_EQ(branch.special.size(), 2u) << branch.reason;
  for (const SpecialPoint& point : branch.special) {
    const bool turns = point.kind == SpecialKind::kNonSmoothFold;
    EXPECT_TRUE(turns || point.kind == SpecialKind::kHopf) << to_string(point.kind);
    EXPECT_NEAR(point.parameter, turns ? turn : hopf, turns ? point.uncertainty : 1e-11) << to_string(point.kind);
    EXPECT_LT(point.uncertainty, 1e-7);
  }
  const auto [least, most] = std::ranges::minmax(branch.points, {}, &BranchPoint::parameter);
  EXPECT_NEAR(most.parameter, turn, 1e-4);
}

TEST(Continuation, AStickSlipCycleTurnsBackToTheHopfPointOfSteadySliding) {
  // Sliding steadily, the slope of the friction undoes the damping: 1.6 e^{−8V} = c. The speed at which the slip just
  // reaches the belt again where it left it: DOP853 at 1e-13 from the place of release.
  const double turns[] = {0.6439495365660765, 1.4899227575794374}, dampings[] = {0.1, 0.03};
  for (int k = 0; k < 2; ++k) {
    const dynamics::SystemFamily family = stribeck_oscillator(dampings[k]);
    const double hopf = std::log(1.6 / dampings[k]) / 8.0;
    const RecurrenceGuess guess = recurrence_guess(
        family(0.1), fixtures::state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.1)), 50.0, 100.0);
    const PeriodicOrbit stick_slip = find_orbit(family(0.1), guess.state, {.period = guess.period});
    const ContinuationOptions options{.from = 0.05, .to = 3.0, .both_ways = true};
    const Branch branch = continue_orbit(family, stick_slip, 0.1, options);
    expect_turn_and_hopf_point(branch, turns[k], hopf);
    EXPECT_NEAR(branch.points.front().parameter, 0.05, 1e-12);
    EXPECT_NEAR(branch.points.back().parameter, hopf, 1e-6);
    // From the other side of an unstable cycle between.
    const BranchPoint& between = branch.points[branch.points.size() - branch.points.size() / 8];
    ASSERT_EQ(between.orbit.crossings, 0);
    const HybridSystem there = family(between.parameter);
    const State half = advanced(there, between.orbit.start, 0.5 * between.orbit.period);
    const PeriodicOrbit orbit = find_orbit(there, half, {.period = between.orbit.period});
    expect_turn_and_hopf_point(continue_orbit(family, orbit, between.parameter, options), turns[k], hopf);
  }
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
