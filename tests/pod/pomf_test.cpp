#include <slipmode/core/decompositions.hpp>
#include <slipmode/pod/pomf.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/pod/gram_schmidt.hpp>
#include <slipmode/pod/mode_shares.hpp>
#include "cantilever.hpp"
#include "known.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slipmode::pod {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using tests::known_ensemble;
using tests::places;
using tests::powers;

const fem::Beam& shaken_beam() {
  static const fem::Beam shared(tests::with_tip_body(40));
  return shared;
}

Eigen::MatrixXd mass() { return fem::to_dense(shaken_beam().structure().M()); }

double orthonormality_error(const Eigen::MatrixXd& Phi) {
  return (Phi.transpose() * mass() * Phi - Eigen::MatrixXd::Identity(Phi.cols(), Phi.cols())).cwiseAbs().maxCoeff();
}

/// Φ = V R⁻¹ with VᵀMV = RᵀR: Gram-Schmidt's result by another way.
Eigen::MatrixXd cholesky_qr(const Eigen::MatrixXd& V) {
  const Eigen::LLT<Eigen::MatrixXd> gram(V.transpose() * mass() * V);
  return gram.matrixU().solve<Eigen::OnTheRight>(V);
}

TEST(Pomf, FindsExactlyTheModalFunctionsTheSnapshotsAreMadeOf) {
  // Displacements at the six places have known POMs p_i and mean; six natural modes interpolate: ψ_i = Φ₆ F⁻¹ p_i.
  const Eigen::Index T = 80;
  const tests::Known known = known_ensemble(31, 6, T, powers(0.4, 4));
  const Eigen::MatrixXd six = natural_functions(shaken_beam(), 6).shapes;
  const Eigen::MatrixXd F = places(shaken_beam()).readings(six);
  const auto continued = [&](const Eigen::MatrixXd& y) { return Eigen::MatrixXd(six * F.partialPivLu().solve(y)); };

  const PomfResult found =
      pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.pod = {.choice = {.modes = 3}}});
  const Eigen::MatrixXd psi = continued(found.discrete.basis.vectors);  // signs as found
  EXPECT_LT(tests::misalignment(found.discrete.basis.vectors, known.modes.leftCols(3)), 1e-12);
  EXPECT_LT((found.continuous - psi).norm(), 1e-10 * psi.norm());
  EXPECT_LT((found.basis.vectors - cholesky_qr(psi)).norm(), 1e-10 * found.basis.vectors.norm());
  EXPECT_LT((found.basis.mean - continued(known.mean)).norm(), 1e-10 * found.basis.mean.norm());
  const Eigen::VectorXd shares = known.sigma.array().square() / known.sigma.squaredNorm();
  EXPECT_LT((found.basis.energy - shares.head(3)).norm(), 1e-13);
  EXPECT_LT(found.misfit, 1e-12);
  EXPECT_EQ(found.basis.kind, BasisKind::kPomf);
  EXPECT_THAT(found.basis.provenance, HasSubstr("at 6 sensors, fitted by 6 natural modes"));
  EXPECT_THAT(found.basis.provenance, HasSubstr("3 of 4 proper orthogonal modes of 80 snapshots"));
}

