// Curves of special points over two parameters, against closed forms and against special points of branches over one.
#include "curve_checks.hpp"
#include "fixtures/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::PlaneFamily;
using dynamics::State;

CurveStart play_start() {
  const HybridSystem base = play(0.02, 1.0833, 1.0);
  const PlaneFamily family = over_force(base);
  const PeriodicOrbit orbit = find_orbit(base, settle_guess(base, base.rest(), 400.0));
  return {family, 1.0833,
          continue_orbit(at_amplitude(family, 1.0833), orbit, 1.0, {.from = 0.9, .to = 1.3, .both_ways = true})};
}

CurveStart backlash_start(double from, double to) {
  const HybridSystem base = Backlash{.omega = 1.2}.system();
  const PlaneFamily family = over_force(base);
  const PeriodicOrbit orbit = find_orbit(base, settle_guess(base, displaced(base, 0, -2.0), 40.0));
  return {family, 1.0,
          continue_orbit(at_amplitude(family, 1.0), orbit, 1.2, {.from = from, .to = to, .both_ways = true})};
}

CurveStart two_masses_start() {
  const HybridSystem base = before_a_stop(0.7);
  const PlaneFamily family = over_force(base);
  State start = base.rest();
  start.q << -0.5689457054, -0.5526538903;
  start.v << 0.6844277403, 0.3444833229;
  return {family, 0.1,
          continue_orbit(at_amplitude(family, 0.1), find_orbit(base, start), 0.7,
                         {.from = 0.5, .to = 0.8, .both_ways = true})};
}

std::vector<SpecialPoint> points_of(const CurveStart& start, SpecialKind kind) { return of_kind(start.branch, kind); }

TEST(SpecialCurve, GrazingOfTheOscillatorWithPlayInClosedForm) {
  // In the gap x = a/√(ω⁴ + 4ξ²ω²) cos(ωt − φ) reaches 1.
  const CurveStart start = play_start();
  const Branch curve = curve_from(start, points_of(start, SpecialKind::kGrazing).at(0), 0.1, 4.0);
  EXPECT_EQ(curve.end, BranchEnd::kRange);
  EXPECT_DOUBLE_EQ(curve.points.front().parameter + curve.points.back().parameter, 4.1);
  EXPECT_GT(curve.points.size(), 20u);
  for (const BranchPoint& point : curve.points) {
    const double omega = *point.other;
    EXPECT_NEAR(point.parameter, std::hypot(omega * omega, 0.04 * omega), 1e-8);
    EXPECT_EQ(point.orbit.word, "g");
  }
}

TEST(SpecialCurve, FoldsMeetInACusp) {
  // S2's oscillator jumps between two motions over a range of frequencies that closes as the force grows.
  const CurveStart start = play_start();
  const std::vector<SpecialPoint> folds = points_of(start, SpecialKind::kFold);
  ASSERT_EQ(folds.size(), 2u);
  const Branch curve = curve_from(start, folds[0], 0.2, 2.0);
  ASSERT_EQ(curve.special.size(), 1u);
  const SpecialPoint& cusp = curve.special[0];
  EXPECT_EQ(cusp.kind, SpecialKind::kCusp);
  const auto passes_second = [&](const BranchPoint& a, const BranchPoint& b) {
    return (a.parameter - start.amplitude) * (b.parameter - start.amplitude) <= 0.0 &&
           std::abs(*a.other - folds[1].parameter) < 0.01;
  };
  EXPECT_NE(std::ranges::adjacent_find(curve.points, passes_second), curve.points.end());
  // Alone: two folds on this side of the cusp, none on the other. Near it they part as distance^1.5.
  for (const double off : {-1e-3, 1e-3}) {
    const auto over = at_amplitude(start.family, cusp.parameter + off);
    const ShootingResult found = shoot(over(*cusp.other + 0.02), cusp.orbit.start, {.half_period = true});
    ASSERT_TRUE(found.converged());
    const Branch branch = continue_orbit(over, found.orbit, *cusp.other + 0.02,
                                         {.from = *cusp.other - 0.02, .to = *cusp.other + 0.02, .direction = -1});
    const auto count = std::ranges::count(branch.special, SpecialKind::kFold, &SpecialPoint::kind);
    EXPECT_EQ(count, off < 0.0 ? 2 : 0);
  }
  expect_found_alone(start, curve, SpecialKind::kFold, 0.01);
}

TEST(SpecialCurve, LossOfSymmetryOfTheMassWithBacklash) {
  const CurveStart start = backlash_start(0.65, 1.3);
  const Branch curve = curve_from(start, points_of(start, SpecialKind::kSymmetryBreaking).at(0), 0.2, 3.0);
  EXPECT_EQ(curve.end, BranchEnd::kRange) << curve.reason;
  expect_found_alone(start, curve, SpecialKind::kSymmetryBreaking, 0.005);
}

