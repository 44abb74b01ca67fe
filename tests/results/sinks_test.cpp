// Finished values through a journal and back: bit for bit, each kind in its own tables.

#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/results/map_store.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/trade_store.hpp>
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>

namespace slipmode {
namespace {

diagnostics::SweepPoint swept(std::size_t index, int model) {
  diagnostics::SweepPoint point{.index = index, .model = model, .parameter = 0.1 + static_cast<double>(index)};
  point.settled.mean_energy = 1.0 / 3.0;
  point.settled.slips = {{.time = 2.5, .contact = 1, .displacement = -0.0}};
  point.settled.end = {.time = 4.0, .q = Eigen::Vector2d(1.0, 2.0), .v = Eigen::Vector2d(3.0, 5e-324)};
  return point;
}

results::ExponentPoint exponents(std::size_t index, int model) {
  return {.index = index,
          .model = model,
          .parameter = 0.1 + static_cast<double>(index),
          .settled = {.nats = Eigen::Vector2d(0.25, -1.0), .error = Eigen::Vector2d(1e-3, 2e-3), .ended = "early"}};
}

// `diagnose --over` keeps a belt's diagram and the exponents in one journal: stopped among the exponents, it has to
// find both again. Read as one table, an exponents' line is too short for a swept motion and the study cannot go on.
TEST(Sinks, OfOneJournalKeepToTheirOwnTables) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "over.h5.journal";
  {
    results::Journal journal(path, "task");
    results::journal_sink(journal).store(swept(0, 0));
    results::journal_sink(journal).store(swept(1, 1));
    results::exponent_sink(journal).store(exponents(1, 0));
    results::exponent_sink(journal).store({.index = 2, .model = 1, .parameter = 2.1, .failure = "lost"});
  }
  results::Journal journal(path, "task");
  const diagnostics::SweepSink sweeps = results::journal_sink(journal);
  ASSERT_TRUE(sweeps.recall(0, 0) && sweeps.recall(1, 1));
  EXPECT_FALSE(sweeps.recall(1, 0));
  EXPECT_EQ(sweeps.recall(1, 1)->parameter, 1.1);
  EXPECT_EQ(sweeps.recall(0, 0)->settled.mean_energy, 1.0 / 3.0);
  EXPECT_TRUE(std::signbit(sweeps.recall(0, 0)->settled.slips[0].displacement));
  EXPECT_EQ(sweeps.recall(0, 0)->settled.end.v[1], 5e-324);

  const results::ExponentSink found = results::exponent_sink(journal);
  ASSERT_TRUE(found.recall(1, 0) && found.recall(2, 1));
  EXPECT_FALSE(found.recall(0, 0));
  EXPECT_TRUE(found.recall(1, 0)->ok());
  EXPECT_EQ(found.recall(1, 0)->settled.ended, "early");
  EXPECT_EQ(found.recall(1, 0)->settled.nats, Eigen::Vector2d(0.25, -1.0));
  EXPECT_EQ(found.recall(2, 1)->failure, "lost");
  EXPECT_FALSE(results::driven_journal_sink(journal).recall(0, 0));
}

// A row of a map holds failures of its points, one line each; the row itself went well.
TEST(Sinks, OfAMapGiveEveryPointItsOwnFailure) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "map.h5.journal";
  orbits::MapRow row{.index = 3, .parameter = 0.5, .settled = std::vector<orbits::MapPoint>(3)};
  row.settled[0].order = 2;
  row.settled[1].failure = "at time 2: no";
  {
    results::Journal journal(path, "task");
    results::map_sink(journal, "scene").store(row);
  }
  results::Journal journal(path, "task");
  EXPECT_FALSE(results::map_sink(journal, "centre").recall(3, 0));
  const auto found = results::map_sink(journal, "scene").recall(3, 0);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->ok());
  ASSERT_EQ(found->settled.size(), 3U);
  EXPECT_EQ(found->settled[0].order, 2);
  EXPECT_EQ(found->settled[1].failure, "at time 2: no");
  EXPECT_EQ(found->settled[2].failure, "");
}

// A configuration that cannot be measured is finished too: it is not measured anew, nor missing in a part.
TEST(Sinks, OfATradeKeepFailuresByName) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "trade.h5.journal";
  trade::Finished failed;
  failed.error.fill(std::numeric_limits<double>::quiet_NaN());
  failed.noise.fill(0.25);
  failed.failure = "at time 2: no\nthe step is too small";
  {
    results::Journal journal(path, "task");
    trade::StudyOptions options;
    results::keep_in(journal, options);
    options.store("tanh", failed);
  }
  results::Journal journal(path, "task");
  trade::StudyOptions options;
  results::keep_in(journal, options);
  EXPECT_FALSE(options.recall("tan"));
  const auto found = options.recall("tanh");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->failure, failed.failure);
  EXPECT_TRUE(std::isnan(found->error.front()));
  EXPECT_EQ(found->noise, failed.noise);
}

}  // namespace
}  // namespace slipmode
