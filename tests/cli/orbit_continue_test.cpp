// slipmode orbit continue: what it says, stores and draws, what an interrupt leaves, and what it refuses.

#include <slipmode/results/store.hpp>
#include "cli/orbit_verbs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>

namespace {

using namespace slipmode;
using namespace slipmode::tests;
using testing::HasSubstr;

TEST_F(OrbitVerbs, ContinueByBalanceWithItsTrueError) {
  const std::string two = SLIPMODE_SOURCE_DIR "/datasets/stop_2mass/scene.toml";
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"continue", two, "--by", "balance", "--set", "drive.omega=0.8", "--over",
                               "drive.omega=0.8:0.65", "-o", "b.h5"});
    return more;
  };
  const auto said = json_of(with({"--harmonics", "9", "--certify", "--every", "20"}));
  EXPECT_EQ(said["harmonics"], 9);
  EXPECT_GT(said["certificate"]["behind"], 0);
  // Doublings by shooting, `orbit continue` without --by balance. What 9 harmonics miss:
  // docs/theory/harmonic-balance.md, section 5.
  std::vector<double> folds, doublings;
  for (const auto& point : said["branches"][0]["special"]) {
    if (point["kind"] == "fold") folds.push_back(point["parameter"]);
    if (point["kind"] == "period doubling") doublings.push_back(point["parameter"]);
  }
  EXPECT_FALSE(folds.empty());
  ASSERT_EQ(doublings.size(), 2U);
  EXPECT_NEAR(doublings[0], 0.755586159, 6e-4);
  EXPECT_NEAR(doublings[1], 0.738783025, 4e-3);
  for (const char* figure : {"response", "multipliers"}) {
    const std::string file = std::string(figure) + ".svg";
    EXPECT_EQ(slipmode_in(folder, {"plot", "b.h5", "--figure", figure, "-o", file}).exit_code, 0);
    EXPECT_TRUE(is_figure(folder.path() / file));
  }
  const results::StoreReader store(folder.path() / "b.h5");
  EXPECT_EQ(store.number("branches/0/harmonics"), 9.0);
  // At 0.8 the motion stays in the gap: order 1 alone, of the amplitude that the table has.
  const Eigen::VectorXd first = store.matrix("branches/0/coefficients").row(0);
  ASSERT_EQ(first.size(), 19);
  EXPECT_NEAR(std::hypot(first[1], first[10]), store.vector("branches/0/points/alternating_1")[0], 1e-12);

  const std::string play = SLIPMODE_SOURCE_DIR "/datasets/play_oscillator/scene.toml";
  const auto chosen = json_of({"continue", play, "--by", "balance", "--over", "drive.omega=1:1.05", "--harmonics",
                               "auto", "--error", "1e-3", "--every", "5", "-o", "auto.h5"});
  EXPECT_LE(chosen["certificate"]["worst"], 1e-3);
  EXPECT_EQ(chosen["trials"].back()["harmonics"], chosen["harmonics"]);

  const auto failed = json_of({"continue", kSdof, "--set", "drive.omega=0.4", "--over", "drive.omega=0.4:0.5", "--by",
                               "balance", "--harmonics", "5", "-o", "none.h5"},
                              3);
  EXPECT_THAT(failed["message"].get<std::string>(), HasSubstr("no balance of 5 harmonics"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none.h5"));
  const auto cut =
      json_of({"continue", play, "--by", "balance", "--over", "drive.omega=1:0.98", "--sequential", "-o", "cut.h5"}, 3);
  EXPECT_TRUE(cut["incomplete"]);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "cut.h5"));
  expect_refused(with({"--switch"}), {"--switch", "--by shooting"});
  expect_refused(with({"--samples", "128"}), {"--samples 128", "exact forces"});
  expect_refused(with({"--every", "3"}), {"--every 3", "--certify"});
  expect_refused(with({"--start", "1,0,0,0"}), {"--start 1,0,0,0", "contact", "gap"});
  expect_refused({"continue", play, "--over", "drive.omega=1:1.05", "--every", "3", "-o", "x.h5"},
                 {"--every", "--by balance"});
  expect_refused({"continue", SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml", "--by", "balance", "--over",
                  "drive.speed=0.4:0.5", "-o", "x.h5"},
                 {"needs a drive with a period", "shooting"});
}

