// What a clearance and a force accept, say and reject.
#include <slipmode/core/errors.hpp>
#include <slipmode/friction/contact.hpp>
#include <slipmode/friction/drive.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::friction {
namespace {

using ::testing::HasSubstr;

Contact with(Clearance law) { return {.direction = Eigen::VectorXd::Ones(1), .law = law, .name = "gear"}; }

Clearance only_left(Stop stop) {
  Clearance law;
  law.left = stop;
  return law;
}

Clearance only_right(Stop stop) {
  Clearance law;
  law.right = stop;
  return law;
}

std::string complaint(const Contact& contact) {
  try {
    validate(contact);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

std::string complaint(const Drive& drive) {
  try {
    validate(drive);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(Clearance, HasNoFrictionAndNoStatesOfItsOwn) {
  const Contact contact = with(only_left(Stop{4.0, 0.5, 1.0}));
  EXPECT_EQ(complaint(contact), "");
  EXPECT_TRUE(is_piecewise_linear(contact.law));
  EXPECT_EQ(internal_states(contact), 0);
  EXPECT_EQ(static_coefficient(contact.law), 0.0);
  EXPECT_EQ(limit_coefficient(contact.law), 0.0);
  EXPECT_EQ(kinetic_coefficient(contact.law, 1.0), 0.0);
}

TEST(Clearance, RejectsWhatIsNoClearance) {
  EXPECT_THAT(complaint(with({})), HasSubstr("contact 'gear': a clearance without stops"));
  EXPECT_THAT(complaint(with(only_left(Stop{0.0, 0.5, 1.0}))), HasSubstr("left stop stiffness = 0"));
  EXPECT_THAT(complaint(with(only_right(Stop{1.0, -0.5, 1.0}))), HasSubstr("right stop damping = -0.5"));
  EXPECT_THAT(complaint(with(only_right(Stop{1.0, 0.5, std::numeric_limits<double>::quiet_NaN()}))),
              HasSubstr("right stop gap = nan"));
  EXPECT_THAT(complaint(with({.left = Stop{1.0, 0.0, 0.2}, .right = Stop{1.0, 0.0, -0.3}})),
              HasSubstr("the stops overlap: left gap 0.2 + right gap -0.3 < 0"));
  Contact tilted = with(only_left(Stop{4.0, 0.5, 1.0}));
  tilted.tilt = 0.1;
  EXPECT_THAT(complaint(tilted), HasSubstr("tilt = 0.1 rad with a clearance"));
  Contact loaded = with(only_left(Stop{4.0, 0.5, 1.0}));
  loaded.normal_load = {1.0, 2.0};
  EXPECT_THAT(complaint(loaded), HasSubstr("a clearance has no friction"));
  // A preload on one side, where the gaps still leave room, is fine.
  EXPECT_EQ(complaint(with({.left = Stop{1.0, 0.0, 0.5}, .right = Stop{1.0, 0.0, -0.3}})), "");
}

TEST(Force, SumsItsHarmonicsPerDirection) {
  const Force force{2.0, {{3.0, 0.5, 1, 0}, {1.0, 0.0, 3, 0}, {7.0, 0.0, 2, 1}}};
  const double t = 0.4;
  EXPECT_DOUBLE_EQ(force.value(0, t), 3.0 * std::sin(2.0 * t + 0.5) + std::sin(6.0 * t));
  EXPECT_DOUBLE_EQ(force.rate(0, t), 6.0 * std::cos(2.0 * t + 0.5) + 6.0 * std::cos(6.0 * t));
  EXPECT_DOUBLE_EQ(force.value(1, t), 7.0 * std::sin(4.0 * t));
  EXPECT_EQ(force.value(2, t), 0.0);
  EXPECT_DOUBLE_EQ(force.period(), std::numbers::pi);
  const Drive drive = force;
  EXPECT_DOUBLE_EQ(drive.period().value(), std::numbers::pi);
  EXPECT_FALSE(drive.is_constant());
  EXPECT_EQ(drive.velocity(t), 0.0);  // the counterpart rests
  EXPECT_FALSE(Drive(Belt::constant(1.0)).period().has_value());
  EXPECT_DOUBLE_EQ(Drive(Shaker{1.0, 4.0, 0.0}).period().value(), 0.25);
}

TEST(Force, RejectsWhatIsNoForce) {
  EXPECT_THAT(complaint(Drive(Force{0.0, {}})), HasSubstr("force: omega = 0; expected > 0"));
  EXPECT_THAT(complaint(Drive(Force{1.0, {{1.0, 0.0, 0, 0}}})), HasSubstr("harmonic of order 0"));
  EXPECT_THAT(complaint(Drive(Force{1.0, {{1.0, 0.0, 1, -1}}})), HasSubstr("direction -1"));
  EXPECT_THAT(complaint(Drive(Force{1.0, {{std::numeric_limits<double>::infinity(), 0.0, 1, 0}}})),
              HasSubstr("amplitude = inf"));
}

}  // namespace
}  // namespace slipmode::friction
