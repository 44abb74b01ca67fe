#include <slipmode/friction/drive.hpp>

#include <slipmode/core/errors.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <limits>

namespace slipmode::friction {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Belt kRamp = Belt::ramp(0.5, -0.1, 10.0, 22.0);

TEST(Belt, ConstantBeltNeverChanges) {
  const Belt belt = Belt::constant(-0.2);
  EXPECT_TRUE(belt.is_constant());
  for (const double t : {-1e9, 0.0, 3.0, 1e9}) {
    EXPECT_EQ(belt.velocity(t), -0.2);
    EXPECT_EQ(belt.acceleration(t), 0.0);
    EXPECT_FALSE(belt.next_corner(t).has_value());
  }
}

TEST(Belt, RampJoinsItsEndsExactly) {
  EXPECT_EQ(kRamp.velocity(-5.0), 0.5);
  EXPECT_EQ(kRamp.velocity(10.0), 0.5);
  EXPECT_EQ(kRamp.velocity(22.0), -0.1);
  EXPECT_EQ(kRamp.velocity(1e9), -0.1);
  EXPECT_DOUBLE_EQ(kRamp.velocity(16.0), 0.2);  // halfway
}

TEST(Belt, VelocityIsContinuousAtTheCorners) {
  const double h = 1e-9;
  for (const double corner : {10.0, 22.0}) {
    EXPECT_NEAR(kRamp.velocity(corner - h), kRamp.velocity(corner + h), 0.05 * 2.0 * h + 1e-16);  // |slope| is 0.05
  }
}

TEST(Belt, AccelerationIsTheDerivativeOfTheVelocity) {
  const double h = 0.5;  // exact for a straight line, away from the corners
  for (const double t : {0.0, 9.0, 11.0, 15.3, 21.0, 23.0, 100.0}) {
    EXPECT_NEAR(kRamp.acceleration(t), (kRamp.velocity(t + h) - kRamp.velocity(t - h)) / (2.0 * h), 1e-14) << t;
  }
}

TEST(Belt, AccelerationAtACornerIsTheLimitFromTheRight) {
  const double h = 0.25;
  for (const double corner : {10.0, 22.0}) {
    EXPECT_NEAR(kRamp.acceleration(corner), (kRamp.velocity(corner + h) - kRamp.velocity(corner)) / h, 1e-14);
  }
}

TEST(Belt, CornersComeInOrderAndEachOnce) {
  EXPECT_EQ(kRamp.next_corner(-1.0), 10.0);
  EXPECT_EQ(kRamp.next_corner(10.0), 22.0);  // strictly after t
  EXPECT_EQ(kRamp.next_corner(21.9), 22.0);
  EXPECT_FALSE(kRamp.next_corner(22.0).has_value());
}

TEST(Belt, RampThatGoesNowhereIsConstant) {
  EXPECT_TRUE(Belt::ramp(0.3, 0.3, 1.0, 2.0).is_constant());
  EXPECT_FALSE(Belt::ramp(0.3, 0.3, 1.0, 2.0).next_corner(0.0).has_value());
  EXPECT_TRUE(Belt::ramp(0.3, 0.7, 1.0, 1.0).is_constant());
  EXPECT_EQ(Belt::ramp(0.3, 0.7, 1.0, 1.0).velocity(5.0), 0.3);  // end_speed is used only by a ramp with a duration
}

TEST(BeltValidation, SaysWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(validate(kRamp));
  EXPECT_NO_THROW(validate(Belt::constant(0.0)));
  EXPECT_THAT([&] { validate(Belt::constant(nan)); }, ThrowsMessage<InvalidInput>(HasSubstr("speed = nan")));
  EXPECT_THAT([&] { validate(Belt::ramp(0.1, INFINITY, 0.0, 1.0)); },
              ThrowsMessage<InvalidInput>(HasSubstr("end_speed = inf")));
  EXPECT_THAT([&] { validate(Belt::ramp(0.1, 0.2, 5.0, 4.0)); },
              ThrowsMessage<InvalidInput>(HasSubstr("ramp_end = 4 is before ramp_begin = 5")));
  EXPECT_THAT([&] { validate(Belt::ramp(0.1, 0.2, nan, 4.0)); },
              ThrowsMessage<InvalidInput>(HasSubstr("ramp_begin = nan")));
}

}  // namespace
}  // namespace slipmode::friction
