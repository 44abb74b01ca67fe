// A law by points: the curve beside Boost's, and what it refuses.
#include <slipmode/friction/contact.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/friction/characteristic.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <math.h>  // Boost 1.74 asks for isnan by that name
#include <boost/math/interpolators/pchip.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::friction {
namespace {

/// Falls, has a dip, rises above its start; unequal intervals.
Measured dipped() {
  return {.mu_s = 0.5,
          .speeds = {0.0, 0.02, 0.1, 0.35, 0.4, 1.0, 2.5},
          .coefficients = {0.4, 0.31, 0.22, 0.2, 0.24, 0.3, 0.45}};
}

ContactForces forces_of(const Law& law) {
  return contact_forces({.direction = Eigen::VectorXd::Ones(1), .law = law, .normal_load = 2.0});
}

// The same formula from its paper by other hands; a product of a few roundings apart.
TEST(Measured, IsTheMonotoneCubicThatBoostHas) {
  const Measured law = dipped();
  const boost::math::interpolators::pchip<std::vector<double>> other(std::vector(law.speeds),
                                                                     std::vector(law.coefficients), std::nan(""), 0.0);
  const ContactForces forces = forces_of(law);
  for (int k = 0; k <= 2500; ++k) {
    const double v = 1e-3 * k;
    EXPECT_NEAR(law.kinetic_coefficient(v), other(v), 1e-15) << v;
    EXPECT_NEAR(forces.sliding(-1.0, -v), -2.0 * other(v), 2e-15) << v;
    if (k == 2500) continue;
    EXPECT_NEAR(forces.slope(1.0, v), 2.0 * other.prime(v), 1e-13) << v;
  }
}

TEST(Measured, KeepsTheLastValueAndItsSlopesAreItsOwn) {
  const Measured law = dipped();
  EXPECT_EQ(law.kinetic_coefficient(2.5), 0.45);
  EXPECT_EQ(law.kinetic_coefficient(1e6), 0.45);
  const ContactForces forces = forces_of(law);
  EXPECT_EQ(forces.slope(1.0, 3.0), 0.0);
  const double h = 1e-6;  // central differences: h²/6 of a third derivative of at most 7.4e4, 1.2e-8
  for (const double v : {0.005, 0.05, 0.2, 0.37, 0.7, 1.8}) {
    const double difference = (forces.sliding(1.0, v + h) - forces.sliding(1.0, v - h)) / (2.0 * h);
    EXPECT_NEAR(forces.slope(1.0, v), difference, 1.3e-8) << v;
    EXPECT_NEAR(forces.slope(-1.0, -v), difference, 1.3e-8) << v;
  }
  EXPECT_NEAR(forces.slope(1.0, -0.01), 2.0 * (0.31 - 0.4) / 0.02, 1e-14);  // past v = 0, as it begins
}

TEST(Measured, TwoPointsAreEnough) {
  const Measured law{.mu_s = 0.4, .speeds = {0.0, 1.0}, .coefficients = {0.4, 0.2}};
  EXPECT_NEAR(law.kinetic_coefficient(0.5), 0.3 - 0.2 / 8.0, 1e-15);  // Hermite with slopes −0.2 and 0
  EXPECT_EQ(law.kind(), LawKind::kSpeedDependent);
  EXPECT_EQ(static_coefficient(law), 0.4);
  EXPECT_EQ(limit_coefficient(law), 0.2);
}

// Slopes and curvatures by differences of a thousand places between two speeds: none beyond the bounds, which are not
// far above the largest of the points' intervals.
TEST(LawBounds, HoldBetweenAnyTwoSpeeds) {
  const Measured table = dipped();
  const TanhRegularised smooth{.mu_s = 0.6, .mu_k = 0.3, .alpha = 8.0, .epsilon = 0.05};
  const Stribeck stribeck{0.6, 0.3, 8.0};
  Random random = Random::stream(5, 1);
  Measured risen = table;
  risen.mu_s = risen.coefficients.front() = 0.0;
  for (const Law& law : {Law(table), Law(risen), Law(smooth), Law(stribeck)}) {
    const ContactForces forces = forces_of(law);
    const bool two_sided = !forces.sticks();
    const auto slope = [&](double v) {
      double out = 0.0;
      if (!two_sided) return forces.slope(1.0, v);
      static_cast<void>(forces.smooth(v, out));
      return out;
    };
    for (int pair = 0; pair < 200; ++pair) {
      const double from = random.uniform(two_sided ? -3.0 : -0.1, 2.5), to = from + std::pow(random.uniform(), 3) * 2.0;
      const LawBounds bound = forces.bounds(from, to).value();
      const double h = (to - from) / 1000.0;
      double steepest = 0.0, most_curved = 0.0;
      for (int k = 0; k < 1000; ++k) {
        steepest = std::max(steepest, std::abs(slope(from + h * k)));
        most_curved = std::max(most_curved, std::abs(slope(from + h * (k + 1)) - slope(from + h * k)) / h);
      }
      EXPECT_LE(steepest, bound.slope * (1.0 + 1e-12)) << law.index() << ": " << from << " to " << to;
      // Differences of slopes, which round.
      EXPECT_LE(most_curved, bound.curve + 1e-14 / h) << law.index() << ": " << from << " to " << to;
      if (from < 0.0 && to > 0.1) {
        EXPECT_LT(bound.curve, 3.0 * most_curved) << law.index();
      }
    }
  }
}

TEST(LawBounds, AreNotKnownOfFunctions) {
  const Characteristic law{.mu_s = 0.3, .mu = [](double) { return 0.3; }, .slope = [](double) { return 0.0; }};
  EXPECT_FALSE(forces_of(law).bounds(0.0, 1.0).has_value());
}

TEST(LawBounds, ComeWithTheLargestCoefficient) {
  Characteristic law{.mu_s = 0.0, .mu = [](double v) { return 0.3 * v; }, .slope = [](double) { return 0.3; }};
  const auto check = [&] { validate({.direction = Eigen::VectorXd::Ones(1), .law = law}); };
  EXPECT_NO_THROW(check());
  EXPECT_EQ(forces_of(law).kind, LawKind::kSmooth);
  law.bounds = [](double, double) { return LawBounds{0.3, 0.0}; };
  EXPECT_THAT(check, testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("bounds with most = 0")));
  law.most = 3.0;
  EXPECT_NO_THROW(check());
}

