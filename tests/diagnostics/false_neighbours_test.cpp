#include <slipmode/diagnostics/series/false_neighbours.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace slipmode::diagnostics {
namespace {

TEST(FalseNeighbours, VanishInTheDimensionThatUnfoldsTheSet) {
  // The logistic map is its own graph over one coordinate; Hénon's needs two; a sine is a closed curve: two; x of
  // Lorenz's system needs three (Kennel and others, 1992).
  EXPECT_EQ(false_neighbours(fixtures::logistic(5000, 4.0), {.max_dimension = 4}).dimension, 1);
  EXPECT_EQ(false_neighbours(fixtures::henon(5000), {.max_dimension = 4}).dimension, 2);
  EXPECT_EQ(false_neighbours(fixtures::sine(5000, 0.0517), {.lag = 20, .max_dimension = 4}).dimension, 2);
  const auto lorenz =
      false_neighbours(fixtures::lorenz(20000, 0.02), {.lag = 8, .max_dimension = 5, .references = 5000});
  EXPECT_EQ(lorenz.dimension, 3);
  EXPECT_GT(lorenz.share(0), 0.5);
  EXPECT_LT(lorenz.share(4), 0.005);
}

TEST(FalseNeighbours, OfNoiseStayByTheSecondCriterionAlone) {
  const auto noise = false_neighbours(fixtures::white_noise(5000, 6), {.max_dimension = 10});
  EXPECT_EQ(noise.dimension, 0);
  EXPECT_LT(noise.by_ratio(9), 0.001);
  // Nearest neighbours of independent samples recede as the dimension grows.
  EXPECT_GT(noise.by_size(9), 2.0 * noise.by_size(5));
  EXPECT_GT(noise.by_size(5), noise.by_size(2));
  EXPECT_GT(noise.share.tail(7).minCoeff(), 0.05);
}

TEST(FalseNeighbours, GrowAsTheToleranceTightensToThatOfS4) {
  const Series series = fixtures::lorenz(5000, 0.02);
  const auto kennel = false_neighbours(series, {.lag = 8, .max_dimension = 3});
  const auto s4 = false_neighbours(series, {.lag = 8, .max_dimension = 3, .ratio = std::sqrt(10.0)});
  for (int d = 0; d < 3; ++d) EXPECT_GT(s4.by_ratio(d), kennel.by_ratio(d)) << d;
  EXPECT_EQ(s4.by_size, kennel.by_size);
}

TEST(FalseNeighbours, OfARecordThatRepeatsItselfExactlyAreNone) {
  Series series = fixtures::white_noise(2000, 9);
  for (Eigen::Index j = 5; j < 2000; ++j) series.values(j) = series.values(j - 5);
  const auto result = false_neighbours(series, {.max_dimension = 3});
  EXPECT_EQ(result.share(0), 0.0);  // five different values: one coordinate tells them apart
}

TEST(CaoAverages, LevelOffAtOneOnceTheDimensionIsEnough) {
  const auto result = cao_averages(fixtures::lorenz(10000, 0.02), {.lag = 8, .max_dimension = 6});
  EXPECT_LT(result.E1(0), 0.3);
  EXPECT_GT(result.E1.tail(4).minCoeff(), 0.85);
  EXPECT_LT(result.E1.tail(4).maxCoeff(), 1.1);
  EXPECT_LT(result.E2.minCoeff(), 0.6);  // a later sample depends on earlier ones
}

TEST(CaoAverages, E2IsOneAtEveryDimensionForIndependentSamples) {
  // Two independent normal numbers are apart by 2/√π on average whatever came before.
  const auto result = cao_averages(fixtures::white_noise(20000, 21), {.max_dimension = 6});
  for (int d = 0; d < 6; ++d) EXPECT_NEAR(result.E2(d), 1.0, 0.04) << d;
  EXPECT_LT(result.E2_error.maxCoeff(), 0.03);
}

TEST(FalseNeighbours, AreTheSameForAnyNumberOfThreads) {
  const Series series = fixtures::henon(3000);
  const auto one =
      false_neighbours(series, {.max_dimension = 3, .run = {.threads = 1, .stop = nullptr, .progress = {}}});
  const auto three =
      false_neighbours(series, {.max_dimension = 3, .run = {.threads = 3, .stop = nullptr, .progress = {}}});
  EXPECT_EQ(one.share, three.share);
  EXPECT_EQ(one.error, three.error);
}

TEST(FalseNeighbours, RefuseARecordTooShortForTheDimension) {
  const Series series = fixtures::henon(120);
  EXPECT_THAT([&] { (void)false_neighbours(series, {.lag = 10, .max_dimension = 10, .window = 5}); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("at least 220 samples, found 120")));
  EXPECT_THROW((void)cao_averages(series, {.lag = 0}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
