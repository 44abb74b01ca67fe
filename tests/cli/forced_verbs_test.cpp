// Verbs on a chain under a force, through the executable.
#include <slipmode/results/table.hpp>
#include "cli/slipmode_process.hpp"
#include "cli/small_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <fstream>
#include <string>
#include <vector>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using slipmode::results::StoreReader;

/// Five masses, the middle one behind a contact spring on dry ground, the last one pushed.
const std::string kForcedChain = R"(
title = "pushed"
units = "SI"
[structure]
kind = "chain"
masses = 5
mass = 2.0
stiffness = 50.0
damping = 1.0
ends = "fixed-free"
[[contact]]
at = 3
law = "compliant"
mu_s = 0.3
mu_k = 0.3
stiffness = 40.0
normal_load = 3.0
[drive]
kind = "force"
omega = 2.0
amplitude = 2.0
at = 5
[time]
cycles = 60
transient_cycles = 40
samples_per_cycle = 16
[ensemble]
omegas = [1.5, 3.0]
members = 2
spread = 0.01
[validation]
omegas = { from = 1.0, to = 4.0, step = 0.5 }
cycles = 150
kept = 60
modes = [1, 3, 5]
cost_cycles = 5
cost_repeats = 1
)";

class Forced : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(path("pushed.toml")) << kForcedChain; }
  /// A run that must go well, as JSON.
  nlohmann::json json(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = slipmode_in(folder, arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json();
  }
  fs::path path(const std::string& name) const { return folder.path() / name; }

  TemporaryFolder folder;
};

TEST_F(Forced, AnEnsembleOverFrequenciesIsTheRunsAtEachOneAfterTheOther) {
  EXPECT_EQ(json({"simulate", "pushed.toml", "-o", "both.h5"})["members"], 4);
  const Eigen::MatrixXd both = StoreReader(path("both.h5")).columns("ensemble/snapshots");
  Eigen::Index before = 0;
  for (const char* omega : {"1.5", "3.0"}) {
    json({"simulate", "pushed.toml", "--set", std::string("drive.omega=") + omega, "--set", "ensemble.omegas=[]", "-o",
          "one.h5"});
    const Eigen::MatrixXd one = StoreReader(path("one.h5")).columns("ensemble/snapshots");
    ASSERT_LE(before + one.cols(), both.cols());
    EXPECT_EQ(both.middleCols(before, one.cols()), one) << omega;  // a time in cycles is each one's own
    before += one.cols();
  }
  EXPECT_EQ(before, both.cols());
}

TEST_F(Forced, AllModesAreTheFullModelAndFewerAreFurtherFromIt) {
  json({"simulate", "pushed.toml", "-o", "ensemble.h5"});
  const auto found = json({"validate", "pushed.toml", "ensemble.h5", "-o", "validation.h5"});
  ASSERT_EQ(found["validation"]["bases"].size(), 3U);
  for (const auto& basis : found["validation"]["bases"]) {
    const auto& rows = basis["rows"];
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_GT(rows[0]["mean_distance"], 0.01) << basis["basis"];
    EXPECT_LT(rows[1]["mean_distance"], rows[0]["mean_distance"]) << basis["basis"];
    EXPECT_LT(rows[2]["mean_distance"], 1e-9) << basis["basis"];
    EXPECT_EQ(rows[2]["same_label"], 1.0);
    EXPECT_EQ(rows[2]["same_period"], 1.0);
    EXPECT_LE(basis["trusted_from"], 5);
  }
  const StoreReader store(path("validation.h5"));
  EXPECT_EQ(store.text("shaken_validation/full/key"), "drive.omega");
  EXPECT_EQ(store.entry("shaken_validation/agreement/band_from").meaning.units, "rad/s");
}

// Another method: shooting for the periodic orbit at that frequency.
TEST_F(Forced, ASweepPassesThroughTheOrbitsThatShootingFinds) {
  json({"sweep", "pushed.toml", "--over", "drive.omega=1.5:3.5:0.5", "-o", "sweep.h5"});
  const slipmode::results::Table sections = load_table(StoreReader(path("sweep.h5")), "sweep/full/sections");
  for (const double omega : {1.5, 2.5, 3.5}) {
    json({"orbit", "find", "pushed.toml", "--set", "drive.omega=" + std::to_string(omega), "-o", "orbit.h5"});
    const Eigen::VectorXd start = StoreReader(path("orbit.h5")).vector("orbit/start/q");
    int seen = 0;
    for (std::size_t i = 0; i < sections.rows(); ++i) {
      if (sections.numbers("parameter")[i] != omega) continue;
      EXPECT_NEAR(sections.numbers("reading")[i], start[2], 1e-9) << omega;
      ++seen;
    }
    EXPECT_EQ(seen, 60) << omega;
  }
}

TEST_F(Forced, AReducedModelIsSweptAndJudgedByItself) {
  json({"simulate", "pushed.toml", "-o", "ensemble.h5"});
  json({"pod", "ensemble.h5", "-o", "pod.h5"});
  json({"reduce", "pushed.toml", "pod.h5", "--modes", "3", "-o", "rom.h5"});
  const auto up = json({"sweep", "pushed.toml", "--over", "drive.omega=1:3:0.5", "--follow", "--both", "--model",
                        "rom:rom.h5", "-o", "s.h5"});
  EXPECT_EQ(up["values"], 5);
  EXPECT_EQ(up["hysteresis"], 0.0);  // where it slides a Jenkins element alone has one motion
  const auto rows = json({"validate", "pushed.toml", "rom.h5", "-o", "v.h5"})["validation"]["bases"][0]["rows"];
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0]["modes"], 3);
}

// Where nothing holds the structure a constant contact force has no static response.
TEST_F(Forced, AStructureThatFloatsIsComparedWithoutStaticModes) {
  const auto summary =
      json({"run", SLIPMODE_SOURCE_DIR "/datasets/backlash_4mass/scene.toml", "-o", "out", "--set", "ensemble={}",
            "--set", "validation={cycles=300.0, kept=50.0, modes=[4], cost_cycles=5.0, cost_repeats=1}"});
  ASSERT_EQ(summary["validation"]["bases"].size(), 2U);
  for (const auto& basis : summary["validation"]["bases"]) EXPECT_LT(basis["rows"][0]["mean_distance"], 1e-6);
}

TEST_F(Forced, ThePipelineValidatesAndDraws) {
  const auto summary = json({"run", "pushed.toml", "-o", "out"});
  EXPECT_EQ(summary["validation"]["bases"].size(), 3U);
  EXPECT_FALSE(summary.contains("left_out"));
  for (const std::string name : {"validation.h5", "reduced_pom.h5", "reduced_lnm_static.h5", "agreement.png",
                                 "sweep_POM.svg", "sweep_LNM_static.svg", "report.html"})
    EXPECT_TRUE(fs::exists(path("out/" + name))) << name;
}

}  // namespace
