#include <slipmode/diagnostics/series/exponent_spectrum.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/kaplan_yorke.hpp>
#include "fixtures/test_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

TEST(KaplanYorke, IsTheKnownDimensionOfTheKnownSpectra) {
  // From the equations: Lorenz 2.0622, Roessler 2.0133, Hénon 1.2583.
  EXPECT_NEAR(kaplan_yorke_dimension(Eigen::Vector3d(0.9056, 0.0, -14.5723)), 2.0622, 1e-4);
  EXPECT_NEAR(kaplan_yorke_dimension(Eigen::Vector3d(-5.3943, 0.0, 0.0714)), 2.0133, 2e-4);
  EXPECT_NEAR(kaplan_yorke_dimension(Eigen::Vector2d(0.4192, -1.6232)), 1.2583, 1e-4);
}

TEST(KaplanYorke, CountsACycleAsOneATorusAsTwoAndAPointAsNone) {
  EXPECT_EQ(kaplan_yorke_dimension(Eigen::Vector3d(0.0, -1.0, -2.0)), 1.0);
  EXPECT_EQ(kaplan_yorke_dimension(Eigen::Vector3d(0.0, 0.0, -2.0)), 2.0);
  EXPECT_EQ(kaplan_yorke_dimension(Eigen::Vector2d(-0.1, -2.0)), 0.0);
  EXPECT_EQ(kaplan_yorke_dimension(Eigen::Vector2d(0.1, 0.2)), 2.0);
}

TEST(KaplanYorke, TakesDirectionsThatStickLoses) {
  const double lost = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(kaplan_yorke_dimension(Eigen::Vector3d(0.3, lost, 0.0)), 2.0);
  EXPECT_THROW((void)kaplan_yorke_dimension(Eigen::Vector2d(-lost, 0.0)), InvalidInput);
  EXPECT_THROW((void)kaplan_yorke_dimension(Eigen::VectorXd()), InvalidInput);
}

TEST(ExponentSpectrum, OfTheLogisticMapIsLnTwo) {
  const auto result = exponent_spectrum(fixtures::logistic(5000, 4.0), {.embedding = {.dimension = 1}});
  EXPECT_NEAR(result.exponents(0), std::numbers::ln2, 0.01 * std::numbers::ln2);
}

TEST(ExponentSpectrum, OfHenonAddsUpToTheLogarithmOfItsContraction) {
  // λ_1 = 0.4192, λ_1 + λ_2 = ln 0.3 = −1.204 per step.
  const auto result = exponent_spectrum(fixtures::henon(20000), {.embedding = {.dimension = 2}});
  EXPECT_NEAR(result.exponents(0), 0.4192, 0.05 * 0.4192);
  EXPECT_LT(std::abs(result.exponents(0) - 0.4192), 3.0 * result.error(0));
  EXPECT_NEAR(result.exponents.sum(), std::log(0.3), 0.05);
  EXPECT_NEAR(result.dimension, 1.2583, 0.02);
}

TEST(ExponentSpectrum, OfRoesslerHasItsLargestWithinFivePercentAndAZero) {
  const auto result = exponent_spectrum(fixtures::roessler(20000, 0.4), {.embedding = {.dimension = 4, .lag = 3}});
  EXPECT_NEAR(result.exponents(0), 0.0714, 0.05 * 0.0714);
  EXPECT_NEAR(result.exponents(1), 0.0, 0.002);
  EXPECT_GT(result.exponents(0), 10.0 * result.error(0));
}

TEST(ExponentSpectrum, OfLorenzReadsLowByItsCurvature) {
  // Fitted Jacobians see the fold of x only to first order: measured 0.82 to 0.86 against 0.9056; divergence() does
  // better. The zero and the strong contraction are there.
  const auto result = exponent_spectrum(fixtures::lorenz(20000, 0.05), {.embedding = {.dimension = 3, .lag = 2}});
  EXPECT_NEAR(result.exponents(0), 0.9056, 0.12 * 0.9056);
  EXPECT_NEAR(result.exponents(1), 0.0, 0.1);
  EXPECT_NEAR(result.dimension, 2.0622, 0.02);
}

TEST(ExponentSpectrum, OfASineAndATorusIsZero) {
  const auto sine = exponent_spectrum(fixtures::sine(5000, 0.1), {.embedding = {.dimension = 2, .lag = 15}});
  EXPECT_LT(sine.exponents.cwiseAbs().maxCoeff(), 1e-3);
  const auto torus = exponent_spectrum(fixtures::two_torus(20000, 0.1), {.embedding = {.dimension = 4, .lag = 15}});
  EXPECT_LT(torus.exponents.cwiseAbs().maxCoeff(), 3e-3);
}

TEST(ExponentSpectrum, IsTheSameForAnyNumberOfThreads) {
  SpectrumOptions options{.embedding = {.dimension = 2}};
  options.run.threads = 1;
  const auto one = exponent_spectrum(fixtures::henon(2000), options);
  options.run.threads = 3;
  EXPECT_EQ(one.exponents, exponent_spectrum(fixtures::henon(2000), options).exponents);
  EXPECT_THROW((void)exponent_spectrum(fixtures::henon(2000), {.embedding = {.dimension = 8}, .neighbours = 10}),
               InvalidInput);
  EXPECT_THROW((void)exponent_spectrum(fixtures::henon(100), {.embedding = {.dimension = 2}}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