TEST(SpecialCurve, GrazingOfADampedStopThatIsTouchedAlready) {
  // Two more touches of stops that the orbit meets anyway; on the touched side multipliers jump.
  const CurveStart start = backlash_start(0.36, 1.3);
  const SpecialPoint grazing = points_of(start, SpecialKind::kGrazing).at(0);
  const Branch curve = curve_from(start, grazing, 0.6, 3.0);
  EXPECT_EQ(curve.end, BranchEnd::kRange) << curve.reason;
  for (const BranchPoint& point : curve.points) EXPECT_EQ(point.orbit.crossings, 4);
  expect_found_alone(start, curve, SpecialKind::kGrazing, 1e-4);
}

TEST(SpecialCurve, PeriodDoublingsOfTwoMasses) {
  // Both of a branch belong to one curve, which turns back at its least amplitude.
  const CurveStart start = two_masses_start();
  const std::vector<SpecialPoint> doublings = points_of(start, SpecialKind::kPeriodDoubling);
  ASSERT_EQ(doublings.size(), 2u);
  const Branch curve = curve_from(start, doublings[0], 0.02, 0.5);
  EXPECT_EQ(curve.end, BranchEnd::kRange) << curve.reason;
  EXPECT_DOUBLE_EQ(curve.points.front().parameter, 0.5);
  EXPECT_DOUBLE_EQ(curve.points.back().parameter, 0.5);
  for (const BranchPoint& point : curve.points)
    EXPECT_LT((point.orbit.multipliers.array() + 1.0).abs().minCoeff(), 1e-8);
  // Where the two are nearly one, a branch over the frequency alone steps over both.
  expect_found_alone(start, curve, SpecialKind::kPeriodDoubling, 0.004, 0.0872);
}

TEST(SpecialCurve, NeimarkSackerPointsEndAtAStrongResonance) {
  const CurveStart start = two_masses_start();
  const SpecialPoint torus = points_of(start, SpecialKind::kNeimarkSacker).at(1);
  const Branch curve = curve_from(start, torus, 0.05, 0.5);
  EXPECT_EQ(curve.end, BranchEnd::kMerged);
  EXPECT_THAT(curve.reason, testing::HasSubstr("strong resonance"));
  const auto nearest = [](const BranchPoint& point) {
    return (point.orbit.multipliers.array() + 1.0).abs().minCoeff();
  };
  EXPECT_LT(std::min(nearest(curve.points.front()), nearest(curve.points.back())), 0.02);
  expect_found_alone(start, curve, SpecialKind::kNeimarkSacker, 0.002);
}

TEST(SpecialCurve, AFoldBesideAGrazingEndsOnIt) {
  // The second fold is 6e-9 from the grazing, and nears it as the force shrinks.
  const CurveStart start = two_masses_start();
  const Branch curve = curve_from(start, points_of(start, SpecialKind::kFold).at(1), 0.02, 0.3);
  EXPECT_THAT(curve.reason, testing::HasSubstr("joins one of grazings"));
  expect_found_alone(start, curve, SpecialKind::kFold, 0.001);
}

TEST(SpecialCurve, FoldsOfSelfExcitedOrbits) {
  // An oscillator on a belt with a smooth law: over the belt's speed its cycle begins at Hopf points, folds, and is
  // lost at a larger speed than it came at. With a flatter law the two folds meet.
  const PlaneFamily family = [](double speed, double mu_k) {
    return fixtures::oscillator(1.0, 1.0, 0.05,
                                friction::TanhRegularised{.mu_s = 0.4, .mu_k = mu_k, .alpha = 3.0, .epsilon = 0.1}, 1.0,
                                friction::Belt::constant(speed));
  };
  const HybridSystem base = family(0.3, 0.2);
  const PeriodicOrbit orbit = find_orbit(base, displaced(base, 0, 0.6), {.period = 6.6});
  const CurveStart start{
      family, 0.2, continue_orbit(at_amplitude(family, 0.2), orbit, 0.3, {.from = 0.05, .to = 2.0, .max_points = 200})};
  const std::vector<SpecialPoint> folds = points_of(start, SpecialKind::kFold);
  ASSERT_EQ(folds.size(), 1u);
  const std::vector<SpecialPoint> hopf = points_of(start, SpecialKind::kHopf);
  ASSERT_GE(hopf.size(), 1u);
  const Branch curve = curve_from(start, folds[0], 0.1, 0.35);
  EXPECT_EQ(curve.end, BranchEnd::kRange) << curve.reason;
  ASSERT_EQ(curve.special.size(), 1u);
  EXPECT_EQ(curve.special[0].kind, SpecialKind::kCusp);
  expect_found_alone(start, curve_from(start, folds[0], 0.1, 0.3), SpecialKind::kFold, 0.01);
  EXPECT_THAT(message_of([&] { (void)curve_from(start, hopf[0], 0.1, 0.35); }), testing::HasSubstr("followed over"));
}

TEST(SpecialCurve, RefusesWhatItCannotFollow) { expect_refusals(two_masses_start()); }

}  // namespace
}  // namespace slipmode::orbits
