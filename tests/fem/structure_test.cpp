#include <slipmode/core/decompositions.hpp>
#include <slipmode/fem/structure.hpp>

#include <slipmode/core/errors.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace slipmode::fem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Eigen::Matrix2d kStiffness{{3.0, -1.0}, {-1.0, 2.0}};
const Eigen::Matrix2d kMass{{2.0, 0.5}, {0.5, 1.0}};

Structure two_dofs(const Eigen::MatrixXd& C) { return {Eigen::MatrixXd(kMass), C, Eigen::MatrixXd(kStiffness)}; }

SparseMatrix sparse(const Eigen::MatrixXd& A) { return A.sparseView(); }

TEST(Structure, RecognisesRayleighDampingFromItsMatrix) {
  const Structure s = two_dofs(0.3 * kMass + 0.07 * kStiffness);
  ASSERT_TRUE(s.rayleigh().has_value());
  EXPECT_NEAR(s.rayleigh()->mass, 0.3, 1e-15);  // the coefficients C was made of
  EXPECT_NEAR(s.rayleigh()->stiffness, 0.07, 1e-15);
}

TEST(Structure, RecognisesRayleighDampingAtVeryDifferentScales) {
  const Eigen::MatrixXd K = 1e12 * kStiffness;
  const Structure s(Eigen::MatrixXd(kMass), Eigen::MatrixXd(0.3 * kMass + 1e-9 * K), K);
  ASSERT_TRUE(s.rayleigh().has_value());
  EXPECT_NEAR(s.rayleigh()->stiffness, 1e-9, 1e-21);
  EXPECT_NEAR(s.rayleigh()->mass, 0.3, 1e-9);  // C holds 0.3 M beside entries of 1e3: 13 digits are left of it
}

TEST(Structure, DampingThatDoesNotFitIsNotRayleigh) {
  Eigen::MatrixXd C = 0.07 * kStiffness;
  C(0, 0) += 1e-9;  // relative 1e-8: far above rounding
  EXPECT_FALSE(two_dofs(C).rayleigh().has_value());
}

TEST(Structure, NoDampingIsRayleighWithZeroes) {
  const Structure s = two_dofs(Eigen::MatrixXd::Zero(2, 2));
  ASSERT_TRUE(s.rayleigh().has_value());
  EXPECT_EQ(s.rayleigh()->mass, 0.0);
  EXPECT_EQ(s.rayleigh()->stiffness, 0.0);
}

TEST(Structure, OneDofDampingIsAlwaysRayleigh) {
  const auto one = [](double x) { return Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, x)); };
  const Structure s(one(2.0), one(0.6), one(5.0));
  ASSERT_TRUE(s.rayleigh().has_value());
  EXPECT_NEAR(2.0 * s.rayleigh()->mass + 5.0 * s.rayleigh()->stiffness, 0.6, 1e-15);
}

TEST(Structure, BuildsDampingFromRayleighCoefficients) {
  const Structure s(sparse(kMass), Rayleigh{0.3, 0.07}, sparse(kStiffness));
  EXPECT_TRUE(to_dense(s.C()).isApprox(0.3 * kMass + 0.07 * kStiffness, 1e-15));
  EXPECT_TRUE(std::holds_alternative<SparseMatrix>(s.C()));
}

TEST(Structure, SparseAndDenseStorageAgree) {
  const Structure dense = two_dofs(0.1 * kStiffness);
  const Structure thin(sparse(kMass), sparse(0.1 * kStiffness), sparse(kStiffness));
  const Eigen::Vector2d q(1.0, -2.0);
  const Eigen::Vector2d v(0.5, 3.0);
  // by hand: ½vᵀMv = ½(0.5 + 1.5 + 9) = 5.5, ½qᵀKq = ½(3 + 4 + 8) = 7.5
  EXPECT_DOUBLE_EQ(dense.energy(q, v), 13.0);
  EXPECT_DOUBLE_EQ(thin.energy(q, v), 13.0);
  EXPECT_EQ(multiply(dense.K(), q), multiply(thin.K(), q));
  EXPECT_EQ(to_dense(thin.M()), to_dense(dense.M()));
  EXPECT_EQ(to_dense(to_sparse(dense.M())), to_dense(dense.M()));
}

TEST(Structure, ChainLikeNeedsDiagonalMassAndTridiagonalStiffness) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(3, 3);
  Eigen::MatrixXd K{{2, -1, 0}, {-1, 2, -1}, {0, -1, 1}};
  EXPECT_TRUE(Structure(I, Rayleigh{}, K).is_chain_like());
  EXPECT_TRUE(Structure(sparse(I), Rayleigh{}, sparse(K)).is_chain_like());
  EXPECT_FALSE(two_dofs(Eigen::MatrixXd::Zero(2, 2)).is_chain_like());  // full mass matrix
  K(0, 2) = K(2, 0) = 0.25;
  EXPECT_FALSE(Structure(I, Rayleigh{}, K).is_chain_like());
  EXPECT_FALSE(Structure(sparse(I), Rayleigh{}, sparse(K)).is_chain_like());
}