TEST_F(OrbitVerbs, ContinueFollowsTheResponseCurve) {
  const auto said =
      json_of({"continue", kSdof, "--over", "drive.omega=1.8:0.65", "--start", "2.5,0", "--switch", "-o", "branch.h5"});
  ASSERT_EQ(said["branches"].size(), 2U);
  const auto& main = said["branches"][0];
  EXPECT_TRUE(main["complete"]);
  std::vector<double> folds, breakings;
  for (const auto& point : main["special"]) {
    if (point["kind"] == "fold") folds.push_back(point["parameter"]);
    if (point["kind"] == "symmetry breaking") breakings.push_back(point["parameter"]);
  }
  // S0, text to Figures 4.1 and 4.2: folds near 1 and 1.42, symmetry breaking near 0.7; half a unit of their digits
  ASSERT_EQ(folds.size(), 2U);
  EXPECT_NEAR(*std::min_element(folds.begin(), folds.end()), 1.0, 0.05);
  EXPECT_NEAR(*std::max_element(folds.begin(), folds.end()), 1.42, 0.005);
  ASSERT_EQ(breakings.size(), 1U);
  EXPECT_NEAR(breakings[0], 0.7, 0.05);
  for (const char* figure : {"response", "multipliers"}) {
    const std::string file = std::string(figure) + ".png";
    EXPECT_EQ(slipmode_in(folder, {"plot", "branch.h5", "--figure", figure, "-o", file}).exit_code, 0);
    EXPECT_TRUE(is_figure(folder.path() / file));
  }
}

TEST_F(OrbitVerbs, ContinueMeetsTheGrazingOfTheLinearMotion) {
  const std::string play = SLIPMODE_SOURCE_DIR "/datasets/play_oscillator/scene.toml";
  const auto said = json_of({"continue", play, "--over", "drive.amplitude=1.2:0.9", "-o", "branch.h5"});
  // In the gap |x| = a / (w sqrt(w² + 4ξ²)): it reaches 1 at a = sqrt(1 + 0.04²), with w = 1, ξ = 0.02.
  const auto& special = said["branches"][0]["special"];
  ASSERT_EQ(special.size(), 1U);
  EXPECT_EQ(special[0]["kind"], "grazing");
  EXPECT_NEAR(special[0]["parameter"], std::sqrt(1.0 + 0.04 * 0.04), 1e-8);
}

TEST_F(OrbitVerbs, ContinueFromTheFarEndOfARangeGoesBackThroughIt) {
  const auto said = json_of({"continue", kSdof, "--set", "drive.omega=1.3", "--over", "drive.omega=1.2:1.3", "--start",
                             "2.5,0", "-o", "branch.h5"});
  EXPECT_EQ(said["branches"][0]["first"], 1.3);
  EXPECT_EQ(said["branches"][0]["last"], 1.2);
}

