// The decomposition of snapshots that lie on several ranks, here threads of one process: the bytes of one process,
// however they are shared out. Under mpirun: tests/cli/pod_of_ranks_test.cpp.

#include <slipmode/pod/pod_of_ranks.hpp>

#include <slipmode/core/errors.hpp>
#include "core/network.hpp"
#include "hundred_digits.hpp"
#include "known.hpp"
#include "pod/internal/shares.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <chrono>
#include <exception>
#include <set>
#include <thread>

namespace slipmode::pod {
namespace {

using testing::HasSubstr;
using tests::known_ensemble;
using tests::powers;

using Counts = std::vector<Eigen::Index>;

/// What rank 0 finds of snapshots of which each rank has so many. Then the ranks end.
/// @param late  a rank that looks seldom for what has arrived; -1: none
PodResult shared_pod(const Eigen::MatrixXd& snapshots, const Counts& counts, const PodOptions& options = {},
                     int late = -1) {
  tests::Network network(static_cast<int>(counts.size()));
  std::optional<PodResult> found;
  std::vector<std::exception_ptr> errors(counts.size());
  {
    std::vector<std::jthread> ranks;
    Eigen::Index begin = 0;
    for (std::size_t r = 0; r < counts.size(); ++r) {
      ranks.emplace_back([&, r, share = Eigen::MatrixXd(snapshots.middleCols(begin, counts[r]))] {
        Ranks own = network.rank(static_cast<int>(r));
        if (own.own == late) {
          own.receive = [receive = own.receive] {
            std::this_thread::sleep_for(std::chrono::milliseconds(4));
            return receive();
          };
        }
        Exchange exchange(own, nullptr);
        try {
          auto result = pod_of_ranks(share, exchange, options);
          EXPECT_EQ(result.has_value(), r == 0);
          if (result) found = std::move(result);
        } catch (const std::exception& error) {
          errors[r] = std::current_exception();
          if (r != 0) own.send(0, std::string("f2 ") + error.what());  // as end_ranks() does
        }
        if (r == 0 || !errors[r]) end_ranks(own, 0, "");
      });
      begin += counts[r];
    }
  }
  if (errors.front()) std::rethrow_exception(errors.front());
  return found.value();
}

void expect_same(const PodResult& found, const PodResult& expected) {
  EXPECT_EQ(found.singular_values, expected.singular_values);
  EXPECT_EQ(found.shares, expected.shares);
  EXPECT_EQ(found.rank, expected.rank);
  EXPECT_EQ(found.mean_square, expected.mean_square);
  EXPECT_EQ(found.basis.vectors, expected.basis.vectors);
  EXPECT_EQ(found.basis.mean, expected.basis.mean);
  EXPECT_EQ(found.basis.provenance, expected.basis.provenance);
}

// Blocks of 4096: 30,000 snapshots have eight, the last shorter. Shares are even, uneven, empty, end with a block,
// begin with one, and lie inside one.
TEST(PodOfRanks, HasTheBytesOfOneProcessHoweverSnapshotsAreShared) {
  const auto known = known_ensemble(41, 12, 30000, powers(0.6, 12), 5.0);
  const Eigen::MatrixXd& X = known.ensemble.snapshots;
  const PodResult one = pod(known.ensemble);
  EXPECT_LT((one.singular_values - known.sigma).cwiseAbs().maxCoeff(), 1e-13) << "the construction";
  EXPECT_LT(tests::misalignment(one.basis.vectors, known.modes), 1e-12);
  EXPECT_LT((one.basis.mean - known.mean).cwiseAbs().maxCoeff(), 1e-13);
  for (const Counts& counts :
       {Counts{30000}, Counts{15000, 15000}, Counts{10000, 10000, 10000}, Counts{7500, 7500, 7500, 7500},
        Counts{0, 30000}, Counts{30000, 0, 0}, Counts{1, 29998, 1}, Counts{4096, 8192, 0, 17712},
        Counts{100, 200, 300, 29400}, Counts{9000, 500, 500, 500, 19500}, Counts{0, 0, 4096, 4096, 21808},
        Counts{1000, 0, 29000}, Counts(30, 1000)}) {
    SCOPED_TRACE(testing::PrintToString(counts));
    expect_same(shared_pod(X, counts), one);
  }
  const PodOptions kept{.choice = {.modes = 3}, .remove_mean = false};
  expect_same(shared_pod(X, {11000, 8000, 11000}, kept), pod(known.ensemble, kept));
}

// Rank 3 gives to rank 2, and that to rank 0, which is done when rank 3 may not have seen yet that rank 2 has all.
TEST(PodOfRanks, EndsAllRanksWhenOneIsLate) {
  const auto known = known_ensemble(48, 5, 32768, powers(0.6, 5));
  const PodResult one = pod(known.ensemble);
  for (int run = 0; run < 10; ++run)
    for (const int late : {1, 2, 3}) expect_same(shared_pod(known.ensemble.snapshots, Counts(4, 8192), {}, late), one);
}

// A triangle of 300 rows travels in two parts, and is decomposed as one of more than 256 columns.
TEST(PodOfRanks, OfManyDegreesOfFreedomHasTheBytesOfOneProcess) {
  const auto known = known_ensemble(46, 300, 10000, powers(0.9, 20));
  const PodResult one = pod(known.ensemble);
  EXPECT_LT((one.singular_values.head(20) - known.sigma).cwiseAbs().maxCoeff(), 1e-13) << "the construction";
  expect_same(shared_pod(known.ensemble.snapshots, {3000, 3000, 4000}), one);
}

// Few modes of more than 1,000 degrees of freedom: one process takes Lanczos on the snapshots, ranks on their triangle.
TEST(PodOfRanks, GivesFewModesOfManyDegreesOfFreedomAsOneProcessDoes) {
  const auto known = known_ensemble(47, 1100, 5000, powers(0.6, 12), 3.0);
  const PodOptions few{.choice = {.modes = 6}};
  const PodResult one = pod(known.ensemble, few), found = shared_pod(known.ensemble.snapshots, {2000, 3000}, few);
  EXPECT_THAT(one.basis.provenance, HasSubstr("Lanczos"));
  EXPECT_EQ(found.basis.provenance, one.basis.provenance);
  const auto apart = [](const auto& a, const auto& b) { return (a - b).cwiseAbs().maxCoeff(); };
  EXPECT_LT(apart(found.singular_values, one.singular_values), 1e-12);
  EXPECT_LT(apart(found.shares, one.shares), 1e-12);
  EXPECT_LT(apart(found.basis.vectors, one.basis.vectors), 1e-12);
  EXPECT_LT(apart(found.basis.mean, one.basis.mean), 1e-12);
  EXPECT_NEAR(found.mean_square, one.mean_square, 1e-12);
  EXPECT_LT(apart(found.singular_values, known.sigma.head(6)), 1e-12) << "the construction";
}

// Fewer snapshots than degrees of freedom, and a block of them: rank 0 gets them whole.
TEST(PodOfRanks, OfFewSnapshotsHasTheBytesOfOneProcess) {
  const auto few = known_ensemble(42, 40, 9, powers(0.5, 6));
  expect_same(shared_pod(few.ensemble.snapshots, {0, 4, 5}), pod(few.ensemble));
  const auto block = known_ensemble(43, 40, 4096, powers(0.5, 6));
  expect_same(shared_pod(block.ensemble.snapshots, {0, 1000, 3000, 96}), pod(block.ensemble));
}

// Degrees of freedom over sixteen decades: nothing is lost on the way (theory, 2). Expected: 100 digits.
TEST(PodOfRanks, KeepsSingularValuesOverSixteenDecades) {
  const Ensemble ensemble = tests::graded(44, 10000);
  for (const bool remove_mean : {false, true}) {
    const PodOptions options{.remove_mean = remove_mean, .rank_tolerance = 1e-20};
    const PodResult found = shared_pod(ensemble.snapshots, {3000, 4000, 3000}, options);
    const Eigen::VectorXd expected = tests::singular_values_100_digits(ensemble.snapshots, remove_mean);
    ASSERT_LT(expected[8], 1e-15 * expected[0]);
    EXPECT_LT(tests::worst_relative(found.singular_values, expected), 1e-14);
    expect_same(found, pod(ensemble, options));
  }
}

TEST(PodOfRanks, TellsWhatIsWrongAndWhere) {
  const auto known = known_ensemble(45, 4, 5000, powers(0.5, 4));
  Eigen::MatrixXd X = known.ensemble.snapshots;
  EXPECT_THROW((void)shared_pod(X, {2500, 2500}, {.choice = {.modes = 5}}), InvalidInput);
  EXPECT_THROW((void)shared_pod(X, {2500, 2500}, {.method = PodMethod::kCovariance}), InvalidInput);
  EXPECT_THROW((void)shared_pod(X.leftCols(1), {0, 1}), InvalidInput);
  X(2, 3000) = std::nan("");
  try {
    (void)shared_pod(X, {2500, 2500});
    FAIL() << "took it";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("rank 1: ensemble: snapshot 3001 (from 1), dof 3 (from 1) is nan"));
  }
}

TEST(PodOfRanks, IsStopped) {
  tests::Network network(2);
  const Ranks zero = network.rank(0);
  StopFlag stop{true};
  Exchange exchange(zero, &stop);
  EXPECT_THROW((void)pod_of_ranks(Eigen::MatrixXd::Ones(3, 5), exchange), Interrupted);
}

// Every block is one rank's, every triangle but one is joined to another once, and the last is rank 0's first.
TEST(Shares, GiveEveryBlockToOneRankAndJoinAll) {
  for (const Counts& counts : {Counts{0, 0, 70, 5, 3, 2, 130}, Counts{10, 0, 0}, Counts{95, 1, 4, 10}, Counts{1, 1, 1},
                               Counts{20, 20, 20, 20}, Counts{0, 35, 0, 65, 0}}) {
    SCOPED_TRACE(testing::PrintToString(counts));
    const Shares shares(counts, 10);
    Eigen::Index next = 0;
    for (int rank = 0; rank < shares.ranks(); ++rank) {
      EXPECT_EQ(std::min(shares.first_block(rank), shares.blocks()), std::min(next, shares.blocks()));
      next = std::max(next, shares.end_block(rank));
      EXPECT_TRUE(shares.head(rank) == 0 || shares.head_owner(rank) < rank);
    }
    EXPECT_EQ(next, shares.blocks());
    std::set<std::pair<int, std::size_t>> gone;
    for (const Join& join : joins_of(shares)) {
      EXPECT_LE(join.into, join.from);
      EXPECT_EQ(gone.count({join.into, join.into_place}), 0U);
      EXPECT_TRUE(gone.insert({join.from, join.from_place}).second);
    }
    EXPECT_EQ(gone.count({0, 0}), 0U);
  }
}

}  // namespace
}  // namespace slipmode::pod
