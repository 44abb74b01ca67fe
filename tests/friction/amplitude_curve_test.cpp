#include <slipmode/friction/amplitude_curve.hpp>

#include <slipmode/core/errors.hpp>

#include <gtest/gtest.h>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace {

using slipmode::InvalidInput;
using slipmode::friction::AmplitudeCurve;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no InvalidInput";
}

AmplitudeCurve table() { return {AmplitudeCurve::Table{{{5.0, 3e-3}, {10.0, 1e-3}, {20.0, 2e-3}}}}; }

TEST(AmplitudeCurve, ConstantIsTheSameEverywhere) {
  const AmplitudeCurve curve{AmplitudeCurve::Constant{2e-3}};
  EXPECT_EQ(curve.at(1e-3), 2e-3);
  EXPECT_EQ(curve.at(1e6), 2e-3);
  EXPECT_TRUE(curve.covers(1e-3, 1e6));
}

TEST(AmplitudeCurve, ExponentialFallsByEOverItsDecay) {
  const AmplitudeCurve curve{AmplitudeCurve::Exponential{.at = 5.0, .amplitude = 3e-3, .decay = 20.0}};
  EXPECT_DOUBLE_EQ(curve.at(5.0), 3e-3);
  EXPECT_DOUBLE_EQ(curve.at(25.0), 3e-3 / std::exp(1.0));
  EXPECT_TRUE(curve.covers(1.0, 500.0));
}

TEST(AmplitudeCurve, TableMeetsItsPointsAndIsLinearBetween) {
  EXPECT_EQ(table().at(5.0), 3e-3);
  EXPECT_EQ(table().at(10.0), 1e-3);
  EXPECT_EQ(table().at(20.0), 2e-3);
  EXPECT_DOUBLE_EQ(table().at(7.5), 2e-3);
  EXPECT_DOUBLE_EQ(table().at(12.0), 1.2e-3);
}

TEST(AmplitudeCurve, TableHasNoValueOutside) {
  const std::string message = message_of([] { (void)table().at(20.1); });
  EXPECT_NE(message.find("20.1 Hz"), std::string::npos) << message;
  EXPECT_NE(message.find("from 5 to 20 Hz"), std::string::npos) << message;
  EXPECT_TRUE(table().covers(5.0, 20.0));
  EXPECT_TRUE(table().covers(20.0, 5.0));
  EXPECT_FALSE(table().covers(4.9, 20.0));
  EXPECT_FALSE(table().covers(5.0, 20.1));
}

TEST(AmplitudeCurve, PolynomialIsItsSumOfPowers) {
  const AmplitudeCurve curve{AmplitudeCurve::Polynomial{{1.0, -0.5, 0.25}}};
  EXPECT_DOUBLE_EQ(curve.at(4.0), 1.0 - 2.0 + 4.0);
}

TEST(AmplitudeCurve, PolynomialBelowZeroBetweenTheEndsIsNotCovered) {
  // (f − 10)² − d: positive at both ends of 5..15, least at 10; roots at 10 ± √d.
  const auto dipping = [](double d) { return AmplitudeCurve{AmplitudeCurve::Polynomial{{100.0 - d, -20.0, 1.0}}}; };
  EXPECT_FALSE(dipping(1e-3).covers(5.0, 15.0));
  EXPECT_TRUE(dipping(0.0).covers(5.0, 15.0));  // touches zero
  EXPECT_TRUE(dipping(-1e-3).covers(5.0, 15.0));
  EXPECT_TRUE(dipping(4.0).covers(12.5, 15.0));
  EXPECT_FALSE(dipping(4.0).covers(15.0, 11.5));
  const std::string message = message_of([&] { (void)dipping(4.0).at(10.0); });
  EXPECT_NE(message.find("-4 m at 10 Hz"), std::string::npos) << message;
}

TEST(AmplitudeCurve, PolynomialOfAnyDegreeAgreesWithAFineGrid) {
  // (f − 6)(f − 9)(f − 9.2)(f − 14)/1000 on intervals with and without a root inside.
  const std::vector<double> roots = {6.0, 9.0, 9.2, 14.0};
  std::vector<double> a = {1e-3};
  for (const double root : roots) {
    a.push_back(0.0);
    for (std::size_t k = a.size() - 1; k > 0; --k) a[k] = a[k - 1] - root * a[k];
    a[0] *= -root;
  }
  const AmplitudeCurve curve{AmplitudeCurve::Polynomial{a}};
  for (double low = 5.05; low < 15.0; low += 0.5) {
    for (double high = low + 0.3; high < 16.0; high += 0.5) {
      bool positive = true;
      for (double f = low; f <= high; f += 1e-3) {
        double product = 1.0;
        for (const double root : roots) product *= f - root;
        positive = positive && product >= 0.0;
      }
      EXPECT_EQ(curve.covers(low, high), positive) << low << " to " << high;
    }
  }
}

TEST(AmplitudeCurve, BadNumbersAreNamed) {
  const auto fails = [](const AmplitudeCurve& curve, const char* part) {
    const std::string message = message_of([&] { validate(curve); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  fails({AmplitudeCurve::Constant{-1.0}}, "amplitude = -1");
  fails({AmplitudeCurve::Polynomial{}}, "without coefficients");
  fails({AmplitudeCurve::Polynomial{{std::numeric_limits<double>::infinity()}}}, "coefficient inf");
  fails({AmplitudeCurve::Table{{{5.0, 1.0}}}}, "a table of 1 points");
  fails({AmplitudeCurve::Table{{{5.0, 1.0}, {5.0, 2.0}}}}, "5 Hz after 5 Hz");
  fails({AmplitudeCurve::Table{{{0.0, 1.0}, {5.0, 2.0}}}}, "0 Hz");
  fails({AmplitudeCurve::Table{{{1.0, 1.0}, {5.0, -2.0}}}}, "amplitude = -2");
  fails({AmplitudeCurve::Exponential{5.0, 1.0, 0.0}}, "decay = 0");
  fails({AmplitudeCurve::Exponential{5.0, -1.0, 1.0}}, "amplitude = -1");
  EXPECT_NE(message_of([] { (void)AmplitudeCurve{}.at(0.0); }).find("frequency of 0 Hz"), std::string::npos);
  EXPECT_EQ(message_of([] { validate(table()); }), "no InvalidInput");
}

}  // namespace
