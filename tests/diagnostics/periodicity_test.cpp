#include <slipmode/diagnostics/attractors/periodicity.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace slipmode::diagnostics {
namespace {

/// `count` slips of one contact that repeat `x` with the waiting times `dt`, plus error(k).
std::vector<SlipState> repeating(
    const std::vector<double>& x, const std::vector<double>& dt, int count,
    const std::function<double(int)>& error = [](int) { return 0.0; }, int contact = 0) {
  std::vector<SlipState> slips;
  double time = 3.0;
  for (int k = 0; k < count; ++k) {
    const auto phase = static_cast<std::size_t>(k) % x.size();
    slips.push_back({.time = time, .contact = contact, .displacement = x[phase] + error(k)});
    time += dt[phase];
  }
  return slips;
}

const std::vector<double> kX5 = {9.18711, 9.72520, 10.86653, 11.09104, 11.46713};
const std::vector<double> kT5 = {44.0, 45.0, 46.0, 45.5, 46.5};

TEST(Period, IsTheLengthOfARepeatingSequence) {
  for (int p = 1; p <= 5; ++p) {
    const std::vector<double> x(kX5.begin(), kX5.begin() + p);
    const std::vector<double> dt(kT5.begin(), kT5.begin() + p);
    const PeriodResult result = detect_period(repeating(x, dt, 100));
    EXPECT_EQ(result.motion, Motion::kPeriodic);
    EXPECT_EQ(result.period, p);
    double T = 0.0;
    for (const double t : dt) T += t;
    EXPECT_NEAR(result.T, T, 1e-10);
  }
}

TEST(Period, IsTheSmallestThoughAllItsMultiplesRepeatToo) {
  std::vector<double> twice = {1.0, 2.0, 1.0, 2.0};
  const PeriodResult result = detect_period(repeating(twice, {5.0, 7.0, 5.0, 7.0}, 200));
  EXPECT_EQ(result.period, 2);
}

TEST(Period, SeesADoublingLargerThanTheTolerance) {
  // Period 2 by a split of 2e-3 about slip states whose contact moves over 10.
  const auto slips = repeating({10.0, 10.002}, {45.0, 45.0}, 120);
  PeriodOptions options{.tolerance = 1e-5, .scale = {10.0}};
  EXPECT_EQ(detect_period(slips, options).period, 2);
  options.tolerance = 1e-3;
  EXPECT_EQ(detect_period(slips, options).period, 1);
}

TEST(Period, SurvivesNoiseBelowTheToleranceAndNotAbove) {
  Random random(1);
  std::vector<double> noise(200);
  for (double& x : noise) x = random.uniform(-1.0, 1.0);
  const auto slips_with = [&](double size) {
    return repeating(kX5, kT5, 200, [&](int k) { return size * noise[static_cast<std::size_t>(k)]; });
  };
  const double range = 11.46713 - 9.18711;
  const PeriodResult quiet = detect_period(slips_with(1e-6));
  EXPECT_EQ(quiet.period, 5);
  EXPECT_LE(quiet.mismatch, 2.0 * 1e-6 / range * 1.001);  // two errors of at most 1e-6, relative to the range
  EXPECT_GT(quiet.mismatch, 0.0);
  EXPECT_EQ(detect_period(slips_with(1e-3), {.max_period = 30}).motion, Motion::kAperiodic);
}

TEST(Period, WaitsForASlowDecay) {
  // Decay by 2 % per slip from 1: differences p apart fall below 1e-5 of the range (2.28) only after some 450 slips.
  const auto decay = [](int k) { return std::pow(0.98, k); };
  EXPECT_NE(detect_period(repeating(kX5, kT5, 300, decay)).motion, Motion::kPeriodic);
  EXPECT_EQ(detect_period(repeating(kX5, kT5, 900, decay)).period, 5);
}

TEST(Period, IsUndecidedWhileTheMotionSettlesAndAperiodicWhereItNeverDoes) {
  for (const double factor : {0.98, 0.99, -0.99, 0.995}) {
    const auto decay = [factor](int k) { return std::pow(factor, k); };
    EXPECT_EQ(detect_period(repeating(kX5, kT5, 300, decay)).motion, Motion::kUndecided) << factor;
  }
  // Chaos at 300 parameters, and rotations by 300 angles, whose differences p apart stay as large as they are.
  int chaos = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<SlipState> chaotic, turning;
    double x = 0.4, exponent = 0.0;
    const double r = 3.7 + 0.3 * i / 300.0, turn = 0.1 + 0.7 * i / 300.0;
    for (int k = 0; k < 5000; ++k) x = r * x * (1.0 - x);
    for (int k = 0; k < 600; ++k) {
      chaotic.push_back({.time = 10.0 * k, .contact = 0, .displacement = x});
      turning.push_back({.time = 10.0 * k, .contact = 0, .displacement = std::sin(turn * k)});
      exponent += std::log(std::abs(r * (1.0 - 2.0 * x))) / 600.0;
      x = r * x * (1.0 - x);
    }
    if (exponent > 0.1) {
      ++chaos;
      EXPECT_EQ(detect_period(chaotic).motion, Motion::kAperiodic) << "r " << r;
    }
    EXPECT_NE(detect_period(turning).motion, Motion::kUndecided) << "angle " << turn;
  }
  EXPECT_GT(chaos, 200);
}