TEST_F(OrbitVerbs, SpecialPointsAreFollowedOverASecondKey) {
  const std::string play = SLIPMODE_SOURCE_DIR "/datasets/play_oscillator/scene.toml";
  const auto with = [&](const std::string& point, const std::string& along, const std::string& over,
                        std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"continue", play, "--over", over, "--along", along, "--point", point, "-o", "c.h5"});
    return more;
  };
  const auto said = json_of(with("grazing", "drive.amplitude=0.5:2", "drive.omega=0.6:1.5"));
  EXPECT_EQ(said["along"]["start"], 1.2);
  ASSERT_EQ(said["curves"].size(), 1U);
  const auto& curve = said["curves"][0];
  EXPECT_TRUE(curve["complete"]);
  const results::StoreReader store(folder.path() / "c.h5");
  EXPECT_EQ(store.text("curves/over"), "drive.omega");
  EXPECT_EQ(store.text("curves/along"), "drive.amplitude");
  const Eigen::VectorXd omega = store.vector("curves/0/points/over"), a = store.vector("curves/0/points/along");
  ASSERT_EQ(static_cast<std::size_t>(omega.size()), curve["points"].get<std::size_t>());
  // In the gap |x| = a / (w sqrt(w² + 4ξ²)) with ξ = 0.02; half its range is the gap.
  for (Eigen::Index k = 0; k < omega.size(); ++k) EXPECT_NEAR(a[k], omega[k] * std::hypot(omega[k], 0.04), 1e-8);
  EXPECT_LT((store.vector("curves/0/points/alternating_1").array() - 1.0).abs().maxCoeff(), 1e-8);
  EXPECT_EQ(slipmode_in(folder, {"plot", "c.h5", "-o", "curves.png"}).exit_code, 0);
  EXPECT_TRUE(is_figure(folder.path() / "curves.png"));
  // Both folds of a branch on one curve, with its cusp.
  const auto folds =
      json_of(with("fold", "drive.amplitude=0.5:2", "drive.omega=0.9:1.3", {"--set", "drive.amplitude=1.1"}));
  ASSERT_EQ(folds["curves"].size(), 1U);
  EXPECT_EQ(folds["curves"][0]["special"][0]["kind"], "cusp");
  EXPECT_EQ(folds["by"], "shooting");
  // By balance nearly the same cusp: 9 harmonics are 3e-6 from the exact one (docs/theory/harmonic-balance.md).
  const auto balanced = json_of(with("fold", "drive.amplitude=0.5:2", "drive.omega=0.9:1.3",
                                     {"--set", "drive.amplitude=1.1", "--by", "balance", "--harmonics", "9"}));
  ASSERT_EQ(balanced["curves"].size(), 1U);
  EXPECT_EQ(balanced["by"], "balance");
  EXPECT_EQ(results::StoreReader(folder.path() / "c.h5").number("curves/0/harmonics"), 9.0);
  for (const char* key : {"over", "along"})
    EXPECT_NEAR(balanced["curves"][0]["special"][0][key].get<double>(),
                folds["curves"][0]["special"][0][key].get<double>(), 1e-5);
  const auto one = json_of(with("fold:0.96", "drive.amplitude=1:1.2", "drive.omega=0.9:1.3"));
  EXPECT_EQ(one["curves"].size(), 1U);

  std::filesystem::remove(folder.path() / "c.h5");
  const auto none = json_of(with("period-doubling", "drive.amplitude=0.5:2", "drive.omega=0.9:1.3"), 3);
  EXPECT_THAT(none["message"].get<std::string>(),
              AllOf(HasSubstr("no period doubling of drive.omega between 0.9 and 1.3"), HasSubstr("grazing at 1.095")));
  expect_refused(with("hopf", "drive.amplitude=0.5:2", "drive.omega=0.6:1.5"), {"--point hopf", "neimark-sacker"});
  expect_refused(with("fold:x", "drive.amplitude=0.5:2", "drive.omega=0.6:1.5"), {"--point fold:x", "'x'"});
  expect_refused(with("fold", "drive.omega=0.5:2", "drive.omega=0.6:1.5"), {"--along drive.omega", "--over"});
  expect_refused(with("fold", "drive.amplitud=0.5:2", "drive.omega=0.6:1.5"), {"drive.amplitud", "no such key"});
  expect_refused(with("fold", "drive.amplitude=0.5", "drive.omega=0.6:1.5"), {"--along", "no range FROM:TO"});
  expect_refused(with("fold", "contact.0.stop.gap=-1:x", "drive.omega=0.6:1.5"), {"--along", "'x'"});
  expect_refused(with("fold", "drive.amplitude=0.5:2", "drive.omega=0.6:1.5", {"--by", "balance", "--certify"}),
                 {"--certify", "by shooting"});
  expect_refused({"continue", play, "--over", "drive.omega=0.6:1.5", "--point", "fold", "-o", "c.h5"},
                 {"--point needs --along"});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "c.h5"));
}

