#include <slipmode/core/parallel.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <string>

namespace slipmode {
namespace {

/// Work of uneven length whose result depends on the index alone.
double uneven_sum(std::size_t i) {
  Random random = Random::stream(7, i);
  double sum = 0.0;
  for (std::size_t k = 0; k < 50 + 400 * (i % 7); ++k) sum += random.normal() / (1.0 + static_cast<double>(k));
  return sum;
}

std::vector<double> run_uneven(int threads) {
  std::vector<double> results(301);
  rethrow_first(parallel_for(results.size(), {.threads = threads}, [&](std::size_t i) { results[i] = uneven_sum(i); }));
  return results;
}

TEST(ParallelFor, GivesTheSameBytesForAnyNumberOfThreads) {
  const std::vector<double> one = run_uneven(1);
  for (const int threads : {2, 3, 8}) {
    const std::vector<double> many = run_uneven(threads);
    EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(double)), 0) << threads << " threads";
  }
}

TEST(ParallelFor, CallsEveryItemOnce) {
  std::vector<std::atomic<int>> calls(1000);
  const BatchResult batch = parallel_for(calls.size(), {.threads = 4}, [&](std::size_t i) { ++calls[i]; });
  EXPECT_FALSE(batch.interrupted);
  for (const auto& count : calls) EXPECT_EQ(count.load(), 1);
}

TEST(ParallelFor, KeepsAnExceptionWithItsItemAndFinishesTheOthers) {
  std::vector<int> done(20, 0);
  const BatchResult batch = parallel_for(done.size(), {.threads = 2}, [&](std::size_t i) {
    if (i % 5 == 3) throw std::runtime_error("item " + std::to_string(i));
    done[i] = 1;
  });
  for (std::size_t i = 0; i < done.size(); ++i) {
    EXPECT_EQ(batch.errors[i] != nullptr, i % 5 == 3);
    EXPECT_EQ(done[i], i % 5 == 3 ? 0 : 1);
  }
  try {
    rethrow_first(batch);
    FAIL() << "expected the first error";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "item 3");
  }
}

TEST(ParallelFor, StopsBetweenItemsWhenTheFlagIsSet) {
  StopFlag stop{false};
  const BatchResult batch = parallel_for(100, {.threads = 1, .stop = &stop}, [&](std::size_t i) {
    if (i == 9) stop = true;
  });
  EXPECT_TRUE(batch.interrupted);
  EXPECT_EQ(std::accumulate(batch.started.begin(), batch.started.end(), 0), 10);
  EXPECT_THROW(rethrow_first(batch), Interrupted);
}

TEST(ParallelFor, ReportsProgressOncePerItemUpToAll) {
  std::vector<std::size_t> seen;
  parallel_for(50, {.threads = 3, .progress = [&](std::size_t done, std::size_t) { seen.push_back(done); }},
               [](std::size_t) {});
  std::vector<std::size_t> expected(50);
  std::iota(expected.begin(), expected.end(), 1);
  EXPECT_EQ(seen, expected);
}

TEST(ParallelFor, AcceptsNothingToDo) {
  const BatchResult batch = parallel_for(0, {.threads = 4}, [](std::size_t) { FAIL(); });
  EXPECT_FALSE(batch.interrupted);
}

TEST(ParallelFor, RefusesNegativeThreads) {
  EXPECT_THROW(parallel_for(1, {.threads = -1}, [](std::size_t) {}), InvalidInput);
}

/// A chain 0 → 1 → … → m−1 in which every link also frees a leaf: x_{i+1} = cos(x_i) + i, leaf_i = sin(x_i).
std::vector<double> run_chain(int threads) {
  constexpr std::size_t m = 200;
  std::vector<double> values(2 * m, 0.0);
  const bool finished = run_tasks({0}, 2 * m, {.threads = threads}, [&](std::size_t id) -> std::vector<std::size_t> {
    if (id >= m) {
      values[id] = std::sin(values[id - m]);
      return {};
    }
    values[id] = id == 0 ? 1.0 : std::cos(values[id - 1]) + static_cast<double>(id);
    if (id + 1 < m) return {id + 1, m + id};
    return {m + id};
  });
  EXPECT_TRUE(finished);
  return values;
}

TEST(RunTasks, FollowsDependenciesWithTheSameBytesForAnyNumberOfThreads) {
  const std::vector<double> one = run_chain(1);
  EXPECT_NE(one.back(), 0.0);
  for (const int threads : {2, 5}) EXPECT_EQ(run_chain(threads), one);
}

TEST(RunTasks, ThrowsWhatATaskThrew) {
  const auto run = [](std::size_t id) -> std::vector<std::size_t> {
    if (id == 3) throw InvalidInput("three");
    return {id + 1};
  };
  EXPECT_THROW(run_tasks({0}, 10, {.threads = 2}, run), InvalidInput);
}

// Ten times seven ids, each time when none is ready; whoever asks, one at a time.
TEST(RunTasks, AsksForMoreUntilThereIsNone) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> runs(80);
    std::atomic<int> asking = 0, asked = 0;
    const auto more = [&] {
      EXPECT_EQ(++asking, 1);
      std::vector<std::size_t> next;
      for (std::size_t k = 0; asked < 10 && k < 7; ++k) next.push_back(10 + 7 * static_cast<std::size_t>(asked) + k);
      ++asked;
      --asking;
      return next;
    };
    const auto run = [&](std::size_t id) -> std::vector<std::size_t> {
      ++runs[id];
      return id < 9 ? std::vector{id + 1} : std::vector<std::size_t>();
    };
    EXPECT_TRUE(run_tasks({0}, 80, {.threads = threads}, run, more));
    for (const auto& one : runs) EXPECT_EQ(one, 1);
    EXPECT_EQ(asked, 11) << "the last time in vain";
  }
}

TEST(RunTasks, ThrowsWhatAskingThrew) {
  const auto more = []() -> std::vector<std::size_t> { throw InvalidInput("no more"); };
  EXPECT_THROW(run_tasks(
                   {}, 0, {.threads = 3}, [](std::size_t) { return std::vector<std::size_t>(); }, more),
               InvalidInput);
}

TEST(RunTasks, EndsEarlyWhenTheFlagIsSet) {
  StopFlag stop{false};
  int runs = 0;
  const bool finished =
      run_tasks({0}, 10, {.threads = 1, .stop = &stop}, [&](std::size_t id) -> std::vector<std::size_t> {
        ++runs;
        stop = id == 4;
        return {id + 1};
      });
  EXPECT_FALSE(finished);
  EXPECT_EQ(runs, 5);
}

}  // namespace
}  // namespace slipmode
