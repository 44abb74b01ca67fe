#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/pod/pod.hpp>
#include "hundred_digits.hpp"
#include "known.hpp"
#include "pod/internal/accumulator.hpp"
#include "pod/internal/right_svd.hpp"
#include "pod/internal/triangle.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <vector>

namespace slipmode::pod {
namespace {

using tests::graded;
using tests::known_ensemble;
using tests::normal_matrix;
using tests::orthonormal;
using tests::powers;
using tests::singular_values_100_digits;
using tests::worst_relative;

TEST(PodAccuracy, DofsOverSixteenDecadesGiveEverySingularValueToRounding) {
  const Ensemble ensemble = graded(21, 60);
  for (const bool remove_mean : {false, true}) {
    const Eigen::VectorXd expected = singular_values_100_digits(ensemble.snapshots, remove_mean);
    ASSERT_LT(expected[8], 1e-15 * expected[0]);
    const PodResult qr = pod(ensemble, {.remove_mean = remove_mean, .rank_tolerance = 1e-20});
    EXPECT_EQ(qr.rank, 9);
    EXPECT_LT(worst_relative(qr.singular_values, expected), 1e-14);
  }
}

TEST(PodAccuracy, DecayIsFollowedByQrToRoundingAndByTheCovarianceToItsSquareRoot) {
  // Every dof decays alike: the covariance adds squares of size 1 and 1e-32 in every entry.
  Random random(20);
  Ensemble ensemble;
  ensemble.snapshots = normal_matrix(random, 9, 9) * powers(0.01, 9).asDiagonal();
  const Eigen::VectorXd expected = singular_values_100_digits(ensemble.snapshots, false);
  ASSERT_LT(expected[8], 1e-15 * expected[0]);
  const PodResult qr = pod(ensemble, {.remove_mean = false, .rank_tolerance = 1e-20});
  EXPECT_LT((qr.singular_values - expected).cwiseAbs().maxCoeff(), 2e-16 * expected[0]);
  EXPECT_LT(worst_relative(qr.singular_values.head(7), expected.head(7)), 1e-3);  // down to 1e-12 of the first
  const PodResult squared =
      pod(ensemble, {.method = PodMethod::kCovariance, .remove_mean = false, .rank_tolerance = 1e-20});
  const Eigen::ArrayXd lost = ((squared.singular_values - expected).array() / expected.array()).abs();
  EXPECT_LT(lost.head(3).maxCoeff(), 1e-6);
  EXPECT_GT(lost.tail(4).minCoeff(), 0.5);  // below 1e-8 of the first nothing is left
}

TEST(PodAccuracy, EvenlyMixedModesAreAccurateToRoundingOfTheLargest) {
  // U dense: storing the snapshots already costs ε σ_1, so an absolute bound is all there is. Expected: construction.
  const auto known = known_ensemble(22, 17, 400, powers(0.1, 17), 0.0);
  const PodResult qr = pod(known.ensemble, {.remove_mean = false});
  EXPECT_LT((qr.singular_values - known.sigma).cwiseAbs().maxCoeff(), 1e-15);
  const PodResult squared = pod(known.ensemble, {.method = PodMethod::kCovariance, .remove_mean = false});
  EXPECT_GE(qr.rank, 13);
  EXPECT_LE(squared.rank, 8);
  EXPECT_GT((squared.singular_values - known.sigma).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(PodAccuracy, JacobiIsRelativelyAccurateWhereEigensIsNot) {
  // Expected: 100 digits, undoing the division by sqrt(9).
  Random random(23);
  const Eigen::MatrixXd A = normal_matrix(random, 9, 9) * powers(0.01, 9).asDiagonal();
  const Eigen::VectorXd expected = 3.0 * singular_values_100_digits(A.transpose(), false);
  const Eigen::VectorXd ours = right_svd_jacobi(A).sigma;
  EXPECT_LT(((ours - expected).array() / expected.array()).abs().maxCoeff(), 1e-14);
}

TEST(PodAccuracy, DivideAndConquerAboveItsLimitAgreesWithJacobi) {
  Random random(24);
  const Eigen::MatrixXd A = orthonormal(normal_matrix(random, 270, 270)) * powers(0.97, 270).asDiagonal();
  const RightSvd bdc = right_svd(A);  // more than 256 columns
  const RightSvd jacobi = right_svd_jacobi(A);
  EXPECT_LT((bdc.sigma - jacobi.sigma).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((jacobi.sigma - powers(0.97, 270)).cwiseAbs().maxCoeff(), 1e-14);  // the construction
  EXPECT_LT(tests::misalignment(bdc.vectors, jacobi.vectors), 1e-11);
}

TEST(PodAccuracy, ExtremeScalesNeitherOverflowNorUnderflow) {
  Random random(25);
  const Eigen::MatrixXd A = normal_matrix(random, 6, 6);
  const Eigen::VectorXd plain = right_svd_jacobi(A).sigma;
  for (const double scale : {std::ldexp(1.0, -900), std::ldexp(1.0, 900)}) {
    EXPECT_EQ(right_svd_jacobi(scale * A).sigma / scale, plain);  // powers of two change no digit
  }
  EXPECT_EQ(right_svd_jacobi(Eigen::MatrixXd::Zero(3, 3)).sigma, Eigen::Vector3d::Zero());
}

TEST(Triangle, AbsorbingRowsEqualsOneHouseholderQr) {
  // n = 70 crosses two panels; row counts below, at and above n.
  Random random(26);
  const Eigen::MatrixXd A = normal_matrix(random, 211, 70);
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(70, 70);
  Eigen::Index begin = 0;
  for (const Eigen::Index count : {1, 9, 70, 131}) {
    Eigen::MatrixXd rows = A.middleRows(begin, count);
    absorb_rows(R, rows);
    begin += count;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  const Eigen::MatrixXd expected = qr.matrixQR().topRows(70).triangularView<Eigen::Upper>();
  const Eigen::MatrixXd found = R.triangularView<Eigen::Upper>();
  EXPECT_LT((found.cwiseAbs() - expected.cwiseAbs()).cwiseAbs().maxCoeff(), 1e-12);  // rows are known up to sign
  EXPECT_LT((found.transpose() * found - A.transpose() * A).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(PodAccumulator, BytesDoNotDependOnHowTheStreamIsCut) {
  const auto known = known_ensemble(27, 10, 1000, powers(0.7, 10), 5.0);
  const PodResult whole = pod(known.ensemble);
  for (const Eigen::Index size : {1, 7, 255, 256, 257, 999}) {
    PodAccumulator accumulator(10);
    for (Eigen::Index begin = 0; begin < 1000; begin += size) {
      accumulator.add(known.ensemble.snapshots.middleCols(begin, std::min(size, 1000 - begin)));
    }
    EXPECT_EQ(accumulator.snapshots(), 1000);
    const PodResult streamed = accumulator.finish();
    EXPECT_EQ(streamed.singular_values, whole.singular_values);
    EXPECT_EQ(streamed.basis.vectors, whole.basis.vectors);
    EXPECT_EQ(streamed.basis.mean, whole.basis.mean);
  }
}

TEST(PodAccumulator, OnePassUnderALargeDriftingMeanEqualsTwoPasses) {
  // The mean moves from group to group and dwarfs the motion; expected by the tall route: mean first, then one QR.
  Random random(28);
  Ensemble ensemble;
  ensemble.snapshots = normal_matrix(random, 6, 2000);
  for (Eigen::Index t = 0; t < 2000; ++t) ensemble.snapshots.col(t).array() += 1e5 + 0.01 * static_cast<double>(t);
  Eigen::MatrixXd centred = ensemble.snapshots.colwise() - ensemble.snapshots.rowwise().mean().eval();
  centred.colwise() -= centred.rowwise().mean().eval();
  const Eigen::VectorXd expected =
      Eigen::JacobiSVD<Eigen::MatrixXd>(centred.transpose()).singularValues() / std::sqrt(2000.0);
  const PodResult streamed = pod(ensemble);
  EXPECT_LT(((streamed.singular_values - expected).array() / expected.array()).abs().maxCoeff(), 1e-11);
}

TEST(PodAccumulator, MayBeAskedBeforeTheStreamEnds) {
  const auto known = known_ensemble(29, 5, 300, powers(0.5, 5));
  PodAccumulator accumulator(5);
  accumulator.add(known.ensemble.snapshots.leftCols(100));
  const PodResult part = accumulator.finish();
  accumulator.add(known.ensemble.snapshots.rightCols(200));
  EXPECT_EQ(part.singular_values, pod({.snapshots = known.ensemble.snapshots.leftCols(100)}).singular_values);
  EXPECT_EQ(accumulator.finish().singular_values, pod(known.ensemble).singular_values);
}

TEST(PodAccumulator, FewerSnapshotsThanDofsGiveTheTallResult) {
  const auto known = known_ensemble(30, 40, 9, powers(0.5, 6));
  PodAccumulator accumulator(40);
  accumulator.add(known.ensemble.snapshots);
  const PodResult streamed = accumulator.finish();
  const PodResult tall = pod(known.ensemble);
  EXPECT_EQ(streamed.rank, 6);
  EXPECT_EQ(streamed.singular_values.size(), 9);
  EXPECT_LT((streamed.singular_values - tall.singular_values).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(PodAccumulator, RefusesBadBlocksAndStaysUsable) {
  const auto known = known_ensemble(31, 4, 50, powers(0.5, 4));
  PodAccumulator accumulator(4);
  accumulator.add(known.ensemble.snapshots);
  EXPECT_THROW(accumulator.add(Eigen::MatrixXd::Ones(3, 2)), InvalidInput);
  EXPECT_THROW(accumulator.add(Eigen::MatrixXd::Constant(4, 2, std::nan(""))), InvalidInput);
  EXPECT_EQ(accumulator.finish().singular_values, pod(known.ensemble).singular_values);
  EXPECT_THROW((void)PodAccumulator(4).finish(), InvalidInput);
  EXPECT_THROW(PodAccumulator(4, {.method = PodMethod::kLanczos}), InvalidInput);
  EXPECT_THROW(PodAccumulator(0), InvalidInput);
}

}  // namespace
}  // namespace slipmode::pod
