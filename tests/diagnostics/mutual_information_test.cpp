#include <slipmode/diagnostics/series/mutual_information.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

using Estimator = InformationEstimator;

TEST(MutualInformation, OfGaussianPairsIsTheClosedForm) {
  // I = −½ log₂(1 − ρ²) for jointly normal pairs; here ρ = 0.8ᵏ.
  const Series series = fixtures::autoregressive(20000, 0.8, 4);
  const auto result = mutual_information(series, {.max_lag = 4, .estimator = Estimator::kNearest});
  for (Eigen::Index lag = 1; lag <= 4; ++lag) {
    const double rho = std::pow(0.8, lag);
    EXPECT_NEAR(result.bits(lag), -0.5 * std::log2(1.0 - rho * rho), 0.02) << lag;
  }
  EXPECT_LT(result.error, 0.02);
}

TEST(MutualInformation, WithinEquiprobableBinsLosesLittle) {
  const Series series = fixtures::autoregressive(100000, 0.8, 4);
  const auto result = mutual_information(series, {.max_lag = 2, .bins = 32});
  // Cells lose what lies within them (I falls) and count by chance (I rises by about (bins − 1)²/(2 T ln 2) = 0.007).
  EXPECT_NEAR(result.bits(1), -0.5 * std::log2(1.0 - 0.64), 0.03);
}

TEST(MutualInformation, OfIndependentSamplesIsTheBiasOfTheBins) {
  // Miller's bias (bins − 1)²/(2 T ln 2) for the plug-in estimate; the bin-free one has none.
  const Series series = fixtures::white_noise(40000, 2);
  const double bias = 15.0 * 15.0 / (2.0 * 40000.0 * std::log(2.0));
  const auto bins = mutual_information(series, {.max_lag = 20});
  EXPECT_NEAR(bins.bits.tail(20).mean(), bias, 0.1 * bias);
  const auto none =
      mutual_information(fixtures::white_noise(5000, 2), {.max_lag = 20, .estimator = Estimator::kNearest});
  EXPECT_NEAR(none.bits.tail(20).mean(), 0.0, 0.01);
}

TEST(MutualInformation, AtLagZeroIsTheEntropyOfTheBins) {
  // Equiprobable bins of distinct samples hold equally many: log₂ bins.
  EXPECT_NEAR(mutual_information(fixtures::white_noise(4096, 1), {.max_lag = 2, .bins = 8}).bits(0), 3.0, 1e-12);
  // The logistic map at r = 4 lies below x with probability (2/π) asin √x: two bins halve it.
  const auto two =
      mutual_information(fixtures::logistic(4000, 4.0), {.max_lag = 2, .estimator = Estimator::kEqualWidth, .bins = 2});
  EXPECT_NEAR(two.bits(0), 1.0, 1e-3);
}

TEST(MutualInformation, OfTheLogisticMapInHalvesIsZero) {
  // Its symbols left and right of ½ are a fair coin's: knowing one tells nothing of the next.
  const auto result = mutual_information(fixtures::logistic(40000, 4.0), {.max_lag = 4, .bins = 2});
  EXPECT_LT(result.bits.tail(4).maxCoeff(), 5e-4);
}

TEST(MutualInformation, OfASecondOrderRecursionIsLeastWhereItsCorrelationVanishes) {
  // x'' = 2 a cos w x' − a² x + e: ρ_1 = 2 a cos w/(1 + a²), ρ_k = 2 a cos w ρ_{k−1} − a² ρ_{k−2}, and I falls with
  // |ρ|. a = 0.97, 40 samples per period: ρ_10 = 0.142, ρ_11 = 0.024, ρ_12 = −0.088.
  const double a = 0.97, c = 2.0 * a * std::cos(2.0 * std::numbers::pi / 40.0);
  Series series = fixtures::white_noise(40000, 12);
  for (Eigen::Index j = 2; j < series.values.size(); ++j) {
    series.values(j) += c * series.values(j - 1) - a * a * series.values(j - 2);
  }
  for (const auto estimator : {Estimator::kEqualWidth, Estimator::kEquiprobable}) {
    const auto result = mutual_information(series, {.max_lag = 30, .estimator = estimator});
    EXPECT_EQ(result.first_minimum, 11);
    for (const auto half : result.first_minimum_of_halves) EXPECT_LE(std::abs(half - 11), 1);
  }
}

TEST(MutualInformation, GivesLorenzItsKnownDelay) {
  // 0.16 to 0.18 units, the delay in use for x of Lorenz's system; bins and no bins must also agree with each other.
  const Series series = fixtures::lorenz(20000, 0.02);
  const auto bins = mutual_information(series, {.max_lag = 20, .bins = 32});
  const auto none = mutual_information(part(series, 0, 5000), {.max_lag = 15, .estimator = Estimator::kNearest});
  EXPECT_NEAR(static_cast<double>(bins.first_minimum) * 0.02, 0.17, 0.03);
  EXPECT_NEAR(static_cast<double>(none.first_minimum) * 0.02, 0.17, 0.03);
  for (const auto half : bins.first_minimum_of_halves) EXPECT_LE(std::abs(half - bins.first_minimum), 1);
}

TEST(MutualInformation, IsTheSameForAnyNumberOfThreads) {
  const Series series = fixtures::henon(2000);
  InformationOptions options{.max_lag = 9, .estimator = Estimator::kNearest};
  options.run.threads = 1;
  const auto one = mutual_information(series, options);
  options.run.threads = 3;
  EXPECT_EQ(one.bits.tail(9), mutual_information(series, options).bits.tail(9));
}

TEST(MutualInformation, RefusesTooFewSamples) {
  const Series series = fixtures::henon(100);
  EXPECT_THROW((void)mutual_information(series, {.max_lag = 50}), InvalidInput);
  EXPECT_THROW((void)mutual_information(series, {.max_lag = 5, .bins = 1}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
