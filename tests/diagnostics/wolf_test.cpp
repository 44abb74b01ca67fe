#include "diagnostics/wolf.hpp"

#include "core/errors.hpp"
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

TEST(Wolf, OfLorenzIsWithinTenPercentOnceAReplacementSeldomTurns) {
  // Each replacement turns the vector by up to `angle`, which adds growth: the same record reads higher when pairs are
  // replaced three times as often.
  const Series series = fixtures::lorenz(20000, 0.05);
  WolfOptions options{.embedding = {.dimension = 3, .lag = 3}, .evolution = 20, .angle = 0.2};
  const double seldom = wolf_exponent(series, options).nats;
  options.evolution = 5;
  EXPECT_GT(wolf_exponent(series, options).nats, seldom);
  EXPECT_NEAR(seldom, 0.9056, 0.1 * 0.9056);
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