TEST(Period, NeedsTimesToRepeatToo) {
  // The same displacement each time, at times that never repeat.
  std::vector<SlipState> slips;
  double time = 0.0;
  Random random(4);
  for (int k = 0; k < 400; ++k) {
    slips.push_back({.time = time, .contact = 0, .displacement = 1.0});
    time += random.uniform(1.0, 2.0);
  }
  EXPECT_EQ(detect_period(slips).motion, Motion::kAperiodic);
}

TEST(Period, OfTheLogisticMapIsThatOfItsCycle) {
  // x → r x (1 − x): period 4 at r = 3.5, period 3 at 3.835, chaos at 3.9 (May 1976).
  const auto slips = [](double r) {
    std::vector<SlipState> made;
    double x = 0.4;
    for (int k = 0; k < 3000; ++k) {
      made.push_back({.time = 10.0 * k + x, .contact = 0, .displacement = x});
      x = r * x * (1.0 - x);
    }
    return made;
  };
  EXPECT_EQ(detect_period(slips(3.5)).period, 4);
  EXPECT_EQ(detect_period(slips(3.835)).period, 3);
  EXPECT_EQ(detect_period(slips(3.9)).motion, Motion::kAperiodic);
}

TEST(Period, IsUndecidedWithTooFewSlips) {
  EXPECT_EQ(detect_period({}).motion, Motion::kUndecided);
  EXPECT_EQ(detect_period(repeating({1.0}, {5.0}, 10)).motion, Motion::kUndecided);
}

TEST(Period, TakesFewSlipsWhenTheyCoverALongTime) {
  const auto slips = repeating({1.0, 2.0}, {4000.0, 6000.0}, 9);
  EXPECT_EQ(detect_period(slips).motion, Motion::kUndecided);
  EXPECT_EQ(detect_period(slips, {.long_stretch = 5000.0}).period, 2);
}

/// Two contacts: the first slips every 10, the second three times in 20.
std::vector<SlipState> two_contacts(double second_drift) {
  std::vector<SlipState> slips = repeating({1.0}, {10.0}, 200);
  const auto second = repeating(
      {4.0, 5.0, 7.0}, {6.0, 6.5, 7.5}, 300, [&](int k) { return second_drift * k; }, 1);
  slips.insert(slips.end(), second.begin(), second.end());
  std::sort(slips.begin(), slips.end(), [](const SlipState& a, const SlipState& b) { return a.time < b.time; });
  return slips;
}

TEST(Period, OfSeveralContactsIsCommonToAll) {
  const PeriodResult result = detect_period(two_contacts(0.0));
  EXPECT_EQ(result.motion, Motion::kPeriodic);
  EXPECT_EQ(result.contact, 1);  // slips most often
  EXPECT_EQ(result.period, 3);
  EXPECT_NEAR(result.T, 20.0, 1e-12);
  EXPECT_EQ(detect_period(two_contacts(0.01)).motion, Motion::kAperiodic);
}

TEST(Period, DoesNotDependOnTheOrderOfSimultaneousSlips) {
  // Two contacts slip at the same instants, listed now in one order and now in the other.
  std::vector<SlipState> slips;
  Random random(9);
  for (int k = 0; k < 200; ++k) {
    SlipState a{.time = 10.0 * k, .contact = 0, .displacement = 1.0};
    SlipState b{.time = 10.0 * k, .contact = 1, .displacement = 2.0 + (k % 2)};
    if (random.uniform() < 0.5) std::swap(a, b);
    slips.push_back(a);
    slips.push_back(b);
  }
  const PeriodResult result = detect_period(slips);
  EXPECT_EQ(result.motion, Motion::kPeriodic);
  EXPECT_EQ(result.period, 2);  // contact 1 alternates
  EXPECT_NEAR(result.T, 20.0, 1e-12);
}

TEST(Period, OfTheWholeStateCanBeLongerThanThatOfTheDisplacement) {
  const auto slips = repeating({1.0}, {10.0}, 100);
  Eigen::MatrixXd states(2, 100);
  for (Eigen::Index k = 0; k < 100; ++k) states.col(k) << 1.0, (k % 3 == 0 ? 0.5 : -0.5);
  EXPECT_EQ(detect_period(slips).period, 1);
  EXPECT_EQ(detect_period(slips, {}, &states).period, 3);
}

TEST(Period, RefusesSlipsOutOfOrderAndImpossibleOptions) {
  std::vector<SlipState> slips = repeating({1.0}, {10.0}, 5);
  std::swap(slips[1], slips[3]);
  EXPECT_THROW((void)detect_period(slips), InvalidInput);
  EXPECT_THROW((void)detect_period({}, {.tolerance = 0.0}), InvalidInput);
  const Eigen::MatrixXd narrow(2, 3);
  EXPECT_THROW((void)detect_period(repeating({1.0}, {10.0}, 5), {}, &narrow), InvalidInput);
}

TEST(SlipStates, AreTheReleasesAmongTheEvents) {
  using dynamics::EventKind;
  const std::vector<dynamics::Event> events = {
      {.time = 1.0, .contact = 0, .kind = EventKind::kStick, .displacement = 0.1},
      {.time = 2.0, .contact = 0, .kind = EventKind::kRelease, .displacement = 0.2},
      {.time = 3.0, .contact = 1, .kind = EventKind::kReversal, .displacement = 0.3},
      {.time = 4.0, .contact = 1, .kind = EventKind::kRelease, .displacement = 0.4}};
  const std::vector<SlipState> slips = slip_states(events);
  ASSERT_EQ(slips.size(), 2U);
  EXPECT_EQ(slips[0].displacement, 0.2);
  EXPECT_EQ(slips[1].contact, 1);
}

}  // namespace
}  // namespace slipmode::diagnostics
