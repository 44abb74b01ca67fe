#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/pod.hpp>
#include "cantilever.hpp"
#include "known.hpp"

#include <gtest/gtest.h>

namespace slipmode::pod {
namespace {

Eigen::MatrixXd root(const fem::Matrix& M) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(fem::to_dense(M)).operatorSqrt();
}

/// A beam's motion in many modes with falling amplitudes, and its rotations: dofs of different units.
Ensemble beam_motion(const fem::Beam& beam, Eigen::Index T) {
  Random random(17);
  const Eigen::MatrixXd shapes = fem::natural_modes(beam.structure(), 8).shapes;
  const Eigen::MatrixXd mix = tests::normal_matrix(random, 8, 8);
  return {shapes * mix * tests::powers(0.5, 8).asDiagonal() * tests::normal_matrix(random, 8, T)};
}

TEST(MassPod, EqualsTheSvdOfRootMassTimesSnapshots) {
  const fem::Beam beam(tests::with_tip_body(6));
  const Ensemble ensemble = beam_motion(beam, 40);
  const PodResult found = mass_pod(ensemble, beam.structure().M());
  const Eigen::MatrixXd half = root(beam.structure().M());
  const Eigen::MatrixXd centred = ensemble.snapshots.colwise() - ensemble.snapshots.rowwise().mean();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(half * centred / std::sqrt(40.0), Eigen::ComputeThinU);
  EXPECT_EQ(found.rank, 8);
  EXPECT_LT((found.singular_values.head(8) - svd.singularValues().head(8)).norm(), 1e-10 * svd.singularValues()[0]);
  EXPECT_LT(tests::misalignment(half * found.basis.vectors.leftCols(6), svd.matrixU().leftCols(6)), 1e-9);
  EXPECT_LT((found.basis.mean - ensemble.snapshots.rowwise().mean()).norm(), 1e-14 * ensemble.snapshots.norm());
  EXPECT_NEAR(found.mean_square, (half * centred).squaredNorm() / 40.0, 1e-10 * found.mean_square);
}

TEST(MassPod, ModesAreMassOrthonormalForEitherStorage) {
  const fem::Beam beam(tests::with_tip_body(12));
  const Ensemble ensemble = beam_motion(beam, 60);
  const fem::Matrix& M = beam.structure().M();
  const PodResult sparse = mass_pod(ensemble, M, {.choice = {.modes = 5}});
  const PodResult dense = mass_pod(ensemble, fem::Matrix(fem::to_dense(M)), {.choice = {.modes = 5}});
  const Eigen::MatrixXd& Phi = sparse.basis.vectors;
  EXPECT_LT((Phi.transpose() * fem::to_dense(M) * Phi - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-11);
  EXPECT_LT((Phi - dense.basis.vectors).norm(), 1e-8 * Phi.norm());
  EXPECT_EQ(sparse.basis.kind, BasisKind::kMassPom);
}

TEST(MassPod, CapturesMoreThanAnyOtherBasisOfItsSize) {
  const fem::Beam beam(tests::with_tip_body(6));
  const fem::Matrix& M = beam.structure().M();
  const Ensemble ensemble = beam_motion(beam, 50);
  const PodResult best = mass_pod(ensemble, M);
  const Eigen::VectorXd captured = captured_energy(ensemble, best.basis, M);
  const auto expect_beaten = [&](const Eigen::MatrixXd& vectors) {
    Basis other;
    other.vectors = vectors;
    EXPECT_TRUE((captured_energy(ensemble, other, M).array() <= captured.head(vectors.cols()).array() + 1e-12).all());
  };
  Random random(18);
  for (int trial = 0; trial < 20; ++trial) {
    expect_beaten(tests::normal_matrix(random, 12, 5));
    expect_beaten(best.basis.vectors.leftCols(5) + 1e-3 * tests::normal_matrix(random, 12, 5));
  }
  expect_beaten(pod(ensemble).basis.vectors.leftCols(5));
  expect_beaten(fem::natural_modes(beam.structure(), 5).shapes);
  // What it captures is the sum of its shares (Eckart, Young).
  EXPECT_NEAR(captured[2], best.shares.head(3).sum(), 1e-12);
}

TEST(MassPod, WithEqualMassesIsThePlainPod) {
  const tests::Known known = tests::known_ensemble(19, 7, 30, tests::powers(0.5, 5));
  const fem::Matrix M = fem::Matrix(Eigen::MatrixXd(4.0 * Eigen::MatrixXd::Identity(7, 7)));
  const PodResult found = mass_pod(known.ensemble, M);
  EXPECT_LT(tests::misalignment(2.0 * found.basis.vectors, known.modes), 1e-12);
  EXPECT_LT((found.singular_values.head(5) - 2.0 * known.sigma).norm(), 1e-12);
}

TEST(MassPod, CapturedEnergyWeighsByMass) {
  // Snapshots (±1, 0) and (0, ±1), masses 1 and 3: the second dof holds three quarters.
  const Ensemble ensemble{(Eigen::MatrixXd(2, 4) << 1, -1, 0, 0, 0, 0, 1, -1).finished()};
  Basis second;
  second.vectors = Eigen::Vector2d(0.0, 1.0);
  const fem::Matrix M = fem::Matrix(Eigen::MatrixXd(Eigen::Vector2d(1.0, 3.0).asDiagonal()));
  EXPECT_NEAR(captured_energy(ensemble, second, M)[0], 0.75, 1e-15);
  EXPECT_NEAR(captured_energy(ensemble, second)[0], 0.5, 1e-15);
}

TEST(MassPod, RefusesAMassThatDoesNotFit) {
  const Ensemble ensemble{Eigen::MatrixXd::Random(3, 5)};
  const fem::Matrix two = fem::Matrix(Eigen::MatrixXd(Eigen::MatrixXd::Identity(2, 2)));
  Eigen::MatrixXd indefinite = Eigen::MatrixXd::Identity(3, 3);
  indefinite(1, 1) = -1.0;
  EXPECT_THROW((void)mass_pod(ensemble, two), InvalidInput);
  EXPECT_THROW((void)mass_pod(ensemble, fem::Matrix(indefinite)), InvalidInput);
  EXPECT_THROW((void)captured_energy(ensemble, pod(ensemble).basis, two), InvalidInput);
}

}  // namespace
}  // namespace slipmode::pod
