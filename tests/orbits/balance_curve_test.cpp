// Curves of special points of balances, against closed forms, branches of balances over one parameter, and the exact
// curves by shooting.
#include "curve_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::PlaneFamily;

/// Branches of balances of H harmonics.
/// @param from, to  of the frequency, which is the base's in between
CurveStart start_of(const HybridSystem& base, const Balance& first, double amplitude, double from, double to) {
  const PlaneFamily family = over_force(base);
  return {family, amplitude,
          continue_balance(at_amplitude(family, amplitude), first, base.drive().force()->omega,
                           {.from = from, .to = to, .both_ways = true})};
}

CurveStart play_balances(int H) {
  const HybridSystem base = play(0.02, 1.0833, 1.0);
  return start_of(base, balance(base, {.harmonics = H}), 1.0833, 0.9, 1.3);
}

CurveStart two_masses_balances(int H) {
  const HybridSystem base = before_a_stop(0.7);
  return start_of(base, balance(base, {.harmonics = H}), 0.1, 0.5, 0.8);
}

CurveStart backlash_balances(int H) {
  const HybridSystem base = Backlash{.omega = 1.2}.system();
  return start_of(base, balance(base, {.harmonics = H}), 1.0, 0.65, 1.3);
}

TEST(BalanceCurve, GrazingOfTheOscillatorWithPlayInClosedForm) {
  // In the gap the motion is one harmonic, which any order holds: x = a/√(ω⁴ + 4ξ²ω²) cos(ωt − φ) reaches 1.
  const CurveStart start = play_balances(3);
  const Branch curve = curve_from(start, of_kind(start.branch, SpecialKind::kGrazing).at(0), 0.1, 4.0);
  EXPECT_EQ(curve.end, BranchEnd::kRange) << curve.reason;
  EXPECT_DOUBLE_EQ(curve.points.front().parameter + curve.points.back().parameter, 4.1);
  EXPECT_GT(curve.points.size(), 20U);
  for (const BranchPoint& point : curve.points) {
    EXPECT_NEAR(point.parameter, std::hypot(*point.other * *point.other, 0.04 * *point.other), 1e-8);
    EXPECT_EQ(point.orbit.word, "g");
    EXPECT_TRUE(point.balance);
  }
}

TEST(BalanceCurve, FoldsMeetInACusp) {
  const CurveStart start = play_balances(9);
  const std::vector<SpecialPoint> folds = of_kind(start.branch, SpecialKind::kFold);
  ASSERT_EQ(folds.size(), 2U);
  const Branch curve = curve_from(start, folds[0], 0.2, 2.0);
  EXPECT_EQ(std::ranges::count(curve.special, SpecialKind::kCusp, &SpecialPoint::kind), 1);
  expect_found_alone(start, curve, SpecialKind::kFold, 0.01);
}

TEST(BalanceCurve, TendsToTheExactOneAsTheOrderGrows) {
  // The cusp of folds by shooting, and by 5 and 15 harmonics: of the third order as the series are, 27 times nearer,
  // at least a tenth of that.
  const HybridSystem base = play(0.02, 1.0833, 1.0);
  const PlaneFamily family = over_force(base);
  const PeriodicOrbit orbit = find_orbit(base, settle_guess(base, base.rest(), 400.0));
  const CurveStart exact{
      family, 1.0833,
      continue_orbit(at_amplitude(family, 1.0833), orbit, 1.0, {.from = 0.9, .to = 1.3, .both_ways = true})};
  const auto cusp_of = [](const CurveStart& start) {
    const Branch curve = curve_from(start, of_kind(start.branch, SpecialKind::kFold).at(0), 0.2, 2.0);
    const auto cusp = std::ranges::find(curve.special, SpecialKind::kCusp, &SpecialPoint::kind);
    EXPECT_NE(cusp, curve.special.end());
    return cusp == curve.special.end() ? Eigen::Vector2d::Zero().eval()
                                       : Eigen::Vector2d(*cusp->other, cusp->parameter);
  };
  const Eigen::Vector2d at = cusp_of(exact);
  const double coarse = (cusp_of(play_balances(5)) - at).norm(), fine = (cusp_of(play_balances(15)) - at).norm();
  EXPECT_LT(fine, coarse / 2.7);
  EXPECT_LT(fine, 1e-5);
}

TEST(BalanceCurve, LossOfSymmetryOfTheMassWithBacklash) {
  const CurveStart start = backlash_balances(9);
  const Branch curve = curve_from(start, of_kind(start.branch, SpecialKind::kSymmetryBreaking).at(0), 0.2, 3.0);
  for (const BranchPoint& point : curve.points) EXPECT_TRUE(point.orbit.symmetric);
  expect_found_alone(start, curve, SpecialKind::kSymmetryBreaking, 0.005);
}

TEST(BalanceCurve, PeriodDoublingsOfTwoMasses) {
  const CurveStart start = two_masses_balances(7);
  const std::vector<SpecialPoint> doublings = of_kind(start.branch, SpecialKind::kPeriodDoubling);
  ASSERT_EQ(doublings.size(), 2U);
  const Branch curve = curve_from(start, doublings[0], 0.02, 0.5);
  EXPECT_EQ(curve.end, BranchEnd::kRange) << curve.reason;
  for (const BranchPoint& point : curve.points)
    EXPECT_LT((point.orbit.multipliers.array() + 1.0).abs().minCoeff(), 1e-8);
  expect_found_alone(start, curve, SpecialKind::kPeriodDoubling, 0.004, 0.0872);
}

TEST(BalanceCurve, NeimarkSackerPointsEndAtAStrongResonance) {
  const CurveStart start = two_masses_balances(7);
  const std::vector<SpecialPoint> tori = of_kind(start.branch, SpecialKind::kNeimarkSacker);
  ASSERT_EQ(tori.size(), 2U);
  const Branch curve = curve_from(start, tori[1], 0.05, 0.5);
  EXPECT_EQ(curve.end, BranchEnd::kMerged);
  EXPECT_THAT(curve.reason, testing::HasSubstr("strong resonance"));
  expect_found_alone(start, curve, SpecialKind::kNeimarkSacker, 0.002);
}

TEST(BalanceCurve, RefusesWhatItCannotFollow) { expect_refusals(two_masses_balances(7)); }

}  // namespace
}  // namespace slipmode::orbits
