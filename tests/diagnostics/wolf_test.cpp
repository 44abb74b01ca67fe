#include <slipmode/diagnostics/series/wolf.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

TEST(Wolf, OfHenonIsWithinFivePercentFrom20000Points) {
  const auto result = wolf_exponent(fixtures::henon(20000), {.embedding = {.dimension = 2}, .angle = 0.2});
  EXPECT_NEAR(result.nats, 0.4192, 0.05 * 0.4192);
  EXPECT_LT(result.error, 0.01);
  EXPECT_NEAR(result.bits, result.nats / std::numbers::ln2, 1e-15);
  EXPECT_EQ(result.kept, 0);
}

TEST(Wolf, OfTheLogisticMapIsOneBitPerStep) {
  const auto result = wolf_exponent(fixtures::logistic(10000, 4.0), {.embedding = {.dimension = 1}, .evolution = 2});
  EXPECT_NEAR(result.bits, 1.0, 0.02);
}

TEST(Wolf, OfLorenzReadsHighAndHigherTheMoreOftenPairsAreReplaced) {
  // Each replacement turns the vector by up to `angle`, which adds growth. Records scatter by 0.03 about a mean of
  // 0.99, so that one alone says little: limits are six standard deviations of a mean of four away.
  const auto mean_over_records = [](Eigen::Index evolution) {
    const WolfOptions options{.embedding = {.dimension = 3, .lag = 3}, .evolution = evolution, .angle = 0.2};
    double sum = 0.0;
    for (const double x0 : {1.0, 1.1, 1.2, 1.3}) sum += wolf_exponent(fixtures::lorenz(20000, 0.05, x0), options).nats;
    return sum / 4.0;
  };
  const double seldom = mean_over_records(20);
  EXPECT_GT(mean_over_records(5), seldom);
  EXPECT_GT(seldom, 0.9056);
  EXPECT_LT(seldom, 1.2 * 0.9056);
}

TEST(Wolf, OfATorusIsZero) {
  const auto result = wolf_exponent(fixtures::two_torus(20000, 0.2),
                                    {.embedding = {.dimension = 4, .lag = 8}, .evolution = 10, .angle = 0.2});
  EXPECT_LT(std::abs(result.nats), 0.002);
}

TEST(Wolf, RefusesAFloorAboveTheSet) {
  EXPECT_THROW((void)wolf_exponent(fixtures::henon(1000), {.smallest = 10.0, .largest = 20.0}), NumericalFailure);
  EXPECT_THROW((void)wolf_exponent(fixtures::henon(1000), {.evolution = 0}), InvalidInput);
  EXPECT_THROW((void)wolf_exponent(fixtures::henon(150), {}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
