// A sweep shared among ranks, here threads of one process that pass bytes through queues: every value is computed once,
// wherever that is fastest, and rank 0 has all. Under mpirun: tests/cli/ranks_test.cpp.

#include <slipmode/core/errors.hpp>
#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/results/crew.hpp>
#include "core/network.hpp"
#include "results/internal/journal_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <thread>

namespace slipmode::results {
namespace {

using std::chrono::microseconds;
using testing::HasSubstr;
using tests::Network;

std::vector<double> values_up_to(std::size_t count) {
  std::vector<double> values(count);
  std::iota(values.begin(), values.end(), 1.0);
  return values;
}

/// x ← cos x + value: what a chain gives depends on all before it, to the last bit.
struct Study {
  std::vector<double> values = values_up_to(200);
  SweepMode mode = SweepMode::kIndependent;
  std::size_t segments = 1;
  std::vector<microseconds> cost = {microseconds(200), microseconds(200), microseconds(200)};  ///< by rank
  bool for_all = false;
  const StopFlag* stop = nullptr;
  ProgressCallback progress = {};

  /// Counts what it computes.
  SweepOf<double> run(int rank, Journal& journal, std::atomic<int>& out_computed) const {
    auto sink = detail::table_sink<double>(journal, "t", [](detail::Line& line, auto& value) { line(value.settled); });
    sink.for_all = for_all;
    const auto settle = [&](std::size_t i, int, const double& start) {
      std::this_thread::sleep_for(cost[static_cast<std::size_t>(rank)]);
      ++out_computed;
      return std::cos(start) + values[i];
    };
    return SweepRunner<double, double>({.settle = settle, .carry = [](const double& end) { return end; }}, values, 0.5,
                                       mode, segments, {.threads = 2, .stop = stop, .progress = progress}, sink)
        .run_alone();
  }
  [[nodiscard]] std::vector<double> alone() const {
    Journal journal{{}};
    std::atomic<int> computed = 0;
    return results_of(run(0, journal, computed));
  }
  static std::vector<double> results_of(const SweepOf<double>& sweep) {
    std::vector<double> all;
    for (const auto& point : sweep.points) all.push_back(point.settled);
    return all;
  }
};

/// A study as three ranks.
struct Shared {
  std::vector<SweepOf<double>> found = std::vector<SweepOf<double>>(3);
  std::vector<std::atomic<int>> computed = std::vector<std::atomic<int>>(3);
  std::vector<JournalRecord> kept;  ///< by rank 0

