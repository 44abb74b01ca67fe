#include <slipmode/diagnostics/series/series.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Autocorrelation, IsTheSumItsDefinitionSays) {
  const Series series = fixtures::white_noise(101, 3);
  const Eigen::ArrayXd x = series.values.array() - series.values.mean();
  const Eigen::VectorXd rho = autocorrelation(series, 100);
  for (const Eigen::Index k : {0, 1, 17, 99, 100}) {
    EXPECT_NEAR(rho(k), (x.head(101 - k) * x.tail(101 - k)).sum() / x.square().sum(), 1e-14) << k;
  }
}

TEST(Autocorrelation, OfAFirstOrderRecursionIsGeometric) {
  // ρ_k = 0.9ᵏ; standard error of the estimate about sqrt((1 + a²)/((1 − a²) T)) = 0.007 for T = 200,000.
  const Eigen::VectorXd rho = autocorrelation(fixtures::autoregressive(200000, 0.9, 5), 20);
  for (const Eigen::Index k : {1, 5, 10, 20}) EXPECT_NEAR(rho(k), std::pow(0.9, k), 0.02) << k;
}

TEST(Autocorrelation, FallsBelowOneOverEWhereTheRecursionSays) {
  // 0.9⁹ = 0.387, 0.9¹⁰ = 0.349, 1/e = 0.368.
  EXPECT_EQ(decorrelation_lag(fixtures::autoregressive(400000, 0.9, 5)), 10);
}

TEST(MeanPeriod, OfASineIsItsPeriodEvenUnderNoise) {
  Series series = fixtures::sine(20000, 0.05);
  const double expected = 2.0 * std::numbers::pi / 0.05;
  EXPECT_NEAR(mean_period(series), expected, 1.0);  // 159 whole periods in 20,000 samples
  series.values += 0.01 * fixtures::white_noise(20000, 8).values;
  EXPECT_NEAR(mean_period(series), expected, 1.0);
  EXPECT_EQ(theiler_window(series), static_cast<Eigen::Index>(std::ceil(mean_period(series))));
}

TEST(UniformSeries, TakesTheMeanInterval) {
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(11, 5.0, 6.0);
  const Series series = uniform_series(times, times.cwiseAbs2(), "speed");
  EXPECT_NEAR(series.interval, 0.1, 1e-15);
  EXPECT_EQ(series.values(3), times(3) * times(3));
  EXPECT_EQ(series.name, "speed");
}

TEST(UniformSeries, NamesTheGapAndTheUnevenStep) {
  Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(11, 0.0, 10.0);
  times.tail(4).array() += 3.0;
  EXPECT_THAT([&] { (void)uniform_series(times, times, "speed"); },
              ThrowsMessage<InvalidInput>(AllOf(HasSubstr("samples 6 and 7"), HasSubstr("gap of about 3 samples"))));
  times = Eigen::VectorXd::LinSpaced(11, 0.0, 10.0);
  times(4) += 0.1;
  EXPECT_THAT([&] { (void)uniform_series(times, times, "speed"); },
              ThrowsMessage<InvalidInput>(AllOf(HasSubstr("samples 3 and 4"), HasSubstr("1.1"))));
  EXPECT_THROW((void)uniform_series(times, times.head(3), "speed"), InvalidInput);
  times(4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { (void)uniform_series(times, times, "speed"); },
              ThrowsMessage<InvalidInput>(HasSubstr("at sample 4")));
}

TEST(CheckSeries, SaysWhatWouldDo) {
  Series series{.values = Eigen::VectorXd::LinSpaced(10, 0.0, 1.0), .name = "v1"};
  EXPECT_NO_THROW(check_series(series, 10, "dimension"));
  EXPECT_THAT([&] { check_series(series, 500, "dimension"); },
              ThrowsMessage<InvalidInput>(HasSubstr("dimension of v1: expected at least 500 samples, found 10")));
  series.values(7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { check_series(series, 2, "dimension"); }, ThrowsMessage<InvalidInput>(HasSubstr("at sample 7")));
  series.values.setConstant(2.5);
  EXPECT_THAT([&] { check_series(series, 2, "dimension"); },
              ThrowsMessage<InvalidInput>(HasSubstr("found 2.5 throughout")));
  series.values(0) = 2.0;
  series.interval = 0.0;
  EXPECT_THROW(check_series(series, 2, "dimension"), InvalidInput);
}

TEST(Series, HalvesAreConsecutiveAndOfEqualLength) {
  const Series series{.values = Eigen::VectorXd::LinSpaced(7, 0.0, 6.0), .interval = 0.5};
  EXPECT_EQ(first_half(series).values, Eigen::Vector3d(0.0, 1.0, 2.0));
  EXPECT_EQ(second_half(series).values, Eigen::Vector3d(3.0, 4.0, 5.0));
  EXPECT_EQ(second_half(series).interval, 0.5);
  EXPECT_THROW((void)part(series, 5, 3), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
