#include <slipmode/results/store.hpp>
#include "cli/slipmode_process.hpp"
#include "cli/small_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::HasSubstr;

/// What must not depend on the number of threads: everything but times.
nlohmann::json without_times(nlohmann::json summary) {
  for (const char* key : {"seconds", "folder", "report"}) summary.erase(key);
  summary["validation"].erase("cost");
  return summary;
}

TEST(Run, LeavesTablesDataAndFiguresInTheFolder) {
  const TemporaryFolder folder;
  write_file(folder.path() / "free.toml", kFreeEnds);
  const Outcome outcome = slipmode_in(folder, {"run", "free.toml", "-o", "out/free"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* said : {"modes", "ΔX", "ΔE", "motion", "Belt-speed sweep", "speed-up", "out/free"}) {
    EXPECT_THAT(outcome.out, HasSubstr(said));
  }
  const auto summary = nlohmann::json::parse(bytes_of(folder.path() / "out/free/summary.json"));
  for (const std::string name : summary["files"]) EXPECT_TRUE(fs::exists(folder.path() / "out/free" / name)) << name;
  EXPECT_GE(summary["figures"].size(), 14U);
  for (const std::string name : summary["figures"]) EXPECT_TRUE(is_figure(folder.path() / "out/free" / name)) << name;
  EXPECT_FALSE(fs::exists(folder.path() / "out/free.partial"));
}

// In a dimensionless scene every number of the model is a pure one; clocks still count seconds.
TEST(Run, OfADimensionlessSceneNamesNoDimensions) {
  const TemporaryFolder folder;
  write_file(folder.path() / "free.toml", kFreeEnds);
  ASSERT_EQ(slipmode_in(folder, {"run", "free.toml", "-o", "out", "--quiet"}).exit_code, 0);
  ASSERT_EQ(slipmode_in(folder, {"orbit", "find", "free.toml", "-o", "out/orbit.h5", "--quiet"}).exit_code, 0);
  for (const char* name : {"trajectory.h5", "ensemble.h5", "pod.h5", "reduced_pom.h5", "validation.h5", "orbit.h5"}) {
    for (const auto& entry : slipmode::results::StoreReader(folder.path() / "out" / name).entries()) {
      const std::string& units = entry.meaning.units;
      const bool clock = entry.name.starts_with("validation/cost/") && units == "s";
      const bool pure = units.empty() || units == "1" || units == "%" || units == "rad" || units.starts_with("bit");
      EXPECT_TRUE(clock || pure) << name << ": " << entry.name << " [" << units << "]";
    }
  }
}

TEST(Run, GivesTheSameForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  write_file(folder.path() / "free.toml", kFreeEnds);
  const Outcome one = slipmode_in(folder, {"run", "free.toml", "-o", "one", "--threads", "1", "--json"});
  const Outcome two = slipmode_in(folder, {"run", "free.toml", "-o", "two", "--threads", "2", "--json"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  ASSERT_EQ(two.exit_code, 0) << two.err;
  EXPECT_EQ(without_times(one.json()), without_times(two.json()));
  for (const char* name : {"trajectory.h5", "ensemble.h5", "pod.h5", "reduced_pom.h5", "reduced_lnm.h5"}) {
    EXPECT_EQ(bytes_of(folder.path() / "one" / name), bytes_of(folder.path() / "two" / name)) << name;
  }
}

TEST(Run, DoesOnlyWhatTheSceneAsksFor) {
  const TemporaryFolder folder;
  write_file(folder.path() / "two.toml", kTwoContacts);
  const Outcome outcome = slipmode_in(folder, {"run", "two.toml", "-o", "out", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["files"], nlohmann::json({"trajectory.h5"}));
  EXPECT_FALSE(outcome.json().contains("validation"));
  const auto left_out = outcome.json()["left_out"];
  ASSERT_EQ(left_out.size(), 2U);
  EXPECT_EQ(left_out[0]["brought_by"], "[ensemble]");
  EXPECT_EQ(left_out[1]["brought_by"], "[validation]");
}

TEST(Run, OfOwnMatricesWithAnEnsembleGivesModesAndReducedModels) {
  const TemporaryFolder folder;
  write_file(folder.path() / "own.toml", kOwnMatrices);
  const Outcome outcome = slipmode_in(folder, {"run", "own.toml", "-o", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name : {"ensemble.h5", "pod.h5", "reduced_pom.h5", "reduced_lnm.h5"}) {
    EXPECT_TRUE(fs::exists(folder.path() / "out" / name)) << name;
  }
  EXPECT_THAT(outcome.out, HasSubstr("reduction: "));
  EXPECT_THAT(outcome.out, HasSubstr("left out: comparison"));
  EXPECT_THAT(outcome.out, HasSubstr("[validation]"));
}

// An empty [validation] is enough: times and speeds are the structure's and the belt's own.
TEST(Run, OfOwnMatricesIsComparedInItsOwnTimes) {
  const TemporaryFolder folder;
  write_file(folder.path() / "own.toml", kOwnMatrices + "[validation]\n");
  const Outcome outcome = slipmode_in(folder, {"run", "own.toml", "-o", "out", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto validation = outcome.json()["validation"];
  EXPECT_FALSE(outcome.json().contains("left_out"));
  EXPECT_LT(validation["cost"]["duration"], 10.0) << "seconds; 10000 of them would be 1.6 million periods";
  EXPECT_EQ(validation["bifurcation"]["values"], 50);
  EXPECT_GT(validation["bifurcation"]["decided"], 15);
  for (const auto& row : validation["bases"]["POM"]["shares"]) {
    EXPECT_EQ(row.contains("failure"), row["modes"] < 2) << row << ": one mode cannot tell two contacts apart";
  }
}

// Slowest period 14 μs: 500 units of time of portraits would be 35 million periods.
TEST(Run, OfASmallFastStructureIsDrawnInItsOwnTimes) {
  const TemporaryFolder folder;
  write_file(folder.path() / "fast.toml",
             "units = \"SI\"\n[structure]\nkind = \"chain\"\nmasses = 3\nmass = 1e-9\nstiffness = 1e3\ndamping = 1e-9\n"
             "[[contact]]\nat = 3\nlaw = \"coulomb\"\nmu_s = 0.4\nmu_k = 0.2\nnormal_load = 1e-4\n"
             "[drive]\nkind = \"belt\"\nspeed = 0.01\n[ensemble]\nmembers = 2\nspread = 1e-8\n[validation]\n");
  const Outcome outcome = slipmode_in(folder, {"run", "fast.toml", "-o", "out", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NEAR(outcome.json()["chosen_times"]["period"], 1.412e-5, 1e-8);  // 2π/(2 ω sin(π/14)), ω² = k/m
  const slipmode::results::StoreReader trajectory(folder.path() / "out/trajectory.h5");
  const Eigen::VectorXd times = trajectory.vector("trajectory/time");
  EXPECT_NEAR(times[times.size() - 1] - times[0], 7e-5, 1e-8) << "five periods";
  EXPECT_EQ(times.size(), 1751) << "every 4e-8";
  const slipmode::results::StoreReader validation(folder.path() / "out/validation.h5");
  EXPECT_EQ(validation.vector("portraits/levels/00/displacement").size(), 5001);
}

// 85 % of the energy is in one mode; two contacts need two.
TEST(Run, TakesNoFewerModesByEnergyThanThereAreContacts) {
  const TemporaryFolder folder;
  write_file(folder.path() / "own.toml", kOwnMatrices);
  const Words asked = {"run", "own.toml", "-o", "out", "--json"};
  const Outcome by_energy = slipmode_in(folder, asked + Words{"--set", "reduction={energy=0.5}"});
  ASSERT_EQ(by_energy.exit_code, 0) << by_energy.err;
  EXPECT_EQ(by_energy.json()["pod"]["chosen_modes"], 2);
  const Outcome one = slipmode_in(folder, asked + Words{"--set", "reduction={modes=1}"});
  EXPECT_EQ(one.exit_code, 2);
  EXPECT_THAT(one.err, HasSubstr("2 or more by reduction.modes"));
}

TEST(Run, OpensItsReportOnlyWhereThereIsADisplay) {
  const TemporaryFolder folder;
  write_file(folder.path() / "two.toml", kTwoContacts);
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(name);
  const Outcome outcome = slipmode_in(folder, {"run", "two.toml", "-o", "out", "--open"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr("Not opened: no display here\n"
                                              "To look at it all, in a browser: out/report.html (made in "));
}

TEST(Run, OfManyMassesComparesFewReducedModels) {
  const TemporaryFolder folder;
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml";
  const Outcome outcome = slipmode_in(folder, {"run",
                                               chain,
                                               "-o",
                                               "out",
                                               "--json",
                                               "--set",
                                               "structure.masses=30",
                                               "--set",
                                               "contact.0.at=30",
                                               "--set",
                                               "validation.speeds={from=0.3, to=0.1, step=0.1}",
                                               "--set",
                                               "validation.orbits=[]",
                                               "--set",
                                               "time={duration=2000.0, transient=1000.0, sample=0.5}",
                                               "--set",
                                               "validation.lyapunov_duration=2000.0",
                                               "--set",
                                               "validation.limit=20000.0",
                                               "--set",
                                               "validation.cost_duration=0.0"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto shares = outcome.json()["validation"]["bases"]["POM"]["shares"];
  EXPECT_LE(shares.size(), 12U) << "of thirty";
  EXPECT_EQ(outcome.json()["validation"]["bases"]["LNM"]["shares"].size(), shares.size());
}

TEST(Run, KeepsAndMarksWhatWasFinishedBeforeANumericalFailure) {
  const TemporaryFolder folder;
  write_file(folder.path() / "free.toml", kFreeEnds);
  // The window is longer than the excerpt of 210 time units that is run first, and holds fewer events than the members'
  // 3000 units of stick-slip have (about one event per two units): so the ensemble fails, not the trajectory.
  const Outcome outcome = slipmode_in(
      folder, {"run", "free.toml", "-o", "out", "--json", "--set", "time.duration=3000.0", "--set",
               "time.transient=10.0", "--set", "flow.max_events_per_window=600", "--set", "flow.zeno_window=5000.0"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.json()["status"], "failed");
  EXPECT_THAT(outcome.err, HasSubstr("Zeno"));
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
  EXPECT_TRUE(fs::exists(folder.path() / "out.partial/trajectory.h5"));
  EXPECT_THAT(bytes_of(folder.path() / "out.partial/INCOMPLETE.txt"), HasSubstr("Zeno"));
}

TEST(Simulate, KeepsAndMarksThePartBeforeANumericalFailure) {
  const TemporaryFolder folder;
  write_file(folder.path() / "two.toml", kTwoContacts);
  const Outcome outcome =
      slipmode_in(folder, {"simulate", "two.toml", "-o", "run.h5", "--json", "--set", "flow.max_events_per_window=20",
                           "--set", "flow.zeno_window=1000.0", "--set", "time.transient=0.0"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.json()["incomplete"], true);
  // 20 events are let through, the next one is the failure.
  EXPECT_GT(outcome.json()["events"], 10);
  EXPECT_LE(outcome.json()["events"], 20);
  EXPECT_THAT(slipmode_in(folder, {"info", "run.h5"}).out, HasSubstr("the run stopped early"));
}

}  // namespace