  explicit Shared(const Study& study, std::vector<JournalRecord> before = {}) {
    Network network(3);
    std::vector<std::jthread> others;
    const auto one = [&](int rank, Journal& journal) {
      const Ranks ranks = network.rank(rank);
      const Crew crew(ranks, journal, "study");
      const auto k = static_cast<std::size_t>(rank);
      found[k] = study.run(rank, journal, computed[k]);
    };
    for (const int rank : {1, 2}) {
      others.emplace_back([&, rank] {
        Journal journal{{}};
        one(rank, journal);
      });
    }
    Journal journal{std::move(before)};
    one(0, journal);
    others.clear();
    kept = journal.records();
  }
  [[nodiscard]] int all_computed() const { return computed[0] + computed[1] + computed[2]; }
};

TEST(Crew, ComputesEveryValueOnceAndMoreOfThemWhereThatIsFaster) {
  Study study;
  study.cost[1] = microseconds(8000);
  const std::vector<double> expected = study.alone();
  std::vector<std::size_t> told;
  study.progress = [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 200U);
    told.push_back(done);
  };
  const Shared shared(study);
  EXPECT_EQ(shared.all_computed(), 200);
  EXPECT_EQ(Study::results_of(shared.found[0]), expected);
  EXPECT_GT(shared.computed[1], 0);
  EXPECT_GT(shared.computed[2], shared.computed[1]) << "forty times as fast";
  std::vector<std::size_t> each(200);
  std::iota(each.begin(), each.end(), 1U);
  EXPECT_EQ(told, each) << "of all ranks, in order";
  std::set<std::int64_t> kept;
  for (const JournalRecord& record : shared.kept) EXPECT_TRUE(kept.insert(record.index).second) << record.index;
  EXPECT_EQ(kept.size(), 200U);
}

TEST(Crew, KeepsAChainInOneRank) {
  Study study{.mode = SweepMode::kFollow, .segments = 9};
  EXPECT_EQ(Study::results_of(Shared(study).found[0]), study.alone());
  study.segments = 1;
  const Shared one(study);
  EXPECT_EQ(Study::results_of(one.found[0]), study.alone());
  for (const auto& computed : one.computed) EXPECT_TRUE(computed == 0 || computed == 200) << computed;
}

TEST(Crew, GivesAllRanksWhatAllGoOnFrom) {
  Study study{.for_all = true};
  const std::vector<double> expected = study.alone();
  const Shared shared(study);
  EXPECT_EQ(shared.all_computed(), 200);
  for (const auto& found : shared.found) EXPECT_EQ(Study::results_of(found), expected);
}

// The first 50 values of chains of 40 are there: the second chain goes on from its tenth.
TEST(Crew, GoesOnFromRankZerosJournal) {
  Study study{.mode = SweepMode::kFollow, .segments = 5};
  std::vector<JournalRecord> before = Shared(study).kept;
  std::erase_if(before, [](const JournalRecord& record) { return record.index >= 50; });
  std::vector<std::size_t> told;
  study.progress = [&](std::size_t done, std::size_t) { told.push_back(done); };
  const Shared shared(study, before);
  EXPECT_EQ(shared.all_computed(), 150);
  EXPECT_EQ(Study::results_of(shared.found[0]), study.alone());
  EXPECT_EQ(told.front(), 51U);
}

TEST(Crew, IsInterruptedEverywhereWhereOneRankIs) {
  for (const int stopped : {0, 2}) {
    StopFlag stop{false};
    Network network(3);
    std::vector<SweepOf<double>> found(3);
    std::vector<std::atomic<int>> computed(3);
    Journal kept{{}};
    {
      std::vector<std::jthread> all;
      for (const int rank : {0, 1, 2}) {
        all.emplace_back([&, rank] {
          Journal own{{}};
          Journal& journal = rank == 0 ? kept : own;
          const Ranks ranks = network.rank(rank);
          const Crew crew(ranks, journal, "study");
          const auto k = static_cast<std::size_t>(rank);
          found[k] = Study{.stop = rank == stopped ? &stop : nullptr}.run(rank, journal, computed[k]);
        });
      }
      while (computed[static_cast<std::size_t>(stopped)] < 3) std::this_thread::yield();
      stop = true;
    }
    EXPECT_TRUE(found[0].interrupted);
    EXPECT_TRUE(found[static_cast<std::size_t>(stopped)].interrupted);
    EXPECT_LT(kept.records().size(), 200U);
    EXPECT_EQ(static_cast<int>(kept.records().size()), computed[0] + computed[1] + computed[2]) << "nothing is lost";
  }
}

TEST(Crew, DoesNotWaitForARankThatHasDied) {
  StopFlag stop{false};
  Network network(2);
  const Ranks dead = network.rank(1);
  dead.send(0, "w1 1");  // took a piece
  Journal journal{{}};
  const Ranks ranks = network.rank(0);
  const Crew crew(ranks, journal, "study");
  std::atomic<int> computed = 0;
  const auto begin = std::chrono::steady_clock::now();
  std::jthread stopper([&] {
    while (computed < 199) std::this_thread::yield();
    stop = true;  // as mpirun does when a rank has died, here of its last value: rank 0 has no other to compute
  });
  const auto found = Study{.cost = {microseconds(1)}, .stop = &stop}.run(0, journal, computed);
  EXPECT_TRUE(found.interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

TEST(Crew, TellsWhyARankFailedAndWhich) {
  Network network(2);
  std::jthread other([&] {
    const Ranks ranks = network.rank(1);
    Journal journal{{}};
    try {
      const Crew crew(ranks, journal, "another study");
    } catch (const InvalidInput& error) {
      EXPECT_EQ(end_ranks(ranks, 2, error.what()), 0) << "the launcher is to tell rank 0's code";
    }
  });
  const Ranks ranks = network.rank(0);
  Journal journal{{}};
  const Crew crew(ranks, journal, "study");
  std::atomic<int> computed = 0;
  Study study;
  study.cost[0] = microseconds(2000);
  try {
    (void)study.run(0, journal, computed);
    FAIL() << "went on";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("rank 1: its study is another than rank 0's"));
  }
  EXPECT_LT(computed, 200);
  EXPECT_EQ(network.left, 0);
  EXPECT_EQ(end_ranks(ranks, 2, "it"), 2);
  EXPECT_EQ(network.aborted, 2);
}

TEST(JournalLine, GivesTheRecordBackUnlessItIsAltered) {
  const JournalRecord record{.table = "t-0", .index = 7, .values = {0.1, -1e-310, INFINITY}, .note = "a\nb \\n"};
  const std::string line = to_line(record), body = line.substr(0, line.size() - 1);
  const auto back = from_line(body);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->table, record.table);
  EXPECT_EQ(back->index, record.index);
  EXPECT_EQ(back->values, record.values);
  EXPECT_EQ(back->note, record.note);
  for (std::size_t k = 0; k < body.size(); ++k) {
    EXPECT_FALSE(from_line(body.substr(0, k))) << k;
    std::string altered = body;
    altered[k] = altered[k] == '1' ? '2' : '1';
    EXPECT_FALSE(from_line(altered)) << k;
  }
}

}  // namespace
}  // namespace slipmode::results
