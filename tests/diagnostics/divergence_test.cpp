#include <slipmode/diagnostics/series/divergence.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

using Method = DivergenceMethod;

TEST(Divergence, OfTheLogisticMapIsLnTwoPerStepByEitherMethod) {
  const Series series = fixtures::logistic(10000, 4.0);
  for (const Method method : {Method::kRosenstein, Method::kKantz}) {
    const auto result = divergence(series, {.embedding = {.dimension = 1}, .method = method});
    EXPECT_NEAR(result.exponent, std::numbers::ln2, 0.02 * std::numbers::ln2);
    EXPECT_GT(result.references, 9000);
  }
}

TEST(Divergence, OfHenonIsWithinFivePercentFrom20000Points) {
  const auto result = divergence(fixtures::henon(20000), {.embedding = {.dimension = 2}});
  EXPECT_NEAR(result.exponent, 0.4192, 0.05 * 0.4192);
  EXPECT_LT(result.error, 0.02);
  EXPECT_EQ(result.settings.embedding.dimension, 2);
}

TEST(Divergence, OfLorenzIsWithinFivePercentAcrossTheFlowFrom20000Points) {
  // Records scatter by 0.012 about 0.92: the mean of four.
  double mean = 0.0;
  for (const double x0 : {1.0, 1.1, 1.2, 1.3}) {
    const auto result = divergence(fixtures::lorenz(20000, 0.05, x0), {.embedding = {.dimension = 3, .lag = 3},
                                                                       .method = Method::kTransverse,
                                                                       .steps = 140,
                                                                       .references = 10000,
                                                                       .region = {.least_width = 0.75}});
    EXPECT_LT(std::abs(result.exponent - 0.9056), 2.0 * result.error + 0.04) << x0;
    mean += result.exponent / 4.0;
  }
  EXPECT_NEAR(mean, 0.9056, 0.05 * 0.9056);
}

TEST(Divergence, AcrossTheFlowIsNearerTheTruthForRoesslerThanBetweenSamples) {
  // 0.0714 per unit. Half a sampling interval along the path is farther than the next loop: the nearest sample hides
  // the growth. One record of 20,000 samples scatters by 0.003 across the flow, by 0.005 between samples, and by 0.004
  // in their difference: ten records are averaged.
  DivergenceOptions options{.embedding = {.dimension = 3, .lag = 8},
                            .steps = 125,
                            .stride = 4,
                            .references = 5000,
                            .region = {.least_width = 12.0}};
  constexpr int kRecords = 10;
  double between = 0.0, across = 0.0;
  for (int i = 0; i < kRecords; ++i) {
    const Series series = fixtures::roessler(20000, 0.2, 5.7, 1.0 + 0.1 * i);
    options.method = Method::kRosenstein;
    between += divergence(series, options).exponent / kRecords;
    options.method = Method::kTransverse;
    across += divergence(series, options).exponent / kRecords;
  }
  EXPECT_GT(across, between);
  EXPECT_LT(across, 0.0714);
  EXPECT_NEAR(across, 0.0714, 0.15 * 0.0714);
}

TEST(Divergence, ScalesWithTheUnitOfTime) {
  Series series = fixtures::henon(3000);
  const auto per_step = divergence(series, {.embedding = {.dimension = 2}});
  series.interval = 0.25;
  const auto per_time = divergence(series, {.embedding = {.dimension = 2}});
  EXPECT_NEAR(per_time.exponent, 4.0 * per_step.exponent, 1e-12);
  EXPECT_NEAR(per_time.error, 4.0 * per_step.error, 1e-12);
}

TEST(Divergence, OfASineDoesNotGrow) {
  // Two phases stay apart: the curve turns about a level, whatever line is fitted to its swings.
  const auto result =
      divergence(fixtures::sine(5000, 0.0937), {.embedding = {.dimension = 2, .lag = 17}, .steps = 200});
  EXPECT_LT(result.mean_log.maxCoeff() - result.mean_log.minCoeff(), 0.2);
}

TEST(Divergence, IsTheSameForAnyNumberOfThreads) {
  const Series series = fixtures::henon(2000);
  DivergenceOptions options{.embedding = {.dimension = 2}, .method = Method::kKantz};
  options.run.threads = 1;
  const auto one = divergence(series, options);
  options.run.threads = 3;
  EXPECT_EQ(one.mean_log, divergence(series, options).mean_log);
}

TEST(Divergence, NamesTheRadiusOrTheSamplesThatWouldDo) {
  const Series series = fixtures::henon(1000);
  EXPECT_THAT(
      [&] { (void)divergence(series, {.embedding = {.dimension = 2}, .method = Method::kKantz, .radius = 1e-9}); },
      ::testing::ThrowsMessage<NumericalFailure>(::testing::HasSubstr("would do")));
  EXPECT_THAT([&] { (void)divergence(series, {.embedding = {.dimension = 2}, .steps = 1000}); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("at least 1109 samples, found 1000")));
}

}  // namespace
}  // namespace slipmode::diagnostics
