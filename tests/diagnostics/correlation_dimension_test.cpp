#include <slipmode/diagnostics/series/correlation_dimension.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

TEST(CorrelationSum, IsTheShareOfPairsItsDefinitionSays) {
  const Series series = fixtures::henon(900);
  const auto result = correlation_dimension(series, {.embedding = {.dimension = 2}, .window = 7, .references = 0});
  const Eigen::MatrixXd points = delay_vectors(series, {.dimension = 2});
  for (const Eigen::Index k : {10, 25, 40}) {
    double close = 0.0, pairs = 0.0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      for (Eigen::Index j = 0; j < points.cols(); ++j) {
        if (std::abs(i - j) <= 7) continue;
        pairs += 1.0;
        if ((points.col(i) - points.col(j)).lpNorm<Eigen::Infinity>() <= result.radius(k)) close += 1.0;
      }
    }
    EXPECT_NEAR(result.C(k), close / pairs, 1e-15) << k;
  }
}

TEST(CorrelationDimension, OfHenonAndLorenzIsWithin005From20000Points) {
  // 1.21 and 2.06. Hénon's slope swings with ln r as the set repeats itself in scale; two decades average over that.
  const auto henon = correlation_dimension(fixtures::henon(20000),
                                           {.embedding = {.dimension = 2}, .smallest = 1e-4, .least_decades = 2.0});
  EXPECT_NEAR(henon.dimension, 1.21, 0.05);
  const auto lorenz = correlation_dimension(fixtures::lorenz(20000, 0.1), {.embedding = {.dimension = 4, .lag = 2}});
  EXPECT_NEAR(lorenz.dimension, 2.06, 0.05);
  EXPECT_LT(lorenz.error, 0.05);
}

TEST(CorrelationDimension, OfASineIsOneOfATorusTwoOfNoiseTheEmbeddings) {
  // Steps by the golden section of the period fill it most evenly.
  const double golden = std::numbers::pi * (std::sqrt(5.0) - 1.0);
  const auto sine = correlation_dimension(fixtures::sine(5000, golden), {.embedding = {.dimension = 3}});
  EXPECT_NEAR(sine.dimension, 1.0, 0.02);
  const auto torus = correlation_dimension(fixtures::two_torus(20000, 1.37), {.embedding = {.dimension = 4}});
  EXPECT_NEAR(torus.dimension, 2.0, 0.1);
  const auto noise =
      correlation_dimension(fixtures::white_noise(5000, 4), {.embedding = {.dimension = 2}, .references = 2000});
  EXPECT_NEAR(noise.dimension, 2.0, 0.05);
}

TEST(CorrelationSum, WithoutAWindowCountsTheNeighboursInTime) {
  const Series series = fixtures::lorenz(5000, 0.001);  // a step is about 0.06 long
  CorrelationOptions options{.embedding = {.dimension = 3, .lag = 150},
                             .smallest = 5e-3,
                             .window = 1,
                             .references = 500,
                             .most_share = 0.5,
                             .least_decades = 0.3};
  const auto blind = correlation_dimension(series, options);
  options.window = 100;
  const auto apart = correlation_dimension(series, options);
  EXPECT_GT(blind.C(5), 2.0 * apart.C(5));
}

TEST(CorrelationDimension, IsTheSameForAnyNumberOfThreads) {
  CorrelationOptions options{.embedding = {.dimension = 2}, .references = 0};
  options.run.threads = 1;
  const auto one = correlation_dimension(fixtures::henon(2000), options);
  options.run.threads = 3;
  EXPECT_EQ(one.C, correlation_dimension(fixtures::henon(2000), options).C);
}

TEST(CorrelationDimension, RefusesTooFewSamplesAndTooFewPairs) {
  EXPECT_THAT([] { (void)correlation_dimension(fixtures::henon(100), {.embedding = {.dimension = 2}, .window = 4}); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("at least 509 samples, found 100")));
  EXPECT_THAT([] { (void)correlation_dimension(fixtures::white_noise(600, 1), {.embedding = {.dimension = 10}}); },
              ::testing::ThrowsMessage<NumericalFailure>(::testing::HasSubstr("longer record")));
}

}  // namespace
}  // namespace slipmode::diagnostics
