// Verbs on a small beam under a shaker, through the executable.
#include <slipmode/results/table.hpp>
#include "cli/folder_tests.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <csignal>
#include <string>
#include <vector>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using slipmode::results::StoreReader;
using testing::HasSubstr;

/// datasets/beam_12hz with few elements and cycles.
std::vector<std::string> small(std::vector<std::string> arguments, const std::vector<std::string>& more = {}) {
  for (const char* value : {"structure.elements=6", "time={cycles=40.0, transient_cycles=20.0, samples_per_cycle=16}",
                            "ensemble.members=2", "validation.cycles=40.0", "validation.kept=25.0",
                            "validation.modes=[1, 2, 12]", "validation.cost_cycles=5.0", "validation.cost_repeats=1"}) {
    arguments.insert(arguments.end(), {"--set", value});
  }
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class Shaken : public InFolder {
 protected:
  Outcome run(const std::vector<std::string>& arguments, const std::vector<std::string>& more = {}) const {
    return slipmode_in(folder, small(arguments, more));
  }
  /// A run that must go well, as JSON.
  nlohmann::json json(std::vector<std::string> arguments, const std::vector<std::string>& more = {}) const {
    arguments.push_back("--json");
    const Outcome outcome = run(arguments, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json();
  }
  fs::path path(const std::string& name) const { return folder.path() / name; }
};

TEST_F(Shaken, AnEnsembleGivesModalFunctionsAndThoseAReducedModel) {
  const auto ensemble = json({"simulate", kShakenBeam, "-o", "ensemble.h5"});
  EXPECT_EQ(ensemble["members"], 2);
  const StoreReader store(path("ensemble.h5"));
  const Eigen::MatrixXd readings = store.columns("sensors/readings");
  EXPECT_EQ(readings.rows(), 6);
  EXPECT_EQ(readings.cols(), ensemble["snapshots"].get<Eigen::Index>());

  const auto pod = slipmode_in(folder, {"pod", "ensemble.h5", "-o", "pod.h5", "--json"}).json();
  ASSERT_EQ(pod["pomf"]["lnm_shares"].size(), 6U);
  for (const auto& row : pod["pomf"]["lnm_shares"]) {  // fitted by six natural modes: nothing lies outside them
    double sum = 0.0;
    for (const auto& share : row) sum += share.get<double>();
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
  const auto reduced = json({"reduce", kShakenBeam, "pod.h5", "--modes", "3", "-o", "rom.h5"});
  EXPECT_EQ(reduced["modes"], 3);
  EXPECT_EQ(json({"sweep", kShakenBeam, "--over", "drive.frequency=12:12.4:0.2", "--model", "rom:rom.h5", "-o",
                  "s.h5"})["values"],
            3);
  const auto validated = json({"validate", kShakenBeam, "rom.h5", "-o", "validation.h5"});
  EXPECT_EQ(validated["validation"]["bases"][0]["rows"][0]["modes"], 3);
}

TEST_F(Shaken, AllNaturalModesAreTheFullModel) {
  // At 30 Hz the tip is held: no chaos hides a difference.
  ASSERT_EQ(run({"simulate", kShakenBeam, "-o", "ensemble.h5"}).exit_code, 0);
  const auto found = json({"validate", kShakenBeam, "ensemble.h5", "-o", "validation.h5"},
                          {"--set", "drive.frequency=30.0", "--set", "validation.bases=[\"lnm\"]"});
  const auto& rows = found["validation"]["bases"][0]["rows"];
  EXPECT_GT(rows[0]["mean_distance"], 1e-2);
  EXPECT_EQ(rows[2]["modes"], 12);
  EXPECT_LT(rows[2]["mean_distance"], 1e-6);
  EXPECT_EQ(rows[2]["same_label"], 1.0);
}

TEST_F(Shaken, ASweepGivesTheSameBytesForAnyNumberOfThreadsAndAfterAKill) {
  const auto sweep = [&](const std::string& file, const std::string& threads) {
    return small(
        {"sweep", kShakenBeam, "--over", "drive.frequency=8:20:0.1", "-o", file, "--json", "--threads", threads});
  };
  ASSERT_EQ(slipmode_in(folder, sweep("one.h5", "1")).exit_code, 0);
  SlipmodeProcess process(sweep("two.h5", "2"), folder.path());
  ASSERT_TRUE(process.signal_when([this] { return journalled("two.h5") >= 5; }, SIGKILL));
  process.wait();
  ASSERT_FALSE(fs::exists(path("two.h5")));
  const int kept = journalled("two.h5");
  const Outcome resumed = slipmode_in(folder, sweep("two.h5", "2"));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resumed.json()["resumed"], kept);
  EXPECT_EQ(bytes_of(path("two.h5")), bytes_of(path("one.h5")));
  EXPECT_LT(resumed.json()["largest_audit_residual"], 1e-9);
  const slipmode::results::Table values = load_table(StoreReader(path("one.h5")), "sweep/full/values");
  EXPECT_EQ(values.rows(), 121U);
}

TEST_F(Shaken, SweepsUpAndDownStandInOneFile) {
  const auto found = json({"sweep", kShakenBeam, "--over", "drive.frequency=10:11:0.5", "--follow", "--both", "--model",
                           "lnm+static:3", "-o", "both.h5"});
  EXPECT_TRUE(found.contains("hysteresis"));
  const StoreReader store(path("both.h5"));
  EXPECT_EQ(load_table(store, "sweep/reduced/values").numbers("parameter").front(), 10.0);
  EXPECT_EQ(load_table(store, "sweep/reduced_reverse/values").numbers("parameter").front(), 11.0);
}

TEST_F(Shaken, AnInterruptedSweepUpAndDownCountsBothPasses) {
  const auto sweep = small({"sweep", kShakenBeam, "--over", "drive.frequency=8:12:0.1", "--follow", "--both", "-o",
                            "both.h5", "--json", "--threads", "1"});
  SlipmodeProcess process(sweep, folder.path());
  ASSERT_TRUE(process.signal_when([this] { return journalled("both.h5") >= 45; }, SIGINT)) << process.wait().err;
  const Outcome stopped = process.wait();
  ASSERT_EQ(stopped.exit_code, 130);
  EXPECT_GE(stopped.json()["finished"], 45);
  EXPECT_EQ(stopped.json()["values"], 82);
}

TEST_F(Shaken, AnyKeyOfTheSceneCanBeSwept) {
  for (const std::string over :
       {"drive.amplitude=0.001:0.003:0.001", "contact.0.mu_s=0.55:0.85:0.15", "contact.0.stiffness=10000:30000:10000",
        "contact.0.normal_load.constant=0.2:0.4:0.1"}) {
    const auto found = json({"sweep", kShakenBeam, "--over", over, "--model", "lnm:2", "-o", "s.h5"});
    EXPECT_EQ(found["values"], 3) << over;
    EXPECT_EQ(found["failures"].size(), 0U) << over;
  }
}

TEST_F(Shaken, ThePipelineLeavesSummaryValidationAndFigures) {
  const auto summary =
      json({"run", kShakenBeam, "-o", "out"}, {"--set", "validation.frequencies={from=10.0, to=12.0, step=1.0}"});
  ASSERT_EQ(summary["validation"]["bases"].size(), 4U);
  for (const auto& basis : summary["validation"]["bases"]) {
    for (const auto& row : basis["rows"]) EXPECT_FALSE(row.contains("failure")) << basis["basis"] << row;
  }
  for (const std::string name :
       {"summary.json", "summary.txt", "trajectory.h5", "ensemble.h5", "pod.h5", "reduced.h5", "validation.h5",
        "agreement.png", "sweep_pomf.svg", "sweep_lnm.png", "pomfs.svg", "loops.png", "delay.png", "spectrum.svg"}) {
    EXPECT_TRUE(fs::exists(path("out/" + name))) << name;
  }
}

// Eight cycles of 16 samples are a scribble; what is drawn is the motion itself, corners at events included.
TEST_F(Shaken, LoopsAreDrawnFinerThanTheRecordIsSampled) {
  json({"simulate", kShakenBeam, "--single", "-o", "run.h5"});
  ASSERT_EQ(slipmode_in(folder, {"plot", "run.h5", "--figure", "loops", "-o", "loops.svg"}).exit_code, 0);
  const std::string drawn = bytes_of(path("loops.svg"));
  std::size_t longest = 0;  // points of a curve: "x,y" pairs in a path
  for (std::size_t begin = drawn.find("<path"); begin != std::string::npos; begin = drawn.find("<path", begin + 1)) {
    const auto end = drawn.find('>', begin);
    longest =
        std::max(longest, static_cast<std::size_t>(std::count(drawn.begin() + static_cast<std::ptrdiff_t>(begin),
                                                              drawn.begin() + static_cast<std::ptrdiff_t>(end), ',')));
  }
  EXPECT_GT(longest, 8U * 512U);
}

TEST_F(Shaken, MistakesAreToldWithTheirRemedy) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& words) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  const std::vector<std::string> sweep = {"sweep", kShakenBeam, "--over", "drive.frequency=10:11:0.5", "-o", "s.h5"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = sweep;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  refused(with({"--both"}), "add --follow");
  refused(with({"--model", "pomf"}), "BASIS:L");
  refused(with({"--model", "wavelets:3"}), "lnm+static");
  refused(with({"--model", "lnm:99"}), "valid: 1 to 12");
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml";
  const Outcome belt =
      slipmode_in(folder, {"sweep", chain, "--over", "drive.speed=0.3:0.2:0.1", "--reverse", "-o", "s.h5"});
  EXPECT_EQ(belt.exit_code, 2);
  EXPECT_THAT(belt.err, HasSubstr("shaker"));
}

}  // namespace
