#include "diagnostics/series/internal/close_pairs.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/shells.hpp>
#include "fixtures/test_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace slipmode::diagnostics {
namespace {

/// Pairs by their definition, block by block.
ClosePairs by_definition(const Eigen::MatrixXd& points, const std::vector<double>& radii, const PairOptions& options) {
  const Eigen::Index n = points.cols(), references = options.references == 0 ? n : options.references;
  ClosePairs out;
  out.counts.setZero(static_cast<Eigen::Index>(radii.size()), options.blocks);
  for (Eigen::Index b = 0; b < options.blocks; ++b) {
    for (Eigen::Index r = b * references / options.blocks; r < (b + 1) * references / options.blocks; ++r) {
      const Eigen::Index i = r * n / references;
      for (Eigen::Index j = 0; j < n; ++j) {
        if (std::abs(i - j) <= options.window) continue;
        double distance = 0.0;
        for (Eigen::Index k = 0; k < points.rows(); ++k) {
          distance = std::max(distance, std::abs(points(k, i) - points(k, j)));
        }
        for (std::size_t k = 0; k < radii.size(); ++k) {
          if (distance <= radii[k]) ++out.counts(static_cast<Eigen::Index>(k), b);
        }
      }
    }
  }
  return out;
}

std::vector<double> radii_of(const Series& series, int count) {
  const double range = series.values.maxCoeff() - series.values.minCoeff();
  std::vector<double> radii;
  for (int k = 0; k < count; ++k) radii.push_back(range * std::pow(1e-3, 1.0 - static_cast<double>(k) / (count - 1)));
  return radii;
}

Series on_a_grid() {  // distances tie, among them and with the radii
  Series series = fixtures::white_noise(700, 3);
  for (double& x : series.values) x = std::round(8.0 * x) / 8.0;
  return series;
}

class ClosePairsOf : public ::testing::TestWithParam<int> {
 protected:
  [[nodiscard]] static Series series() {
    switch (GetParam()) {
      case 0:
        return fixtures::white_noise(700, 5);
      case 1:
        return fixtures::sine(700, 0.0517);
      case 2:
        return fixtures::lorenz(700, 0.05);
      case 3:
        return fixtures::henon(700);
      default:
        return on_a_grid();
    }
  }
};

TEST_P(ClosePairsOf, AreTheSameByTreeAllPairsAndDefinition) {
  const Series record = series();
  std::vector<double> radii = radii_of(record, 24);
  if (GetParam() == 4) radii = {0.0, 0.125, 0.25, 0.25, 1.0, 2.0};
  for (const int dimension : {1, 2, 3, 6, 10}) {
    const Eigen::MatrixXd points = delay_vectors(record, {.dimension = dimension, .lag = 3});
    for (const Eigen::Index window : {0, 1, 40, 500}) {
      for (const Eigen::Index references : {0, 77}) {
        PairOptions options{.window = window, .references = references, .blocks = 7};
        const ClosePairs expected = by_definition(points, radii, options);
        for (const PairMethod method : {PairMethod::kTree, PairMethod::kAllPairs, PairMethod::kFaster}) {
          options.method = method;
          EXPECT_EQ(close_pairs(points, radii, options).counts, expected.counts)
              << dimension << " dimensions, window " << window << ", " << references << " references, method "
              << static_cast<int>(method);
        }
      }
    }
  }
}

TEST_P(ClosePairsOf, AreTheSameForAnyNumberOfThreads) {
  const Series record = series();
  const Eigen::MatrixXd points = delay_vectors(record, {.dimension = 4, .lag = 2});
  const std::vector<double> radii = radii_of(record, 48);
  for (const PairMethod method : {PairMethod::kTree, PairMethod::kAllPairs}) {
    PairOptions options{.window = 10, .method = method};
    options.run.threads = 1;
    const auto one = close_pairs(points, radii, options);
    options.run.threads = 3;
    EXPECT_EQ(one.counts, close_pairs(points, radii, options).counts);
  }
}

std::string record_name(const testing::TestParamInfo<int>& info) {
  constexpr std::array kNames = {"WhiteNoise", "Sine", "Lorenz", "Henon", "Grid"};
  return kNames.at(static_cast<std::size_t>(info.param));
}

INSTANTIATE_TEST_SUITE_P(NoiseSineLorenzHenonGrid, ClosePairsOf, ::testing::Range(0, 5), record_name);

TEST(ClosePairs, AreFoundByTheTreeWhereMostAreFarApartAndOneByOneWhereItPrunesNothing) {
  const Series line = fixtures::sine(20000, 0.0517), noise = fixtures::white_noise(20000, 5);
  const std::vector<double> small{0.001, 0.01}, large{1.0, 2.0, 3.0, 4.0};
  const PairOptions options{.references = 500};
  EXPECT_EQ(close_pairs(delay_vectors(line, {.dimension = 2, .lag = 20}), small, options).method, PairMethod::kTree);
  EXPECT_EQ(close_pairs(delay_vectors(noise, {.dimension = 8}), large, options).method, PairMethod::kAllPairs);
}

TEST(ClosePairs, RefuseWhatDoesNotFit) {
  const Eigen::MatrixXd points = Eigen::MatrixXd::Zero(2, 30);
  const std::vector<double> radii{1.0, 2.0}, falling{2.0, 1.0};
  EXPECT_THAT([&] { (void)close_pairs(points, radii, {.references = 31}); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("found 0, 31 and 64")));
  EXPECT_THROW((void)close_pairs(points, radii, {.window = -1}), InvalidInput);
  EXPECT_THROW((void)close_pairs(points, falling, {}), InvalidInput);
  EXPECT_THROW((void)close_pairs(points, std::vector<double>{}, {}), InvalidInput);
}

TEST(Shells, AreTheNumberOfRadiiBelow) {
  Random random(19);
  const double huge = std::numeric_limits<double>::max(), infinity = std::numeric_limits<double>::infinity();
  const double tiny = std::numeric_limits<double>::denorm_min();
  std::vector<std::vector<double>> sets{
      {1.0}, {0.0}, {-0.0, tiny}, {0.0, 1.0, 1.0, 1.0, 2.0}, {1.0, 1.0 + 1e-15, 1.5}, {tiny, 1.0, huge}, {}};
  for (int k = 0; k < 5000; ++k) sets.back().push_back(std::exp(random.normal()));
  std::sort(sets.back().begin(), sets.back().end());
  for (const std::vector<double>& radii : sets) {
    const Shells shells(radii);
    ASSERT_EQ(shells.count(), radii.size() + 1);
    std::vector<double> distances{0.0, tiny, 0.5, huge, infinity};
    for (const double r : radii) {
      distances.insert(distances.end(), {std::abs(r), std::nextafter(r, infinity), std::abs(std::nextafter(r, 0.0))});
    }
    for (int k = 0; k < 1000; ++k) distances.push_back(std::exp(random.normal()));
    std::vector<std::int64_t> expected(shells.count(), 0), four(4 * shells.count(), 0);
    for (const double d : distances) {
      const auto below = std::lower_bound(radii.begin(), radii.end(), d) - radii.begin();
      EXPECT_EQ(shells.of(d), static_cast<std::size_t>(below)) << d;
      ++expected[static_cast<std::size_t>(below)];
    }
    std::vector<std::uint32_t> scratch(distances.size());
    shells.add(distances.data(), distances.size(), scratch.data(), four.data());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_EQ(four[4 * k] + four[4 * k + 1] + four[4 * k + 2] + four[4 * k + 3], expected[k]);
    }
  }
}

}  // namespace
}  // namespace slipmode::diagnostics
