#include <slipmode/fem/masses.hpp>

#include <slipmode/core/errors.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slipmode::fem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// S0 Table 2.2
const MassesOptions kFour{.mass = {0.5, 1.0, 1.0, 0.5},
                          .links = {{.first = 0, .second = 1, .stiffness = 0.2, .damping = 0.02},
                                    {.first = 1, .second = 2, .stiffness = 0.2, .damping = 0.02},
                                    {.first = 2, .second = 3, .damping = 0.05},
                                    {.first = 3, .second = 4, .stiffness = 0.2, .damping = 0.02}}};

TEST(Masses, GiveTheEquationsOfTheSource) {
  const Structure s = masses(kFour);
  // S0 (2.10)-(2.13), written out by hand with K(x2, x3) = 0
  const Eigen::MatrixXd K{{0.4, -0.2, 0, 0}, {-0.2, 0.2, 0, 0}, {0, 0, 0.2, -0.2}, {0, 0, -0.2, 0.2}};
  const Eigen::MatrixXd C{{0.04, -0.02, 0, 0}, {-0.02, 0.07, -0.05, 0}, {0, -0.05, 0.07, -0.02}, {0, 0, -0.02, 0.02}};
  EXPECT_TRUE(to_dense(s.K()).isApprox(K, 1e-15));
  EXPECT_TRUE(to_dense(s.C()).isApprox(C, 1e-15));
  EXPECT_EQ(to_dense(s.M()).diagonal(), Eigen::Vector4d(0.5, 1.0, 1.0, 0.5));
  EXPECT_THAT(s.dof_names(), testing::ElementsAre("x1", "x2", "x3", "x4"));
}

TEST(Masses, FloatWhereNoSpringHoldsThem) {
  const Structure s = masses(kFour);
  const Eigen::Vector4d together(0.0, 0.0, 1.0, 1.0);  // masses 3 and 4 as one body
  EXPECT_EQ((to_dense(s.K()) * together).norm(), 0.0);
  EXPECT_EQ(masses({.mass = {2.0}}).energy(Eigen::VectorXd::Ones(1), Eigen::VectorXd::Zero(1)), 0.0);
}

TEST(Masses, RejectsBadInputSayingWhere) {
  const auto with = [](Link link) { return [link] { (void)masses({.mass = {1.0, 1.0}, .links = {link}}); }; };
  EXPECT_THAT([] { (void)masses({.mass = {}}); }, ThrowsMessage<InvalidInput>(HasSubstr("at least one mass")));
  EXPECT_THAT([] { (void)masses({.mass = {1.0, 0.0}}); }, ThrowsMessage<InvalidInput>(HasSubstr("mass[2] = 0")));
  EXPECT_THAT(with({.first = 1, .second = 3}), ThrowsMessage<InvalidInput>(HasSubstr("link 1 joins 1 and 3")));
  EXPECT_THAT(with({.first = 2, .second = 2}), ThrowsMessage<InvalidInput>(HasSubstr("two different masses")));
  EXPECT_THAT(with({.first = 0, .second = 1, .stiffness = -1.0}), ThrowsMessage<InvalidInput>(HasSubstr(">= 0")));
}

}  // namespace
}  // namespace slipmode::fem