// Rayleigh's oscillator: negative below 0.447.
TEST(LawBounds, WithoutStickAForceMayDriveSlowMotion) {
  const Characteristic law{.mu_s = 0.0,
                           .mu = [](double v) { return v * v * v - 0.2 * v; },
                           .slope = [](double v) { return 3.0 * v * v - 0.2; }};
  const ContactForces forces = forces_of(law);
  for (const double v : {-0.7, -0.1, 0.1, 0.7}) {
    double slope = 0.0;
    EXPECT_NEAR(forces.smooth(v, slope), 2.0 * (v * v * v - 0.2 * v), 1e-16);
    EXPECT_NEAR(slope, 2.0 * (3.0 * v * v - 0.2), 1e-15);
    EXPECT_EQ(forces.sliding(1.0, v), forces.smooth(v, slope));
  }
}

TEST(Measured, MayRiseFromNothing) {
  const Measured law{.mu_s = 0.0, .speeds = {0.0, 1.0}, .coefficients = {0.0, 0.2}};
  EXPECT_EQ(forces_of(law).kind, LawKind::kSmooth);
  EXPECT_EQ(forces_of(law).most(), 0.4);
  EXPECT_EQ(forces_of(law).sliding(1.0, -0.5), -forces_of(law).sliding(1.0, 0.5));
  EXPECT_EQ(forces_of(law).slope(1.0, -0.5), forces_of(law).slope(1.0, 0.5));
  const Measured nothing{.mu_s = 0.0, .speeds = {0.0, 1.0}, .coefficients = {0.0, 0.0}};
  EXPECT_EQ(forces_of(nothing).kind, LawKind::kFree);
}

TEST(Measured, NamesWhatIsNoTable) {
  const auto fails = [](const Measured& law, const char* message) {
    EXPECT_THAT([&] { validate({.direction = Eigen::VectorXd::Ones(1), .law = law}); },
                testing::ThrowsMessage<InvalidInput>(testing::HasSubstr(message)));
  };
  fails({.mu_s = 0.4}, "speeds: none; expected two or more, the first 0");
  fails({.mu_s = 0.4, .speeds = {0.1, 0.2}, .coefficients = {0.3, 0.3}}, "speeds: 2 from 0.1 m/s");
  fails({.mu_s = 0.4, .speeds = {0.0, 0.2, 0.2}, .coefficients = {0.3, 0.3, 0.3}}, "0.2 m/s before 0.2");
  fails({.mu_s = 0.4, .speeds = {0.0, 0.2}, .coefficients = {0.3}}, "coefficients: 1 for 2 speeds");
  fails({.mu_s = 0.2, .speeds = {0.0, 0.2}, .coefficients = {0.3, 0.1}}, "mu_s: 0.2, less than the first coefficient");
  fails({.mu_s = 0.4, .speeds = {0.0, 0.2}, .coefficients = {0.3, -0.1}}, "coefficients = -0.1; expected a finite");
  fails({.mu_s = 0.4, .speeds = {0.0, std::nan("")}, .coefficients = {0.3, 0.1}}, "speeds = nan");
}

}  // namespace
}  // namespace slipmode::friction