TEST_F(OrbitVerbs, SequentialContinuationEndsAtAFoldAndKeepsWhatItFound) {
  const auto said = json_of(
      {"continue", kSdof, "--over", "drive.omega=1.2:1.8", "--start", "2.5,0", "--sequential", "-o", "branch.h5"}, 3);
  EXPECT_TRUE(said["incomplete"]);
  EXPECT_EQ(said["branches"][0]["end"], "lost");
  const results::StoreReader store(folder.path() / "branch.h5");
  const Eigen::VectorXd parameter = store.vector("branches/0/points/parameter");
  EXPECT_NEAR(parameter.maxCoeff(), 1.4208, 2e-3);  // the fold that arclength finds
}

TEST_F(OrbitVerbs, AnInterruptedContinuationKeepsWhatItFound) {
  // A branch, a certificate and a curve, each stopped later until something was found, long before it is all.
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/jenkins_chain/scene.toml";
  const std::vector<std::vector<std::string>> each = {
      {"continue", kSdof, "--over", "drive.omega=1.8:0.65", "--start", "2.5,0", "--max-step", "2e-6", "--points",
       "1000000"},
      {"continue", chain, "--over", "drive.omega=0.1:1", "--by", "balance", "--harmonics", "25", "--certify",
       "--max-step", "1e-5", "--points", "1000000"},
      {"continue", kSdof, "--over", "drive.omega=1.3:3", "--start", "2.5,0", "--point", "fold", "--along",
       "drive.amplitude=0.02:20", "--max-step", "3e-4", "--points", "1000000"}};
  for (std::vector<std::string> arguments : each) {
    arguments.insert(arguments.begin(), "orbit");
    arguments.insert(arguments.end(), {"-o", "stopped.h5", "--json"});
    Outcome stopped;
    for (double seconds = 0.5; seconds < 100.0 && !std::filesystem::exists(folder.path() / "stopped.h5");
         seconds *= 2.0) {
      SlipmodeProcess process(arguments, folder.path());
      const auto begin = std::chrono::steady_clock::now();
      const auto late = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > seconds;
      };
      ASSERT_TRUE(process.signal_when(late, SIGINT)) << "over before it was stopped";
      stopped = process.wait();
      ASSERT_EQ(stopped.exit_code, 130) << stopped.err;
    }
    const auto said = stopped.json();
    EXPECT_TRUE(said["incomplete"]);
    const bool curve = said.contains("curves");
    const auto& found = said[curve ? "curves" : "branches"][0];
    EXPECT_EQ(found["end"], "interrupted");
    EXPECT_FALSE(found["complete"]);
    const results::StoreReader store(folder.path() / "stopped.h5");
    EXPECT_EQ(store.vector(curve ? "curves/0/points/over" : "branches/0/points/parameter").size(), found["points"]);
    EXPECT_EQ(slipmode_in(folder, {"plot", "stopped.h5", "-o", "stopped.svg"}).exit_code, 0);
    std::filesystem::remove(folder.path() / "stopped.h5");
  }
}

TEST_F(OrbitVerbs, ContinueRefusesWhatIsNotContinuous) {
  const auto over = [&](const std::string& range, const std::vector<std::string>& said) {
    expect_refused({"continue", kSdof, "--over", range, "-o", "b.h5"}, said);
  };
  over("contact.0.loss=0:1", {"contact.0.loss", "not a number"});
  over("time.samples_per_cycle=1:3", {"time.samples_per_cycle", "counts something"});
  over("time.cycles=300:500", {"time.cycles", "not part of the model"});
  over("drive.omega=1.2", {"drive.omega=1.2", "no range FROM:TO"});
  over("drive.omega=1.2:1.2", {"no length"});
  over("drive.omega=1.2:-1", {"drive.omega = -1", "a number > 0"});
  over("drive.omeag=1.2:1", {"drive.omeag", "no such key"});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "b.h5"));
}

}  // namespace
