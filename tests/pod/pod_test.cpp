#include <slipmode/core/decompositions.hpp>
#include <slipmode/pod/pod.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/signs.hpp>
#include "known.hpp"

#include <gtest/gtest.h>
#include <string>

namespace slipmode::pod {
namespace {

using tests::known_ensemble;
using tests::misalignment;
using tests::powers;

std::string message_of(const auto& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no InvalidInput was thrown";
}

TEST(Pod, FindsSingularValuesModesAndMeanOfAConstructedEnsemble) {
  // Origin of the expected values: the factors the ensemble is built from.
  for (const auto method : {PodMethod::kAutomatic, PodMethod::kQrSvd, PodMethod::kCovariance}) {
    const auto known = known_ensemble(1, 10, 700, powers(0.5, 10));
    const PodResult result = pod(known.ensemble, {.method = method});
    EXPECT_LT((result.singular_values - known.sigma).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((result.basis.mean - known.mean).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT(misalignment(result.basis.vectors, known.modes), 1e-9);
    EXPECT_EQ(result.rank, 10);
    EXPECT_EQ(result.basis.kind, BasisKind::kPom);
    EXPECT_NEAR(result.mean_square, known.sigma.squaredNorm(), 1e-13);
  }
}

TEST(Pod, SharesAreSquaredSingularValuesAndSumToOne) {
  const auto known = known_ensemble(2, 8, 300, powers(0.6, 8));
  const Eigen::VectorXd expected = known.sigma.array().square() / known.sigma.squaredNorm();
  const PodResult result = pod(known.ensemble);
  EXPECT_LT((result.shares - expected).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_NEAR(result.shares.sum(), 1.0, 1e-14);
  EXPECT_EQ(result.basis.energy, result.shares);
}

TEST(Pod, LanczosSharesAreOfTheWholeEnergy) {
  const auto known = known_ensemble(3, 60, 400, powers(0.8, 60));
  const PodResult all = pod(known.ensemble, {.method = PodMethod::kQrSvd});
  const PodResult leading = pod(known.ensemble, {.choice = {.modes = 7}, .method = PodMethod::kLanczos});
  ASSERT_EQ(leading.shares.size(), 7);
  EXPECT_LT((leading.shares - all.shares.head(7)).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((leading.singular_values - all.singular_values.head(7)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(misalignment(leading.basis.vectors, all.basis.vectors.leftCols(7)), 1e-9);
}

TEST(Pod, LanczosKeepsItsDigitsUnderALargeOffset) {
  // The mean is 1e6 times the motion; entries carry rounding of 1e-10 of it. Expected: the construction.
  const auto known = known_ensemble(4, 50, 300, powers(0.5, 6), 1e6);
  for (const auto method : {PodMethod::kLanczos, PodMethod::kQrSvd}) {
    const PodResult result = pod(known.ensemble, {.choice = {.modes = 3}, .method = method});
    EXPECT_LT((result.singular_values.head(3) - known.sigma.head(3)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Pod, ChoosesTheSmallestNumberThatReachesTheShare) {
  // Shares by construction: 0.9, 0.09, 0.009, 0.001.
  const Eigen::VectorXd sigma = Eigen::Vector4d(0.9, 0.09, 0.009, 0.001).cwiseSqrt();
  const auto known = known_ensemble(5, 6, 200, sigma);
  const auto modes_at = [&](double energy, PodMethod method) {
    return pod(known.ensemble, {.choice = {.energy = energy}, .method = method}).basis.modes();
  };
  for (const auto method : {PodMethod::kQrSvd, PodMethod::kLanczos}) {
    EXPECT_EQ(modes_at(0.5, method), 1);
    EXPECT_EQ(modes_at(0.901, method), 2);
    EXPECT_EQ(modes_at(0.9899, method), 2);
    EXPECT_EQ(modes_at(0.9901, method), 3);
    EXPECT_EQ(modes_at(0.9995, method), 4);
  }
  EXPECT_EQ(modes_at(1.0, PodMethod::kQrSvd), 4);
}

TEST(Pod, AskingForMoreModesThanTheRankNamesTheRank) {
  const auto known = known_ensemble(6, 9, 50, powers(0.5, 3));
  EXPECT_EQ(pod(known.ensemble).rank, 3);
  EXPECT_EQ(pod(known.ensemble, {.choice = {.modes = 3}}).basis.modes(), 3);
  const std::string message = message_of([&] { (void)pod(known.ensemble, {.choice = {.modes = 4}}); });
  EXPECT_NE(message.find("rank 3"), std::string::npos) << message;
  EXPECT_NE(message.find("4 modes asked"), std::string::npos) << message;
}

TEST(Pod, RankOfAnExactSubspaceIsFoundFromManySnapshots) {
  // 50,000 snapshots of 12 dofs in a 5-dimensional subspace: noise stays below the rank threshold.
  const auto known = known_ensemble(7, 12, 50000, powers(0.3, 5));
  const PodResult result = pod(known.ensemble);
  EXPECT_EQ(result.rank, 5);
  EXPECT_LT(result.singular_values[5], 1e-15);
}

TEST(Pod, FewSnapshotsOfManyDofsGiveTheSameAsTheCovariance) {
  const auto known = known_ensemble(8, 200, 7, powers(0.5, 6));
  const PodResult result = pod(known.ensemble);
  EXPECT_EQ(result.singular_values.size(), 7);
  EXPECT_EQ(result.rank, 6);  // one direction of time is spent on the mean
  EXPECT_LT((result.singular_values.head(6) - known.sigma).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT(misalignment(result.basis.vectors, known.modes), 1e-12);
  EXPECT_NEAR(result.shares.sum(), 1.0, 1e-14);
  const PodResult squared = pod(known.ensemble, {.choice = {.modes = 6}, .method = PodMethod::kCovariance});
  EXPECT_LT(misalignment(result.basis.vectors, squared.basis.vectors), 1e-9);
}

TEST(Pod, BothQrRoutesAgreeWhereTheyMeet) {
  // T = n takes the row route, T = n − 1 the tall one: the first n − 1 columns differ from n by one repeated snapshot.
  const auto known = known_ensemble(9, 12, 11, powers(0.7, 5));
  Ensemble repeated = known.ensemble;
  repeated.snapshots.resize(12, 22);
  repeated.snapshots << known.ensemble.snapshots, known.ensemble.snapshots;
  const PodResult tall = pod(known.ensemble);
  const PodResult rows = pod(repeated);
  EXPECT_LT((tall.singular_values.head(5) - rows.singular_values.head(5)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT(misalignment(tall.basis.vectors, rows.basis.vectors), 1e-12);
}

TEST(Pod, OneDofHasOneMode) {
  Ensemble ensemble;
  ensemble.snapshots.resize(1, 4);
  ensemble.snapshots << 1.0, 3.0, 1.0, 3.0;
  const PodResult result = pod(ensemble);
  EXPECT_EQ(result.basis.vectors(0, 0), 1.0);
  EXPECT_NEAR(result.basis.mean[0], 2.0, 1e-15);
  EXPECT_NEAR(result.singular_values[0], 1.0, 1e-15);  // standard deviation of 1, 3, 1, 3
}

TEST(Pod, RemovingTheMeanEqualsGivingSnapshotsWithoutMean) {
  const auto known = known_ensemble(10, 10, 400, powers(0.6, 10), 3.0);
  Ensemble centred = known.ensemble;
  centred.snapshots.colwise() -= known.mean;
  const PodResult removed = pod(known.ensemble);
  const PodResult given = pod(centred, {.remove_mean = false});
  EXPECT_LT((removed.singular_values - given.singular_values).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT(misalignment(removed.basis.vectors, given.basis.vectors), 1e-11);
  EXPECT_EQ(given.basis.mean, Eigen::VectorXd::Zero(10));
}

TEST(Pod, OrderOfSnapshotsDoesNotMatter) {
  const auto known = known_ensemble(11, 10, 500, powers(0.6, 10));
  Ensemble reversed = known.ensemble;
  reversed.snapshots = known.ensemble.snapshots.rowwise().reverse();
  const PodResult a = pod(known.ensemble);
  const PodResult b = pod(reversed);
  EXPECT_LT((a.singular_values - b.singular_values).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((a.basis.vectors - b.basis.vectors).cwiseAbs().maxCoeff(), 1e-11);  // signs included
}

TEST(Pod, TheSameCallGivesTheSameBytes) {
  const auto known = known_ensemble(12, 30, 500, powers(0.8, 30));
  for (const auto method : {PodMethod::kQrSvd, PodMethod::kLanczos, PodMethod::kCovariance}) {
    const PodOptions options{.choice = {.modes = 4}, .method = method};
    EXPECT_EQ(pod(known.ensemble, options).basis.vectors, pod(known.ensemble, options).basis.vectors);
  }
}

TEST(Pod, LargestComponentIsPositiveAndTiesGoToTheFirst) {
  Eigen::MatrixXd vectors(3, 3);
  vectors << 0.1, -0.5, 0.5,  //
      -0.9, 0.5 + 1e-14, -0.5 - 1e-14, 0.2, 0.0, 0.1;
  fix_signs(vectors);
  EXPECT_EQ(vectors(1, 0), 0.9);
  EXPECT_EQ(vectors(0, 1), 0.5);
  EXPECT_EQ(vectors(0, 2), 0.5);
}

TEST(Pod, LargeProblemsOfFewModesGoToLanczosByThemselves) {
  const auto known = known_ensemble(13, 1100, 1050, powers(0.5, 8));
  const PodResult result = pod(known.ensemble, {.choice = {.energy = 0.99}});
  EXPECT_NE(result.basis.provenance.find("Lanczos"), std::string::npos) << result.basis.provenance;
  EXPECT_EQ(result.basis.modes(), 4);  // 1 − 4⁻⁴ is the first cumulative share ≥ 0.99 of ratio 1/4
  EXPECT_LT(misalignment(result.basis.vectors, known.modes.leftCols(4)), 1e-9);
}

TEST(Pod, NamesWhatIsWrongWithAnEnsemble) {
  Ensemble ensemble;
  ensemble.snapshots = Eigen::MatrixXd::Constant(3, 20, 0.1);
  EXPECT_NE(message_of([&] { (void)pod(ensemble); }).find("constant"), std::string::npos);
  EXPECT_NE(message_of([&] {
              (void)pod(ensemble, {.choice = {.modes = 1}, .method = PodMethod::kLanczos});
            }).find("constant"),
            std::string::npos);
  for (Eigen::Index j = 0; j < 20; j += 2) ensemble.snapshots(1, j) = std::nextafter(0.1, 1.0);
  EXPECT_NE(message_of([&] { (void)pod(ensemble); }).find("constant"), std::string::npos);  // one rounding apart
  ensemble.snapshots(2, 4) = std::nan("");
  EXPECT_NE(message_of([&] { (void)pod(ensemble); }).find("snapshot 5 (from 1), dof 3"), std::string::npos);
  ensemble.snapshots = Eigen::MatrixXd::Ones(3, 1);
  EXPECT_NE(message_of([&] { (void)pod(ensemble); }).find("at least 2"), std::string::npos);
}

TEST(Pod, NamesWhatIsWrongWithAChoice) {
  const auto known = known_ensemble(14, 5, 30, powers(0.5, 5));
  const auto refuse = [&](const PodOptions& options) {
    EXPECT_THROW((void)pod(known.ensemble, options), InvalidInput);
  };
  refuse({.choice = {.modes = -1}});
  refuse({.choice = {.modes = 6}});
  refuse({.choice = {.energy = 0.0}});
  refuse({.choice = {.energy = 1.1}});
  refuse({.rank_tolerance = -1.0});
  refuse({.choice = {.modes = 5}, .method = PodMethod::kLanczos});
  refuse({.choice = {.energy = 1.0}, .method = PodMethod::kLanczos});
}

TEST(Ensemble, JoinsRunsInOrder) {
  const std::vector<Eigen::MatrixXd> runs = {Eigen::MatrixXd::Constant(2, 3, 1.0), Eigen::MatrixXd::Constant(2, 1, 2.0),
                                             Eigen::MatrixXd::Constant(2, 2, 3.0)};
  const Ensemble joined = join(runs);
  EXPECT_EQ(joined.run_begin, (std::vector<Eigen::Index>{0, 3, 4}));
  EXPECT_EQ(joined.snapshots.row(1), (Eigen::RowVectorXd(6) << 1, 1, 1, 2, 3, 3).finished());
  const std::vector<Eigen::MatrixXd> uneven = {Eigen::MatrixXd::Ones(2, 3), Eigen::MatrixXd::Ones(3, 3)};
  EXPECT_THROW((void)join(uneven), InvalidInput);
  Ensemble misnumbered = joined;
  misnumbered.run_begin = {0, 4, 4};
  EXPECT_THROW(validate(misnumbered), InvalidInput);
}

TEST(Basis, TruncationKeepsTheLeadingVectorsAndTheirShares) {
  const auto known = known_ensemble(15, 6, 60, powers(0.5, 6));
  const Basis basis = pod(known.ensemble).basis;
  const Basis cut = basis.truncated(2);
  EXPECT_EQ(cut.vectors, basis.vectors.leftCols(2));
  EXPECT_EQ(cut.energy, basis.energy.head(2));
  EXPECT_EQ(cut.mean, basis.mean);
  EXPECT_THROW((void)basis.truncated(0), InvalidInput);
  EXPECT_THROW((void)basis.truncated(7), InvalidInput);
}

}  // namespace
}  // namespace slipmode::pod
