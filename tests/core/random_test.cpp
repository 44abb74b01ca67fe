#include <slipmode/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace slipmode {
namespace {

TEST(SplitMix64, GivesThePublishedFirstValues) {
  // Output of Vigna's splitmix64.c for seeds 0 and 1234567.
  EXPECT_EQ(splitmix64(0), 0xE220A8397B1DCDAFULL);
  EXPECT_EQ(splitmix64(1234567), 6457827717110365317ULL);
}

TEST(Random, MapsMersenneTwisterDrawsToTheseNumbersOnEveryPlatform) {
  // From a separate program in Python, whose generator gives the standard's 10,000th value 9981545732273789042.
  Random random(1);
  EXPECT_EQ(random.uniform(), 0.13387664401253263);
  EXPECT_EQ(random.uniform(), 0.13640703636619722);
  EXPECT_EQ(random.uniform(), 0.4512149038445381);
}

TEST(Random, StreamsDependOnSeedAndIndexAsDocumented) {
  // Same program: mt19937_64 seeded with splitmix64(splitmix64(1) + 5).
  EXPECT_EQ(Random::stream(1, 5).uniform(), 0.26951077918227384);
  // Logarithm and cosine may differ by the last bit between libraries.
  EXPECT_NEAR(Random::stream(1, 5).normal(), 0.7026071247104891, 1e-15);
  EXPECT_NE(Random::stream(1, 5).uniform(), Random::stream(1, 6).uniform());
  EXPECT_NE(Random::stream(1, 5).uniform(), Random::stream(2, 5).uniform());
}

TEST(Random, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
  constexpr int count = 200000;
  Random random(3);
  double moments[5] = {};
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    double power = 1.0;
    for (double& moment : moments) {
      moment += power / count;
      power *= x;
    }
  }
  // Four standard errors of the sample moments: variances of x, x², x³, x⁴ are 1, 2, 15, 96.
  EXPECT_NEAR(moments[1], 0.0, 4.0 * std::sqrt(1.0 / count));
  EXPECT_NEAR(moments[2], 1.0, 4.0 * std::sqrt(2.0 / count));
  EXPECT_NEAR(moments[3], 0.0, 4.0 * std::sqrt(15.0 / count));
  EXPECT_NEAR(moments[4], 3.0, 4.0 * std::sqrt(96.0 / count));
}

TEST(Random, UniformNumbersStayInTheirHalfOpenInterval) {
  Random random(11);
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(-2.0, 3.0);
    ASSERT_GE(x, -2.0);
    ASSERT_LT(x, 3.0);
  }
}

}  // namespace
}  // namespace slipmode
