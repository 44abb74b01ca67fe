#include <slipmode/diagnostics/series/neighbours.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>
#include "fixtures/test_series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::diagnostics {

static void PrintTo(Norm metric, std::ostream* out) { *out << (metric == Norm::kMaximum ? "maximum" : "Euclidean"); }

namespace {

/// Every allowed point by distance, then index: what any search must agree with.
std::vector<Neighbour> by_brute_force(const Eigen::MatrixXd& points, Norm metric, Eigen::Index i,
                                      const NeighbourTree::Allowed& allowed) {
  std::vector<Neighbour> all;
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    if (std::abs(i - j) <= allowed.window || (allowed.limit >= 0 && j >= allowed.limit)) continue;
    const Eigen::VectorXd d = points.col(i) - points.col(j);
    all.push_back({j, metric == Norm::kEuclidean ? std::sqrt(d.squaredNorm()) : d.lpNorm<Eigen::Infinity>()});
  }
  std::sort(all.begin(), all.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::tie(a.distance, a.index) < std::tie(b.distance, b.index);
  });
  return all;
}

class NeighbourTreeOf : public ::testing::TestWithParam<std::tuple<int, Norm>> {};

TEST_P(NeighbourTreeOf, AgreesWithBruteForce) {
  const auto [dimension, metric] = GetParam();
  Random random(7);
  Eigen::MatrixXd points(dimension, 700);
  // A coarse grid, so that many distances tie and many points coincide.
  for (double& x : points.reshaped()) x = std::round(4.0 * random.normal()) / 4.0;
  const NeighbourTree tree(points, metric);
  for (const NeighbourTree::Allowed allowed : {NeighbourTree::Allowed{}, {.window = 40}, {.window = 5, .limit = 200}}) {
    for (Eigen::Index i = 0; i < points.cols(); i += 13) {
      const auto all = by_brute_force(points, metric, i, allowed);
      const auto nearest = tree.nearest(i, 9, allowed);
      ASSERT_EQ(nearest.size(), 9u);
      for (std::size_t k = 0; k < 9; ++k) {
        EXPECT_EQ(nearest[k].index, all[k].index);
        EXPECT_NEAR(nearest[k].distance, all[k].distance, 1e-14);
      }
      // A radius between two steps of the grid, so that rounding decides nothing.
      const auto inside = tree.within(i, 0.8, allowed);
      EXPECT_EQ(inside.size(), static_cast<std::size_t>(std::count_if(
                                   all.begin(), all.end(), [](const Neighbour& n) { return n.distance <= 0.8; })));
      EXPECT_TRUE(std::is_sorted(inside.begin(), inside.end(),
                                 [](const Neighbour& a, const Neighbour& b) { return a.index < b.index; }));
    }
  }
}

TEST_P(NeighbourTreeOf, CountsAsManyAsItFinds) {
  const auto [dimension, metric] = GetParam();
  Random random(11);
  Eigen::MatrixXd points(dimension, 900);
  for (double& x : points.reshaped()) x = random.normal();
  const NeighbourTree tree(points, metric);
  const std::vector<double> radii{0.01, 0.1, 0.3, 0.7, 1.0, 2.0, 20.0};
  const Shells shells = tree.shells(radii);
  for (Eigen::Index i = 0; i < points.cols(); i += 29) {
    std::vector<std::int64_t> counts(shells.count(), 0);
    (void)tree.add_shells(i, shells, counts);
    std::partial_sum(counts.begin(), counts.end(), counts.begin());
    for (std::size_t r = 0; r < radii.size(); ++r) {
      EXPECT_EQ(counts[r], 1 + static_cast<std::int64_t>(tree.within(i, radii[r], {}).size()));
    }
    EXPECT_EQ(counts.back(), points.cols());
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, NeighbourTreeOf,
                         ::testing::Combine(::testing::Values(1, 2, 3, 6),
                                            ::testing::Values(Norm::kEuclidean, Norm::kMaximum)),
                         [](const auto& one) {
                           const bool maximum = std::get<1>(one.param) == Norm::kMaximum;
                           return std::to_string(std::get<0>(one.param)) + (maximum ? "Maximum" : "Euclidean");
                         });

TEST(NeighbourTree, RefusesPointsThatAreNotFinite) {
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(2, 3);
  points(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(NeighbourTree(points, Norm::kMaximum), InvalidInput);
  EXPECT_THROW(NeighbourTree(Eigen::MatrixXd(2, 0), Norm::kMaximum), InvalidInput);
}

TEST(DelayVectors, AreTheSamplesTheDefinitionSays) {
  const Series series = fixtures::logistic(50, 4.0);
  const Eigen::MatrixXd vectors = delay_vectors(series, {.dimension = 3, .lag = 7});
  ASSERT_EQ(vectors.cols(), 50 - 14);
  for (const Eigen::Index i : {0, 20, 35}) {
    EXPECT_EQ(vectors.col(i), Eigen::Vector3d(series.values(i), series.values(i + 7), series.values(i + 14)));
  }
  EXPECT_THROW((void)delay_vectors(series, {.dimension = 0, .lag = 7}), InvalidInput);
  EXPECT_THROW((void)delay_vectors(series, {.dimension = 8, .lag = 7}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