TEST(Pomf, AreOrthonormalOverBeamAndTipBodyTogether) {
  // The beam alone plus the body by hand: m (y + a θ)² + J θ², a = 0.02 m (y, θ of the end).
  const tests::Known known = known_ensemble(32, 6, 80, powers(0.3, 6));
  const Eigen::MatrixXd Phi = pomfs(shaken_beam(), places(shaken_beam()), known.ensemble).basis.vectors;
  ASSERT_EQ(Phi.cols(), 6);
  const fem::Beam alone(tests::without_tip_body(40));
  const Eigen::RowVectorXd y = alone.displacement_row(0.4).transpose() * Phi;
  const Eigen::RowVectorXd theta = alone.slope_row(0.4).transpose() * Phi;
  const Eigen::RowVectorXd centre = y + 0.02 * theta;
  const Eigen::MatrixXd gram = Phi.transpose() * fem::multiply(alone.structure().M(), Phi) +
                               0.0155 * centre.transpose() * centre + 3e-6 * theta.transpose() * theta;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(GramSchmidt, StaysOrthonormalForNearlyDependentColumns) {
  // Columns within 1e-8 of a plane lose eight digits in one pass; two leave rounding only.
  Random random(33);
  Eigen::MatrixXd V = natural_functions(shaken_beam(), 6).shapes * tests::normal_matrix(random, 6, 5);
  for (Eigen::Index j = 2; j < 5; ++j) V.col(j) = V.col(0) + V.col(1) + 1e-8 * V.col(j);
  const MassOrthonormal result = mass_orthonormalise(V, shaken_beam().structure().M());
  EXPECT_LT(orthonormality_error(result.vectors), 1e-12);
  EXPECT_LT((result.vectors * result.triangle - V).norm(), 1e-13 * V.norm());
  EXPECT_TRUE(result.triangle.isUpperTriangular(0.0));
  EXPECT_GT(result.triangle.diagonal().minCoeff(), 0.0);
}

TEST(GramSchmidt, RefusesDependentColumns) {
  Eigen::MatrixXd V = natural_functions(shaken_beam(), 3).shapes;
  V.col(2) = V.col(0) - 2.0 * V.col(1);
  EXPECT_THAT([&] { (void)mass_orthonormalise(V, shaken_beam().structure().M()); },
              ThrowsMessage<InvalidInput>(HasSubstr("vector 3 (from 1) depends")));
  EXPECT_THROW((void)mass_orthonormalise(V.topRows(4), shaken_beam().structure().M()), InvalidInput);
  V.col(1).setZero();
  EXPECT_THROW((void)mass_orthonormalise(V, shaken_beam().structure().M()), InvalidInput);
}

TEST(Pomf, SharesOfNaturalModesSumToOne) {
  const tests::Known known = known_ensemble(34, 6, 80, powers(0.5, 5));
  const fem::Matrix& M = shaken_beam().structure().M();
  const fem::Modes all = fem::natural_modes(shaken_beam().structure());
  const fem::Modes five{all.omega.head(5), all.shapes.leftCols(5)};
  const Basis by_five = pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.functions = 5}).basis;
  const Basis by_powers =
      pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.family = FitFamily::kPolynomials, .functions = 5})
          .basis;
  EXPECT_LT((mode_shares(by_five, five, M).rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-11);
  EXPECT_LT((mode_shares(by_powers, all, M).rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-11);
  EXPECT_LT(mode_shares(by_powers, all, M).colwise().sum().maxCoeff(), 1.0 + 1e-11);  // Bessel
  EXPECT_LT(mode_shares(by_powers, five, M).rowwise().sum().maxCoeff(), 1.0 - 1e-6);  // powers are no natural modes
}

TEST(Pomf, SharesOfAKnownMixtureAreItsSquares) {
  const fem::Modes modes = fem::natural_modes(shaken_beam().structure(), 4);
  Basis basis;
  basis.vectors = 7.0 * (0.6 * modes.shapes.col(0) - 0.8 * modes.shapes.col(2));
  const Eigen::RowVector4d expected(0.36, 0.0, 0.64, 0.0);
  EXPECT_LT((mode_shares(basis, modes, shaken_beam().structure().M()) - expected).norm(), 1e-12);
  basis.vectors.setZero();
  EXPECT_THROW((void)mode_shares(basis, modes, shaken_beam().structure().M()), InvalidInput);
  basis.vectors = Eigen::VectorXd::Ones(3);
  EXPECT_THROW((void)mode_shares(basis, modes, shaken_beam().structure().M()), InvalidInput);
}

TEST(Pomf, MassSharesAreWhatThePomfsCaptureOfTheFittedMotion) {
  const tests::Known known = known_ensemble(35, 6, 200, powers(0.5, 6));
  const ModalFit fit(places(shaken_beam()), natural_functions(shaken_beam(), 5));
  const Ensemble fitted{fit.motion(known.ensemble.snapshots)};
  const PomfResult three =
      pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.functions = 5, .pod = {.choice = {.modes = 3}}});
  const Eigen::VectorXd captured = captured_energy(fitted, three.basis, shaken_beam().structure().M());
  EXPECT_NEAR(three.mass_shares[0], captured[0], 1e-11);
  EXPECT_NEAR(three.mass_shares.sum(), captured[2], 1e-11);
  const PomfResult five =
      pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.functions = 5, .pod = {.choice = {.modes = 5}}});
  EXPECT_NEAR(five.mass_shares.sum(), 1.0, 1e-11);
}

