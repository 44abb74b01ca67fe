#include <slipmode/diagnostics/series/surrogates.hpp>

#include <slipmode/core/errors.hpp>
#include "diagnostics/series/internal/fourier.hpp"
#include "fixtures/test_series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace slipmode::diagnostics {
namespace {

Eigen::VectorXd amplitudes(const Series& series) {
  return RealTransform(series.values.size()).forward(series.values).cwiseAbs();
}

std::vector<double> sorted(const Series& series) {
  std::vector<double> out(series.values.begin(), series.values.end());
  std::sort(out.begin(), out.end());
  return out;
}

/// Relative difference of two amplitude spectra.
double spectral_distance(const Series& a, const Series& b) {
  return (amplitudes(a) - amplitudes(b)).tail(a.values.size() / 2).norm() /
         amplitudes(a).tail(a.values.size() / 2).norm();
}

// X_k by the sum that defines it, for lengths that are even, odd, prime and powers of two.
TEST(Fourier, IsTheSumThatDefinesIt) {
  for (const Eigen::Index n : {1, 2, 3, 15, 64, 210, 1009}) {
    const Eigen::VectorXd x = fixtures::white_noise(n, 5).values;
    const Eigen::VectorXcd X = RealTransform(n).forward(x);
    for (Eigen::Index k = 0; k <= n / 2; ++k) {
      std::complex<double> sum = 0.0;
      for (Eigen::Index j = 0; j < n; ++j) {
        sum +=
            x(j) * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(j * k % n) / static_cast<double>(n));
      }
      EXPECT_LT(std::abs(X(k) - sum), 1e-12 * x.norm()) << "length " << n << ", k = " << k;
    }
  }
}

TEST(Fourier, InverseUndoesForwardForEvenAndOddLengths) {
  for (const Eigen::Index n : {1, 2, 15, 64}) {
    const Eigen::VectorXd x = fixtures::white_noise(n, 5).values;
    RealTransform transform(n);
    const Eigen::VectorXcd X = transform.forward(x);
    EXPECT_EQ(X.size(), n / 2 + 1);
    EXPECT_NEAR(std::abs(X(0) - x.sum()), 0.0, 1e-13);
    EXPECT_LT((transform.inverse(X) - x).norm(), 1e-14 * static_cast<double>(n));
  }
  EXPECT_THROW(RealTransform(0), InvalidInput);
}

TEST(Surrogates, KeepWhatTheirKindPromises) {
  for (const Eigen::Index count : {1000, 1001}) {
    const Series series = fixtures::lorenz(count, 0.1);
    Random random(17);
    const Series phase = surrogate(series, SurrogateKind::kPhase, random);
    EXPECT_LT(spectral_distance(series, phase), 1e-12);
    EXPECT_GT((phase.values - series.values).norm(), 0.5 * series.values.norm());
    const Series adjusted = surrogate(series, SurrogateKind::kAmplitude, random);
    EXPECT_EQ(sorted(adjusted), sorted(series));
    const Series iterated = surrogate(series, SurrogateKind::kIterated, random);
    EXPECT_EQ(sorted(iterated), sorted(series));
    EXPECT_LT(spectral_distance(series, iterated), 0.05);
    EXPECT_LT(spectral_distance(series, iterated), spectral_distance(series, adjusted));
  }
}

TEST(Surrogates, DependOnTheSeedAlone) {
  const Series series = fixtures::henon(500);
  Random one(4), again(4), other(5);
  const auto first = surrogate(series, SurrogateKind::kIterated, one).values;
  EXPECT_EQ(first, surrogate(series, SurrogateKind::kIterated, again).values);
  EXPECT_NE(first, surrogate(series, SurrogateKind::kIterated, other).values);
}

TEST(ForecastError, OfAStationaryRecursionIsItsInnovation) {
  // The best forecast of x' = a x + e misses by e: √(1 − a²) deviations; a mean over five neighbours by √(1 + 1/5) of
  // it.
  const Series series = fixtures::autoregressive(20000, 0.9, 6);
  EXPECT_NEAR(forecast_error(series, {.dimension = 1}, 1, 20, 4000), std::sqrt((1.0 - 0.81) * 1.2), 0.02);
}

TEST(SurrogateTest, RejectsNoiseForChaosAndNotForNoise) {
  const auto henon = surrogate_test(fixtures::henon(2000), {.embedding = {.dimension = 2}});
  EXPECT_TRUE(henon.rejected);
  EXPECT_EQ(henon.rank, 0);
  EXPECT_DOUBLE_EQ(henon.p, 0.05);
  EXPECT_GT(henon.distance, 10.0);
  const auto lorenz =
      surrogate_test(fixtures::lorenz(4000, 0.1), {.embedding = {.dimension = 3, .lag = 2}, .ahead = 2});
  EXPECT_TRUE(lorenz.rejected);
  int rejected = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Series noise = fixtures::autoregressive(500, 0.7, seed);
    rejected += surrogate_test(noise, {.embedding = {.dimension = 2}, .references = 200}).rejected ? 1 : 0;
  }
  EXPECT_LE(rejected, 4);  // expected 1 of 20; more than 4 has probability 0.3 %
}

TEST(SurrogateTest, IsTheSameForAnyNumberOfThreads) {
  SurrogateOptions options{.embedding = {.dimension = 2}};
  options.run.threads = 1;
  const auto one = surrogate_test(fixtures::henon(500), options);
  options.run.threads = 3;
  EXPECT_EQ(one.of_surrogates, surrogate_test(fixtures::henon(500), options).of_surrogates);
  options.surrogates = 10;
  EXPECT_THROW((void)surrogate_test(fixtures::henon(500), options), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
