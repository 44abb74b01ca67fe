// Decompositions of matrices like the fundamental ones of many contacts at one place: ones, zeros, and a few others.
#include <slipmode/core/dense_lapack.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

namespace slipmode {
namespace {

using orbits::sorted_by_modulus;
using orbits::sorted_eigenvalues;

/// So many zero columns, so many ones that the first rows feed on, and a random rest that is scaled unequally.
Eigen::MatrixXd of_a_joint(unsigned seed, int rest, int zeros, int ones) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const int n = rest + zeros + ones;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (double& entry : out.topLeftCorner(n, rest).reshaped()) entry = normal(random);
  out.topRows(rest) *= 1e-2;
  out.bottomRightCorner(ones, ones).setIdentity();
  return out;
}

TEST(DenseLapack, EigenpairsAreThoseOfJoints) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Eigen::MatrixXd A = of_a_joint(seed, 4, 15, 16);
    const Eigenpairs pairs = eigenpairs(A, true);
    for (Eigen::Index k = 0; k < A.cols(); ++k) {
      EXPECT_NEAR(pairs.vectors.col(k).norm(), 1.0, 1e-12);
      EXPECT_LT((A * pairs.vectors.col(k) - pairs.values[k] * pairs.vectors.col(k)).norm(), 1e-12 * A.norm());
    }
    // Block triangular: zeros, ones, and the eigenvalues of the block of 4, a quartic whose coefficients are its
    // traces.
    const Eigen::MatrixXd block = A.topLeftCorner(4, 4);
    EXPECT_NEAR(std::abs(pairs.values.sum() - (16.0 + block.trace())), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(pairs.values.array().square().sum() - (16.0 + (block * block).trace())), 0.0, 1e-12);
    EXPECT_EQ((pairs.values.array().abs() < 1e-12).count(), 15);
    EXPECT_LT((sorted_eigenvalues(A) - sorted_by_modulus(pairs.values)).norm(), 1e-7);  // ones are many
  }
}

TEST(DenseLapack, SingularValuesAreThoseOfJointsAndOfWideAndTallMatrices) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Eigen::MatrixXd A = of_a_joint(seed, 4, 15, 16);
    for (const Eigen::MatrixXd& own : {A, Eigen::MatrixXd(A.leftCols(20)), Eigen::MatrixXd(A.topRows(20))}) {
      const SingularValues found = singular_values(own);
      EXPECT_LT((found.U * found.sigma.asDiagonal() * found.V.transpose() - own).norm(), 1e-13 * own.norm());
      const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(found.sigma.size(), found.sigma.size());
      EXPECT_LT((found.U.transpose() * found.U - one).norm(), 1e-12);
      EXPECT_LT((found.V.transpose() * found.V - one).norm(), 1e-12);
      EXPECT_GE((found.sigma.head(found.sigma.size() - 1) - found.sigma.tail(found.sigma.size() - 1)).minCoeff(), 0.0);
    }
  }
}

TEST(DenseLapack, WhatIsNotFiniteIsAFailure) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
  A(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(static_cast<void>(eigenpairs(A, false)), NumericalFailure);
  EXPECT_THROW(static_cast<void>(singular_values(A)), NumericalFailure);
}

}  // namespace
}  // namespace slipmode
