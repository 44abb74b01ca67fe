#include <slipmode/diagnostics/series/series_verdict.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

TEST(FindRepeat, FindsThePeriodBetweenSamples) {
  const auto sine = find_repeat(fixtures::sine(2000, 0.3), 1e-5);
  EXPECT_NEAR(sine.samples * 0.3, 2.0 * std::numbers::pi, 1e-3);
  Series seven = fixtures::white_noise(700, 3);
  for (Eigen::Index j = 7; j < 700; ++j) seven.values(j) = seven.values(j - 7);
  EXPECT_EQ(find_repeat(seven, 1e-5).samples, 7.0);
}

TEST(FindRepeat, FindsNoneInNoiseNorInATorus) {
  EXPECT_EQ(find_repeat(fixtures::white_noise(2000, 3), 1e-5).samples, 0.0);
  const auto torus = find_repeat(fixtures::two_torus(10000, 0.1), 1e-5);
  EXPECT_EQ(torus.samples, 0.0);
  EXPECT_GT(torus.mismatch, 1e-5);
}

TEST(SeriesVerdict, CountsTheLoopsOfPeriodDoubling) {
  // Roessler at a = b = 0.2 doubles at c = 2.83 and c = 3.86.
  for (const auto& [c, loops] : {std::pair{2.5, 1}, {3.5, 2}, {4.0, 4}}) {
    const auto verdict = series_verdict(fixtures::roessler(6000, 0.2, c));
    EXPECT_EQ(verdict.motion, SeriesMotion::kPeriodic) << verdict.reason;
    EXPECT_EQ(verdict.period, loops) << c << ": " << verdict.reason;
    EXPECT_NEAR(verdict.T, loops * 5.76, 0.1 * loops) << c;
  }
}

TEST(SeriesVerdict, CallsAFiveCycleOfAMapAndASinePeriodic) {
  // The logistic map has a superstable cycle of five at r = 3.7389149.
  const auto five = series_verdict(fixtures::logistic(2000, 3.7389149));
  EXPECT_EQ(five.motion, SeriesMotion::kPeriodic);
  EXPECT_EQ(five.period, 5);
  EXPECT_TRUE(five.sampled_map);
  const auto sine = series_verdict(fixtures::sine(2000, 0.1));
  EXPECT_EQ(sine.motion, SeriesMotion::kPeriodic);
  EXPECT_EQ(sine.period, 1);
  EXPECT_NEAR(sine.T, 2.0 * std::numbers::pi, 1e-3);
}

TEST(SeriesVerdict, CallsChaosChaos) {
  for (const Series& series : {fixtures::henon(3000), fixtures::lorenz(6000, 0.05), fixtures::roessler(6000, 0.3)}) {
    const auto verdict = series_verdict(series, {.references = 2000});
    EXPECT_EQ(verdict.motion, SeriesMotion::kChaotic) << series.name << ": " << verdict.reason;
    EXPECT_GT(verdict.spectrum.exponents(0), 3.0 * verdict.spectrum.error(0)) << series.name;
    EXPECT_FALSE(verdict.smoothness.doubtful) << series.name;
  }
}

TEST(SeriesVerdict, CallsATorusQuasiPeriodic) {
  for (const double interval : {0.1, 0.3}) {
    const auto verdict = series_verdict(fixtures::two_torus(6000, interval), {.references = 2000});
    EXPECT_EQ(verdict.motion, SeriesMotion::kQuasiPeriodic) << verdict.reason;
  }
}

TEST(SeriesVerdict, CallsNoiseNoiseWhetherWhiteOrColoured) {
  for (const Series& series : {fixtures::white_noise(3000, 1), fixtures::autoregressive(3000, 0.95, 1)}) {
    const auto verdict = series_verdict(series, {.references = 1000});
    EXPECT_EQ(verdict.motion, SeriesMotion::kNoise) << verdict.reason;
  }
}

TEST(SeriesVerdict, SaysWhenARecordHasNotSettled) {
  Series series = fixtures::sine(4000, 0.1);
  for (Eigen::Index j = 0; j < 4000; ++j) series.values(j) *= 1.0 + 2.0 * std::exp(-0.005 * static_cast<double>(j));
  const auto verdict = series_verdict(series);
  EXPECT_EQ(verdict.motion, SeriesMotion::kNotSettled);
  EXPECT_THAT(verdict.reason, ::testing::HasSubstr("variance of the first half"));
}

TEST(SeriesVerdict, NamesTheSamplesThatWouldDo) {
  EXPECT_THAT([] { (void)series_verdict(fixtures::henon(500)); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("at least 1000 samples, found 500")));
}

TEST(Smoothness, SeesStickInAVelocityAndNotInASmoothSeries) {
  // The velocity of a mass that sticks to a belt at speed 0.5 for part of each period: cut off at 0.5.
  Series stick = fixtures::sine(4000, 0.05);
  stick.values = stick.values.cwiseMin(0.5);
  const auto seen = smoothness(stick);
  EXPECT_NEAR(seen.flat_share, 1.0 / 3.0, 0.01);  // sin t > ½ for a third of the period
  EXPECT_TRUE(seen.doubtful);
  for (const Series& series :
       {fixtures::sine(4000, 0.05), fixtures::lorenz(4000, 0.02), fixtures::roessler(4000, 0.1)}) {
    const auto smooth = smoothness(series);
    EXPECT_FALSE(smooth.doubtful) << series.name;
    EXPECT_EQ(smooth.flat_share, 0.0) << series.name;
  }
}

TEST(Smoothness, SeesKinksOfADisplacementWithoutFlatStretches) {
  // |sin t| has a kink every π and none of its stretches is flat; its mean period is π.
  Series series = fixtures::sine(4000, 0.02);
  series.values = series.values.cwiseAbs();
  const auto seen = smoothness(series);
  EXPECT_NEAR(seen.kinks_per_period, 1.0, 0.1);
  EXPECT_TRUE(seen.doubtful);
  EXPECT_TRUE(smoothness(fixtures::henon(200)).coarse);
}

}  // namespace
}  // namespace slipmode::diagnostics
