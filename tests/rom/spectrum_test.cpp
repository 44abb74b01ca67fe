#include <slipmode/core/decompositions.hpp>
#include <slipmode/rom/reduce.hpp>
#include "random_model.hpp"

#include <gtest/gtest.h>
#include <algorithm>

namespace slipmode::rom {
namespace {

using dynamics::HybridSystem;
using fem::to_dense;
using tests::normal_matrix;
using tests::random_basis;
using tests::random_system;

Eigen::VectorXd squared_frequencies(const Eigen::MatrixXd& M, const Eigen::MatrixXd& K) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, M, Eigen::EigenvaluesOnly).eigenvalues();
}

/// Largest real part of the eigenvalues of M ẍ + C ẋ + K x = 0, relative to the largest modulus.
double growth(const Eigen::MatrixXd& M, const Eigen::MatrixXd& C, const Eigen::MatrixXd& K) {
  const Eigen::Index n = M.rows();
  const Eigen::LLT<Eigen::MatrixXd> llt(M);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -llt.solve(K);
  A.bottomRightCorner(n, n) = -llt.solve(C);
  const Eigen::VectorXcd values = A.eigenvalues();
  return values.real().maxCoeff() / values.cwiseAbs().maxCoeff();
}

/// Columns Z with Zᵀw = 0, orthonormal.
Eigen::MatrixXd null_space(const Eigen::VectorXd& w) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(w);
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q.rightCols(w.size() - 1);
}

TEST(ReducedSpectrum, WithAllModesIsThatOfTheFullModel) {
  Random random(61);
  for (int trial = 0; trial < 20; ++trial) {
    const HybridSystem full = random_system(random, 8);
    pod::Basis basis = random_basis(random, 8, 8);
    basis.vectors = basis.vectors.householderQr().householderQ();  // conditioning is not what is tested
    const HybridSystem reduced = reduce(full, basis);
    const Eigen::VectorXd expected =
        squared_frequencies(to_dense(full.structure().M()), to_dense(full.structure().K()));
    const Eigen::VectorXd found =
        squared_frequencies(to_dense(reduced.structure().M()), to_dense(reduced.structure().K()));
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.maxCoeff());
  }
}

TEST(ReducedSpectrum, InterlacesThatOfTheFullModel) {
  // Cauchy: λ_i ≤ μ_i ≤ λ_{i+n−L} for the pencil K − λM restricted to L dimensions.
  Random random(62);
  for (int trial = 0; trial < 300; ++trial) {
    const auto n = static_cast<Eigen::Index>(random.uniform(2.0, 9.0));
    const auto L = static_cast<Eigen::Index>(random.uniform(1.0, static_cast<double>(n) + 1.0));
    const HybridSystem full = random_system(random, n);
    const fem::Structure reduced = reduce(full, random_basis(random, n, L)).structure();
    const Eigen::VectorXd lambda = squared_frequencies(to_dense(full.structure().M()), to_dense(full.structure().K()));
    const Eigen::VectorXd mu = squared_frequencies(to_dense(reduced.M()), to_dense(reduced.K()));
    const double rounding = 1e-9 * lambda[n - 1];
    for (Eigen::Index i = 0; i < L; ++i) {
      EXPECT_GE(mu[i], lambda[i] - rounding);
      EXPECT_LE(mu[i], lambda[i + n - L] + rounding);
    }
  }
}

TEST(ReducedSpectrum, StaysInTheClosedLeftHalfPlaneInSlipAndStick) {
  Random random(63);
  double worst = 0.0;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto n = static_cast<Eigen::Index>(random.uniform(2.0, 9.0));
    const auto L = static_cast<Eigen::Index>(random.uniform(1.0, static_cast<double>(n) + 1.0));
    const HybridSystem reduced = reduce(random_system(random, n), random_basis(random, n, L));
    const Eigen::MatrixXd M = to_dense(reduced.structure().M());
    const Eigen::MatrixXd C = to_dense(reduced.structure().C());
    const Eigen::MatrixXd K = to_dense(reduced.structure().K());
    worst = std::max(worst, growth(M, C, K));
    if (L == 1) continue;
    const Eigen::MatrixXd Z = null_space(reduced.contacts()[0].direction);
    worst = std::max(worst, growth(Z.transpose() * M * Z, Z.transpose() * C * Z, Z.transpose() * K * Z));
  }
  // A double zero eigenvalue (rigid-body motion) splits by the square root of rounding.
  EXPECT_LT(worst, 1e-6);
}

TEST(ReducedSpectrum, StaysStableWhereTheFirstOrderProjectionGrows) {
  // M = diag(1, 10), K = [2 −1; −1 1]: φᵀM⁻¹Kφ < 0 for φ = (0.25, 1)/|φ|, while φᵀKφ > 0. Projecting the state matrix
  // with VᵀV = I, as S4 (3.28) does for M = I, then gives ä = +s a.
  const Eigen::MatrixXd M = (Eigen::MatrixXd(2, 2) << 1.0, 0.0, 0.0, 10.0).finished();
  const Eigen::MatrixXd K = (Eigen::MatrixXd(2, 2) << 2.0, -1.0, -1.0, 1.0).finished();
  const Eigen::VectorXd phi = (Eigen::VectorXd(2) << 0.25, 1.0).finished().normalized();
  EXPECT_LT(phi.dot(M.inverse() * K * phi), -0.02);
  const friction::Contact contact{Eigen::VectorXd::Unit(2, 1), friction::Coulomb{0.4, 0.2}};
  const HybridSystem full(fem::Structure(M, fem::Rayleigh{}, K), {contact}, friction::Belt::constant(0.2));
  const fem::Structure reduced = reduce(full, user_basis(phi)).structure();
  EXPECT_GT(to_dense(reduced.K())(0, 0) / to_dense(reduced.M())(0, 0), 0.06);
}

}  // namespace
}  // namespace slipmode::rom
