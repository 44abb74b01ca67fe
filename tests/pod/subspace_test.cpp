#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/pod.hpp>
#include "known.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace slipmode::pod {
namespace {

using tests::known_ensemble;
using tests::normal_matrix;
using tests::orthonormal;
using tests::powers;

/// Two planes in R⁶ with the given principal angles, in general position. Origin: the rotation itself.
struct Planes {
  Eigen::MatrixXd A, B;
};

Planes planes(std::uint64_t seed, double first, double second) {
  Random random(seed);
  const Eigen::MatrixXd Q = orthonormal(normal_matrix(random, 6, 4));
  Planes p{Q.leftCols(2), Q.leftCols(2)};
  p.B.col(0) = std::cos(first) * Q.col(0) + std::sin(first) * Q.col(2);
  p.B.col(1) = std::cos(second) * Q.col(1) + std::sin(second) * Q.col(3);
  p.A *= (Eigen::Matrix2d() << 2.0, 0.3, -1.0, 0.7).finished();  // the span stays
  p.B *= (Eigen::Matrix2d() << 1.0, -4.0, 0.5, 3.0).finished();
  return p;
}

TEST(SubspaceAngles, SmallAnglesAreGoodToRounding) {
  for (const double angle : {1e-10, 1e-13, 1e-4}) {
    const Planes p = planes(41, angle, 0.3);
    const Eigen::VectorXd found = subspace_angles(p.A, p.B);
    EXPECT_NEAR(found[0], angle, 5e-15);  // the cosine form would give 0 or 1e-8
    EXPECT_NEAR(found[1], 0.3, 5e-15);
  }
}

TEST(SubspaceAngles, NearlyRightAnglesAreGoodToRounding) {
  const double right = std::numbers::pi / 2;
  const Planes p = planes(42, 0.2, right - 1e-10);
  const Eigen::VectorXd found = subspace_angles(p.A, p.B);
  EXPECT_NEAR(found[0], 0.2, 5e-15);
  EXPECT_NEAR(right - found[1], 1e-10, 5e-15);
}

TEST(SubspaceAngles, AreSymmetricAndZeroWithinALargerSpace) {
  Random random(43);
  const Eigen::MatrixXd A = normal_matrix(random, 8, 5);
  const Eigen::MatrixXd inside = A * normal_matrix(random, 5, 2);
  EXPECT_LT(subspace_angles(A, inside).maxCoeff(), 1e-14);
  const Eigen::MatrixXd B = normal_matrix(random, 8, 3);
  EXPECT_EQ(subspace_angles(A, B).size(), 3);
  EXPECT_LT((subspace_angles(A, B) - subspace_angles(B, A)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(SubspaceAngles, NaturalModesAreOrthogonalInTheMassMetricOnly) {
  const fem::Structure chain = fem::chain({.masses = 4, .mass = {1.0, 5.0, 0.2, 2.0}});
  const Eigen::MatrixXd modes = fem::natural_modes(chain).shapes;
  const Eigen::MatrixXd low = modes.leftCols(2);
  const Eigen::MatrixXd high = modes.rightCols(2);
  const double right = std::numbers::pi / 2;
  EXPECT_NEAR(subspace_angles(low, high, chain.M()).minCoeff(), right, 1e-13);  // ΦᵀMΦ = I
  EXPECT_NEAR(subspace_angles(low, high, fem::Matrix(fem::to_dense(chain.M()))).minCoeff(), right, 1e-13);
  EXPECT_LT(subspace_angles(low, high).minCoeff(), right - 0.1);
}

TEST(SubspaceAngles, RefusesWhatSpansNothing) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(4, 2);
  Eigen::MatrixXd dependent = A;
  dependent.col(1) = 2.0 * A.col(0);
  EXPECT_THROW((void)subspace_angles(A, dependent), InvalidInput);
  EXPECT_THROW((void)subspace_angles(A, Eigen::MatrixXd::Zero(4, 1)), InvalidInput);
  EXPECT_THROW((void)subspace_angles(A, Eigen::MatrixXd::Identity(5, 2)), InvalidInput);
  EXPECT_THROW((void)subspace_angles(A, Eigen::MatrixXd(4, 0)), InvalidInput);
  EXPECT_THROW((void)subspace_angles(A, A, fem::Matrix(Eigen::MatrixXd(-Eigen::Matrix4d::Identity()))), InvalidInput);
}

TEST(CapturedEnergy, OfPomsIsTheirCumulativeShare) {
  const auto known = known_ensemble(44, 9, 600, powers(0.7, 9), 2.0);
  const PodResult result = pod(known.ensemble);
  const Eigen::VectorXd captured = captured_energy(known.ensemble, result.basis);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < 9; ++i) {
    sum += result.shares[i];
    EXPECT_NEAR(captured[i], sum, 1e-14);
  }
}

TEST(CapturedEnergy, OfNoBasisExceedsThatOfPoms) {
  // Optimality of the POD: S4 section 2.1, second part of the proposition.
  const auto known = known_ensemble(45, 8, 300, powers(0.6, 8));
  const Eigen::VectorXd best = captured_energy(known.ensemble, pod(known.ensemble).basis);
  Random random(46);
  for (int trial = 0; trial < 200; ++trial) {
    Basis basis;
    basis.vectors = normal_matrix(random, 8, 8);
    const Eigen::VectorXd captured = captured_energy(known.ensemble, basis);
    for (Eigen::Index i = 0; i < 8; ++i) EXPECT_LE(captured[i], best[i] + 1e-13);
    EXPECT_NEAR(captured[7], 1.0, 1e-13);  // a full basis holds everything
  }
}

TEST(CapturedEnergy, RefusesBasesThatDoNotFit) {
  const auto known = known_ensemble(47, 4, 50, powers(0.6, 4));
  Basis basis;
  basis.vectors = Eigen::MatrixXd::Identity(5, 2);
  EXPECT_THROW((void)captured_energy(known.ensemble, basis), InvalidInput);
  basis.vectors = Eigen::MatrixXd::Ones(4, 2);
  EXPECT_THROW((void)captured_energy(known.ensemble, basis), InvalidInput);
  basis.vectors = Eigen::MatrixXd::Identity(4, 2);
  EXPECT_THROW((void)captured_energy({.snapshots = Eigen::MatrixXd::Ones(4, 9)}, basis), InvalidInput);
}

}  // namespace
}  // namespace slipmode::pod
