#include <slipmode/core/timing.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace slipmode {
namespace {

TEST(Median, IsTheMiddleValueOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({7.0}), 7.0);
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0}), 2.5);
  EXPECT_EQ(median({9.0, 1.0, 4.0, 2.0}), 3.0);
  EXPECT_EQ(median({5.0, 5.0, 1.0, 5.0}), 5.0);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Median, OfTimesIsThatOfEach) {
  const Times middle = median_times({{.wall = 1.0, .cpu = 6.0}, {.wall = 3.0, .cpu = 4.0}});
  EXPECT_EQ(middle.wall, 2.0);
  EXPECT_EQ(middle.cpu, 5.0);
}

}  // namespace
}  // namespace slipmode
