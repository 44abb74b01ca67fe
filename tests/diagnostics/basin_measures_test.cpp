#include <slipmode/diagnostics/attractors/basin_measures.hpp>

#include <slipmode/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

/// Basins of one attractor, 0, where `inside` says so; else undecided.
template <class Inside>
orbits::Basins plane(int count, const Inside& inside) {
  orbits::Basins basins;
  basins.attractors.resize(1);
  for (int j = 0; j < count; ++j) {
    auto& row = basins.rows.emplace_back(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      if (inside((i + 0.5) / count, (j + 0.5) / count)) row[static_cast<std::size_t>(i)].attractor = 0;
    }
  }
  return basins;
}

// Discs put at random on a grid: their areas are π r². Of 400 the root mean square of deviation over error is 1 to 3.5
// %; crossings of a small disc miss its boundary's length by some per cent more.
TEST(BasinShares, ErrorsOfDiscsAreOfTheSizeOfTheirDeviations) {
  Random random(1);
  double square = 0.0;
  constexpr int kDiscs = 400;
  for (int k = 0; k < kDiscs; ++k) {
    const double r = random.uniform(0.1, 0.4), x0 = random.uniform(r, 1.0 - r), y0 = random.uniform(r, 1.0 - r);
    const BasinShare share =
        basin_shares(plane(60, [&](double x, double y) { return std::hypot(x - x0, y - y0) < r; })).front();
    square += std::pow((share.share - std::numbers::pi * r * r) / share.error, 2);
  }
  const double ratio = std::sqrt(square / kDiscs);
  EXPECT_NEAR(ratio, 1.0, 0.1);
}

TEST(BasinShares, CountTheUndecidedAndWhatMetAnEvent) {
  orbits::Basins basins = plane(4, [](double x, double) { return x < 0.5; });
  basins.rows[0][0].met_event = true;
  const auto shares = basin_shares(basins);
  ASSERT_EQ(shares.size(), 2U);
  EXPECT_EQ(shares[0].cells, 8U);
  EXPECT_DOUBLE_EQ(shares[0].met_event, 0.125);
  EXPECT_DOUBLE_EQ(shares[0].error, std::sqrt(4.0 * 0.05721) / 16.0);  // four rows, each crossed once
  EXPECT_EQ(shares[1].attractor, orbits::BasinCell::kUndecided);
  EXPECT_DOUBLE_EQ(shares[1].share, 0.5);
}

// Half of the plane in the gap with coordinates by column, 0.1 and 0.2; of the three cells of the strip one met a stop.
TEST(BasinMeasures, GiveTheRangeOfTheCoordinateAndWhatTheStripHolds) {
  orbits::Basins basins = plane(4, [](double x, double) { return x < 0.5; });
  EXPECT_FALSE(basin_measures(basins).strip);
  for (auto& row : basins.rows) {
    row[0].coordinate = 0.1;
    row[1].coordinate = 0.2;
  }
  basins.room = Eigen::MatrixXd::Constant(4, 4, -1.0);
  basins.room(0, 0) = basins.room(1, 0) = basins.room(2, 3) = 1.0;
  basins.rows[2][3].met_event = true;
  const BasinMeasures found = basin_measures(basins);
  EXPECT_EQ(found.shares[0].least_coordinate, 0.1);
  EXPECT_EQ(found.shares[0].largest_coordinate, 0.2);
  EXPECT_TRUE(std::isnan(found.shares[1].least_coordinate));
  ASSERT_TRUE(found.strip);
  EXPECT_DOUBLE_EQ(found.strip->share, 3.0 / 16.0);
  EXPECT_DOUBLE_EQ(found.strip->met_event, 1.0 / 3.0);
}

// A straight line of the plane: f = 2ε over the width that is looked at, 200 cells less 8 on either side.
TEST(BoundaryUncertainty, OfAStraightLineIsOne) {
  const BoundaryUncertainty found =
      boundary_uncertainty(plane(200, [](double x, double) { return x < 0.49; }).labels());
  ASSERT_EQ(found.displacement.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_DOUBLE_EQ(found.share[k], 2.0 * found.displacement[k] / 184.0);
  EXPECT_NEAR(found.exponent, 1.0, 1e-12);
}

// Middle-third Cantor set, its gaps' generations taking turns: f ~ ε^{1 − ln 2/ln 3} (McDonald et al.).
TEST(BoundaryUncertainty, OfACantorSetIsItsCodimension) {
  const auto generation_is_odd = [](double x, double) {
    for (int generation = 0; generation < 30; ++generation) {
      x *= 3.0;
      if (x > 1.0 && x < 2.0) return generation % 2 == 1;
      if (x >= 2.0) x -= 2.0;
    }
    return false;
  };
  const BoundaryUncertainty found = boundary_uncertainty(plane(729, generation_is_odd).labels());
  EXPECT_NEAR(found.exponent, 1.0 - std::numbers::ln2 / std::log(3.0), 3.0 * found.error);
  EXPECT_LT(found.error, 0.05);
}

TEST(BoundaryUncertainty, NeedsThreeShares) {
  EXPECT_TRUE(std::isnan(boundary_uncertainty(plane(20, [](double x, double) { return x < 0.5; }).labels()).exponent));
  EXPECT_TRUE(std::isnan(boundary_uncertainty(plane(200, [](double, double) { return true; }).labels()).exponent));
}

}  // namespace
}  // namespace slipmode::diagnostics
