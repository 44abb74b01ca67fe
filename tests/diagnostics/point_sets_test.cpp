#include <slipmode/diagnostics/series/point_sets.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace slipmode::diagnostics {
namespace {

std::vector<double> normal_points(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> points(count);
  for (double& x : points) x = random.normal();
  return points;
}

TEST(Wasserstein, OfAShiftedSetIsTheShift) {
  const std::vector<double> a = normal_points(500, 1);
  std::vector<double> b = a;
  for (double& x : b) x += 0.375;
  std::reverse(b.begin(), b.end());
  EXPECT_NEAR(wasserstein(a, b), 0.375, 1e-14);
  EXPECT_EQ(wasserstein(a, a), 0.0);
}

TEST(Wasserstein, IgnoresHowOftenAWholeSetIsRepeated) {
  const std::vector<double> a = normal_points(7, 2);
  std::vector<double> twice = a;
  twice.insert(twice.end(), a.begin(), a.end());
  EXPECT_NEAR(wasserstein(a, twice), 0.0, 1e-16);
}

TEST(Wasserstein, OfUnequalSizesFollowsTheQuantileFunctions) {
  // F⁻¹ of {0, 1} is 0 then 1 at u = 1/2; of {0, 0, 3} it is 0 then 3 at u = 2/3:
  // |difference| = 0 on (0, 1/2), 1 on (1/2, 2/3), 2 on (2/3, 1).
  const std::vector<double> a = {1.0, 0.0};
  const std::vector<double> b = {0.0, 3.0, 0.0};
  EXPECT_NEAR(wasserstein(a, b), 1.0 / 6.0 + 2.0 / 3.0, 1e-15);
  EXPECT_EQ(wasserstein(a, b), wasserstein(b, a));
}

TEST(Wasserstein, EqualsTheAreaBetweenTheDistributionFunctions) {
  // Independent form ∫ |F_a(x) − F_b(x)| dx, summed exactly between neighbouring points.
  const std::vector<double> a = normal_points(113, 3);
  const std::vector<double> b = normal_points(57, 4);
  std::vector<double> all = a;
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end());
  const auto below = [](const std::vector<double>& set, double x) {
    const auto count = std::count_if(set.begin(), set.end(), [x](double y) { return y <= x; });
    return static_cast<double>(count) / static_cast<double>(set.size());
  };
  double area = 0.0;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    area += std::abs(below(a, all[i]) - below(b, all[i])) * (all[i + 1] - all[i]);
  }
  EXPECT_NEAR(wasserstein(a, b), area, 1e-14);
}

TEST(Hausdorff, IsTheWorstDistanceToTheNearestPoint) {
  const std::vector<double> a = {0.0, 1.0, 5.0};
  const std::vector<double> b = {0.1, 1.3};
  EXPECT_NEAR(hausdorff(a, b), 3.7, 1e-15);  // from 5 to 1.3
  EXPECT_EQ(hausdorff(a, b), hausdorff(b, a));
}

TEST(Hausdorff, EqualsTheBruteForceSearch) {
  const std::vector<double> a = normal_points(61, 5);
  const std::vector<double> b = normal_points(83, 6);
  const auto directed = [](const std::vector<double>& from, const std::vector<double>& to) {
    double worst = 0.0;
    for (const double x : from) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const double y : to) nearest = std::min(nearest, std::abs(x - y));
      worst = std::max(worst, nearest);
    }
    return worst;
  };
  EXPECT_EQ(hausdorff(a, b), std::max(directed(a, b), directed(b, a)));
}

TEST(PointSets, RefuseEmptySetsAndValuesThatAreNotFinite) {
  const std::vector<double> none;
  const std::vector<double> one = {1.0};
  const std::vector<double> bad = {1.0, std::nan("")};
  EXPECT_THROW((void)wasserstein(none, one), InvalidInput);
  EXPECT_THROW((void)hausdorff(one, none), InvalidInput);
  EXPECT_THROW((void)wasserstein(one, bad), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
