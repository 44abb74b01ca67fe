#include <slipmode/orbits/close_returns.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

/// x → 4x(1 − x): chaotic, with every periodic point known.
Eigen::MatrixXd logistic_orbit(Eigen::Index count) {
  Eigen::MatrixXd points(1, count);
  double x = 0.3;
  for (double& point : points.reshaped()) {
    point = x;
    x = 4.0 * x * (1.0 - x);
  }
  return points;
}

/// A closed path of two turns, 2a apart in the plane and up to 1 across it, which never meets itself.
Eigen::MatrixXd doubled_circle(Eigen::Index turns, Eigen::Index per_turn, double a) {
  Eigen::MatrixXd points(3, turns * per_turn);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(per_turn);
    points.col(k) << std::cos(phase) + a * std::cos(0.5 * phase), std::sin(phase) + a * std::sin(0.5 * phase),
        (a > 0.0 ? 0.5 : 0.0) * std::sin(0.5 * phase);
  }
  return points;
}

// Fixed points of 4x(1 − x): 0 and 3/4. A point x with |f(x) − x| = d lies within about d/|f' − 1| of one: f' = 4, −2.
TEST(SectionReturns, OfLengthOneLieAtFixedPointsOfTheMap) {
  const Eigen::MatrixXd points = logistic_orbit(20000);
  const auto returns = section_returns(points, {.max_length = 1, .threshold = 1e-3, .per_length = 5});
  ASSERT_EQ(returns.size(), 5U);
  for (const CloseReturn& found : returns) {
    const double x = points(0, found.begin);
    EXPECT_LT(std::min(std::abs(x), std::abs(x - 0.75)), 0.5 * found.distance);
    EXPECT_DOUBLE_EQ(found.distance, std::abs(points(0, found.begin + 1) - x));
  }
}

// Points of least period 2: (5 ± √5)/8, where (f²)' = −4. Fixed points repeat after two steps too, but length 1
// explains them.
TEST(SectionReturns, OfLengthTwoLeaveOutFixedPoints) {
  const Eigen::MatrixXd points = logistic_orbit(20000);
  const auto returns = section_returns(points, {.min_length = 2, .max_length = 2, .threshold = 1e-3, .per_length = 5});
  ASSERT_EQ(returns.size(), 5U);
  const double high = (5.0 + std::sqrt(5.0)) / 8.0;
  const double low = (5.0 - std::sqrt(5.0)) / 8.0;
  for (const CloseReturn& found : returns) {
    const double x = points(0, found.begin);
    EXPECT_LT(std::min(std::abs(x - low), std::abs(x - high)), 0.25 * found.distance);
  }
}

// The map has two fixed points, 0 and 3/4: of all stretches of length 1 within 0.1 of each other one is kept.
TEST(SectionReturns, ApartKeepOneStretchOfEachOrbit) {
  const Eigen::MatrixXd points = logistic_orbit(20000);
  const auto returns = section_returns(points, {.max_length = 1, .threshold = 1e-3, .per_length = 50, .apart = 0.1});
  ASSERT_EQ(returns.size(), 2U);
  EXPECT_GT(std::abs(points(0, returns[0].begin) - points(0, returns[1].begin)), 0.7);
}

// A sequence that repeats after five points follows one orbit all the time: returns must begin more than five apart.
TEST(SectionReturns, CountAStretchThatFollowsOneOrbitOnce) {
  Eigen::MatrixXd points(1, 30);
  for (Eigen::Index k = 0; k < 30; ++k) points(0, k) = static_cast<double>(k * k % 5 + k % 5);
  const auto returns = section_returns(points, {.max_length = 5, .threshold = 1e-9});
  ASSERT_FALSE(returns.empty());
  for (std::size_t k = 0; k < returns.size(); ++k) {
    EXPECT_EQ(returns[k].length, 5);
    EXPECT_EQ(returns[k].begin, static_cast<Eigen::Index>(6 * k));
  }
}

// Near sin ωt/2 = 0 the path passes within 2a of itself after one turn; it closes after two.
TEST(PathReturns, FindThePeriodOfAPath) {
  const auto once = path_returns(doubled_circle(8, 200, 0.1), {.max_length = 1000, .threshold = 0.3});
  const auto twice = path_returns(doubled_circle(8, 200, 0.1), {.max_length = 1000, .threshold = 0.1});
  ASSERT_FALSE(once.empty());
  ASSERT_EQ(twice.size(), 1U);
  EXPECT_NEAR(static_cast<double>(once.front().length), 200.0, 10.0);
  EXPECT_EQ(twice.front().length, 400);
  EXPECT_LT(twice.front().distance, 1e-12);
}

TEST(PathReturns, WaitUntilThePathHasLeft) {
  const auto returns = path_returns(doubled_circle(4, 100, 0.0), {.max_length = 300, .threshold = 0.5});
  ASSERT_EQ(returns.size(), 1U);
  EXPECT_EQ(returns.front().length, 100);
}

// Chords of a circle of radius 1 with M points are 2 sin(π/M) long.
TEST(PathReturns, ThresholdOfTheThesisIsHalfTheMeanStep) {
  EXPECT_NEAR(half_mean_step(doubled_circle(3, 50, 0.0)), std::sin(std::numbers::pi / 50.0), 1e-12);
}

// Two delayed values of a sine a quarter period apart are a circle: it closes after one period.
TEST(PathReturns, OfASineInDelayCoordinatesCloseAfterItsPeriod) {
  diagnostics::Series series{.values = Eigen::VectorXd(500)};
  for (Eigen::Index k = 0; k < 500; ++k) {
    series.values(k) = std::sin(2.0 * std::numbers::pi * static_cast<double>(k) / 80.0);
  }
  const Eigen::MatrixXd points = diagnostics::delay_vectors(series, {.dimension = 2, .lag = 20});
  const auto returns = path_returns(points, {.max_length = 200, .threshold = half_mean_step(points)});
  ASSERT_EQ(returns.size(), 1U);
  EXPECT_EQ(returns.front().length, 80);
}

TEST(CloseReturns, RefuseOptionsOutOfRange) {
  const Eigen::MatrixXd points = logistic_orbit(10);
  EXPECT_THROW((void)section_returns(points, {.min_length = 0}), InvalidInput);
  EXPECT_THROW((void)section_returns(points, {.min_length = 3, .max_length = 2}), InvalidInput);
  EXPECT_THROW((void)path_returns(points, {.threshold = 0.0}), InvalidInput);
  EXPECT_THROW((void)path_returns(points.leftCols(1), {}), InvalidInput);
  Eigen::MatrixXd broken = points;
  broken(0, 3) = std::nan("");
  EXPECT_THROW((void)section_returns(broken, {}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
