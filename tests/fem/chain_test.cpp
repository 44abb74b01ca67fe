#include <slipmode/fem/chain.hpp>

#include <slipmode/core/errors.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace slipmode::fem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Chain, DefaultsGiveTheMatricesOfTheSource) {
  const Structure s = chain({.masses = 4, .damping = 0.006});
  // S4 (3.2): 2 on the diagonal, -1 beside it, and 1 in the last place
  const Eigen::MatrixXd K{{2, -1, 0, 0}, {-1, 2, -1, 0}, {0, -1, 2, -1}, {0, 0, -1, 1}};
  EXPECT_EQ(to_dense(s.K()), K);
  EXPECT_EQ(to_dense(s.M()), Eigen::MatrixXd::Identity(4, 4));
  EXPECT_TRUE(to_dense(s.C()).isApprox(0.006 * K, 1e-15));
  EXPECT_TRUE(s.is_chain_like());
  ASSERT_TRUE(s.rayleigh().has_value());
  EXPECT_EQ(s.rayleigh()->stiffness, 0.006);
  EXPECT_THAT(s.dof_names(), testing::ElementsAre("x1", "x2", "x3", "x4"));
}

TEST(Chain, PlacesEverySpringFromLeftToRight) {
  const Structure s = chain({.masses = 3,
                             .mass = {1.0, 2.0, 3.0},
                             .stiffness = {10.0, 20.0, 30.0, 40.0},
                             .ground_stiffness = {0.5, 0.0, 0.25},
                             .right_fixed = true});
  // by hand: springs 10 | 20 | 30 | 40 between wall, masses and wall
  const Eigen::MatrixXd K{{30.5, -20, 0}, {-20, 50, -30}, {0, -30, 70.25}};
  EXPECT_EQ(to_dense(s.K()), K);
  EXPECT_EQ(to_dense(s.M()).diagonal(), Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST(Chain, FreeChainResistsNoRigidMotion) {
  const Structure s = chain({.masses = 5, .stiffness = {1.0, 2.0, 3.0, 4.0}, .left_fixed = false});
  EXPECT_EQ(multiply(s.K(), Eigen::VectorXd::Ones(5)).cwiseAbs().maxCoeff(), 0.0);  // translation costs no force
}

TEST(Chain, OneMassHasOneSpringOrNone) {
  EXPECT_EQ(to_dense(chain({.masses = 1}).K())(0, 0), 1.0);
  EXPECT_EQ(to_dense(chain({.masses = 1, .right_fixed = true}).K())(0, 0), 2.0);
  EXPECT_EQ(to_dense(chain({.masses = 1, .left_fixed = false}).K())(0, 0), 0.0);
}

TEST(Chain, DampsInProportionToMassAndStiffness) {
  const Structure s = chain({.masses = 3, .mass = {2.0}, .damping = 0.1, .mass_damping = 0.05});
  EXPECT_TRUE(to_dense(s.C()).isApprox(0.05 * to_dense(s.M()) + 0.1 * to_dense(s.K()), 1e-15));
}

TEST(Chain, TenThousandMassesStaySparse) {
  const Structure s = chain({.masses = 10000});
  EXPECT_EQ(std::get<SparseMatrix>(s.K()).nonZeros(), 29998);  // 3 N - 2
}

TEST(Chain, RejectsBadInputSayingWhy) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto fails = [](ChainOptions options, const char* message) {
    EXPECT_THAT([&] { (void)chain(options); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  fails({.masses = 0}, "masses = 0; expected at least 1");
  fails({.masses = 3, .mass = {1.0, 1.0}}, "mass has 2 values; expected 1 (for all) or 3");
  fails({.masses = 3, .mass = {}}, "mass has 0 values");
  fails({.masses = 3, .mass = {1.0, -1.0, 1.0}}, "mass[2] = -1");
  fails({.masses = 3, .stiffness = {1.0, 1.0}}, "stiffness has 2 values; expected 1 (for all) or 3");
  fails({.masses = 3, .stiffness = {0.0}}, "stiffness[1] = 0; expected a finite value > 0");
  fails({.masses = 3, .stiffness = {nan}}, "stiffness[1] = nan");
  fails({.masses = 3, .ground_stiffness = {-0.1}}, "ground_stiffness[1] = -0.1; expected a finite value >= 0");
  fails({.masses = 3, .damping = -0.1}, "damping = -0.1");
  fails({.masses = 3, .mass_damping = nan}, "mass_damping = nan");
  fails({.masses = 3, .units = "furlongs"}, "furlongs");
}

}  // namespace
}  // namespace slipmode::fem