TEST(Structure, NamesDofsWhenNoneAreGiven) {
  EXPECT_THAT(two_dofs(kStiffness).dof_names(), testing::ElementsAre("q1", "q2"));
}

// S1 (6) times the adjugate of its stiffness matrix: the printed damping in power-conjugate form.
const Eigen::Matrix2d kSkewed{{0.0994, -0.033}, {-0.024, 0.0884}};

TEST(Structure, DampingMayHaveASkewPartThatDoesNoWork) {
  const Structure s = two_dofs(kSkewed);
  EXPECT_FALSE(s.has_symmetric_damping());
  EXPECT_FALSE(s.rayleigh().has_value());
  EXPECT_EQ(to_dense(s.C()), kSkewed);
  const Eigen::Vector2d v(2.0, -3.0);
  // by hand: vᵀCv = 4·0.0994 + 6·(0.033 + 0.024) + 9·0.0884
  EXPECT_NEAR(s.dissipation(v), 1.5352, 1e-15);
  EXPECT_NEAR(two_dofs(0.5 * (kSkewed + kSkewed.transpose())).dissipation(v), 1.5352, 1e-15);
  EXPECT_TRUE(two_dofs(kStiffness).has_symmetric_damping());
}

TEST(Structure, PurelyGyroscopicDampingDissipatesNothing) {
  const Structure s = two_dofs(Eigen::Matrix2d{{0.0, 0.7}, {-0.7, 0.0}});
  EXPECT_FALSE(s.has_symmetric_damping());
  EXPECT_EQ(s.dissipation(Eigen::Vector2d(1.0, 2.0)), 0.0);
}

TEST(Structure, RefusesSkewedDampingThatFeedsEnergyIn) {
  const Eigen::MatrixXd feeds{{0.1, 0.5}, {0.1, 0.1}};  // symmetric part has the eigenvalue 0.1 − 0.3
  EXPECT_THAT([&] { (void)two_dofs(feeds); }, ThrowsMessage<InvalidInput>(HasSubstr("positive semi-definite")));
}

TEST(Structure, RejectsBadInputSayingWhy) {
  const Eigen::MatrixXd M = kMass;
  const Eigen::MatrixXd K = kStiffness;
  const Eigen::MatrixXd none(0, 0);
  EXPECT_THAT([&] { Structure(none, none, none); }, ThrowsMessage<InvalidInput>(HasSubstr("0 x 0")));
  EXPECT_THAT([&] { Structure(M, K, Eigen::MatrixXd(Eigen::MatrixXd::Identity(3, 3))); },
              ThrowsMessage<InvalidInput>(HasSubstr("K is 3 x 3, expected 2 x 2")));
  Eigen::MatrixXd bad = K;
  bad(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { Structure(M, bad, K); }, ThrowsMessage<InvalidInput>(HasSubstr("C holds a value that is not")));
  EXPECT_THAT([&] { Structure(M, K, sparse(bad)); }, ThrowsMessage<InvalidInput>(HasSubstr("K holds a value")));
  bad(0, 1) = -0.9;
  EXPECT_THAT([&] { Structure(M, K, bad); }, ThrowsMessage<InvalidInput>(HasSubstr("K is not symmetric")));
  EXPECT_THAT([&] { Structure(sparse(bad), K, K); }, ThrowsMessage<InvalidInput>(HasSubstr("M is not symmetric")));
  const Eigen::MatrixXd indefinite{{1.0, 2.0}, {2.0, 1.0}};
  EXPECT_THAT([&] { Structure(indefinite, K, K); }, ThrowsMessage<InvalidInput>(HasSubstr("not positive definite")));
  EXPECT_THAT([&] { Structure(sparse(indefinite), K, K); },
              ThrowsMessage<InvalidInput>(HasSubstr("not positive definite")));
  EXPECT_THAT([&] { Structure(M, K, K, {"a"}); }, ThrowsMessage<InvalidInput>(HasSubstr("1 names for 2 degrees")));
  EXPECT_THAT([&] { Structure(M, K, K, {}, "imperial"); }, ThrowsMessage<InvalidInput>(HasSubstr("'imperial'")));
  EXPECT_THAT([&] { Structure(M, Rayleigh{std::nan(""), 0.0}, K); }, ThrowsMessage<InvalidInput>(HasSubstr("nan")));
  EXPECT_THAT([&] { (void)two_dofs(K).energy(Eigen::VectorXd::Zero(3), Eigen::VectorXd::Zero(2)); },
              ThrowsMessage<InvalidInput>(HasSubstr("q has 3")));
}

}  // namespace
}  // namespace slipmode::fem