TEST(Pomf, OfFullRankSpanWhatThePomsOfAllDegreesOfFreedomSpan) {
  Random random(36);
  const Eigen::MatrixXd motion = natural_functions(shaken_beam(), 4).shapes * tests::normal_matrix(random, 4, 60);
  const SensorArray sensors(shaken_beam(), evenly_spaced(12, 0.4));
  const PomfResult found =
      pomfs(shaken_beam(), sensors, {sensors.readings(motion)}, {.functions = 4, .pod = {.choice = {.modes = 4}}});
  const PodResult best = mass_pod({motion}, shaken_beam().structure().M(), {.choice = {.modes = 4}});
  const fem::Matrix& M = shaken_beam().structure().M();
  EXPECT_LT(subspace_angles(found.basis.vectors, best.basis.vectors, M).maxCoeff(), 1e-9);
  EXPECT_LT((found.basis.mean - best.basis.mean).norm(), 1e-10 * motion.norm());
}

TEST(Pomf, FromStrainsBySixGaugesAndManyPseudoSensorsHaveRankSix) {
  // S4 section 5.4.1: pseudo-sensors add no information, the rank stays six.
  Random random(37);
  const Eigen::MatrixXd motion =
      natural_functions(shaken_beam(), 12).shapes * powers(0.5, 12).asDiagonal() * tests::normal_matrix(random, 12, 60);
  const ModalFit strains(tests::gauges(shaken_beam()), natural_functions(shaken_beam(), 6));
  const SensorArray pseudo(shaken_beam(), evenly_spaced(40, 0.4));
  const Ensemble y = converted({tests::gauges(shaken_beam()).readings(motion)}, strains, pseudo);
  const PomfResult found = pomfs(shaken_beam(), pseudo, y, {.functions = 6});
  EXPECT_EQ(found.discrete.rank, 6);
  EXPECT_EQ(found.basis.modes(), 6);
  EXPECT_LT(found.misfit, 1e-10);
  EXPECT_LT(orthonormality_error(found.basis.vectors), 1e-11);
}

TEST(Pomf, ByPolynomialsAreThosePolynomials) {
  // Motion a(t) s² + b(t) s³: both functions of the family, so the span and every reading come back.
  Random random(38);
  Eigen::MatrixXd shapes(shaken_beam().structure().size(), 2);
  shapes << tests::polynomial(shaken_beam(), {0.0, 0.0, 1.0}), tests::polynomial(shaken_beam(), {0.0, 0.0, 0.0, 1.0});
  const Eigen::MatrixXd motion = shapes * tests::normal_matrix(random, 2, 40);
  const PomfResult found = pomfs(shaken_beam(), places(shaken_beam()), {places(shaken_beam()).readings(motion)},
                                 {.family = FitFamily::kPolynomials, .functions = 2});
  ASSERT_EQ(found.basis.modes(), 2);
  const fem::Matrix& M = shaken_beam().structure().M();
  EXPECT_LT(subspace_angles(found.basis.vectors, shapes, M).maxCoeff(), 1e-10);
  EXPECT_LT(found.misfit, 1e-12);
}

TEST(Pomf, RefusesWhatCannotBeMade) {
  const tests::Known known = known_ensemble(39, 6, 30, powers(0.5, 6));
  EXPECT_THAT([&] { (void)pomfs(shaken_beam(), tests::gauges(shaken_beam()), known.ensemble); },
              ThrowsMessage<InvalidInput>(HasSubstr("Convert strains first")));
  EXPECT_THAT([&] { (void)pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.functions = 3}); },
              ThrowsMessage<InvalidInput>(HasSubstr("6 POMs kept, but 3 natural modes carry at most 3")));
  EXPECT_THAT([&] { (void)pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.functions = 7}); },
              ThrowsMessage<InvalidInput>(HasSubstr("more modal functions than 6 sensors can tell apart")));
  EXPECT_THROW((void)pomfs(shaken_beam(), places(shaken_beam()), known.ensemble, {.functions = -1}), InvalidInput);
  EXPECT_THROW((void)pomfs(shaken_beam(), places(shaken_beam()), {known.ensemble.snapshots.topRows(5)}), InvalidInput);
}

TEST(Basis, KindsHaveTheirWords) {
  EXPECT_EQ(to_string(BasisKind::kPom), "pom");
  EXPECT_EQ(to_string(BasisKind::kLnm), "lnm");
  EXPECT_EQ(to_string(BasisKind::kUser), "user");
  EXPECT_EQ(to_string(BasisKind::kPomf), "pomf");
  EXPECT_EQ(to_string(BasisKind::kLnmStatic), "lnm+static");
  EXPECT_EQ(to_string(BasisKind::kMassPom), "mass-pom");
}

}  // namespace
}  // namespace slipmode::pod
