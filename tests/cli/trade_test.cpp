// slipmode trade and slipmode advise, through the executable, on scenes of milliseconds.

#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/scene/scene.hpp>
#include "cli/folder_tests.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace slipmode::tests;

class TradeVerbs : public QuietStudies {
 protected:
  /// As elsewhere, and no file is left behind.
  void refused(const Words& arguments, const std::string& words) const {
    QuietStudies::refused(arguments, words);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "picked.toml"));
  }
};

TEST_F(TradeVerbs, TableFileFiguresAndSceneSayTheSame) {
  const Outcome outcome = call({"trade", "free.toml", "-o", "trade.h5", "--figures", "fronts", "--axes", "modes,flow",
                                "--error", "5%", "--write", "picked.toml"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = outcome.json();
  const slipmode::results::StoreReader store(folder.path() / "trade.h5");
  const slipmode::results::Table table = slipmode::results::load_table(store, "trade/candidates");
  const auto& candidates = json["trade"]["candidates"];
  ASSERT_EQ(table.rows(), candidates.size() + 1) << "the reference is the first row";
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    EXPECT_EQ(table.texts("name")[i + 1], candidates[i]["name"]);
    EXPECT_EQ(table.numbers("dE")[i + 1], candidates[i]["error_percent"]["dE"].get<double>());
    EXPECT_EQ(table.numbers("time")[i + 1], candidates[i]["time_s"].get<double>());
  }
  EXPECT_EQ(json["recommendations"].size(), 6U) << "one sentence per measure";
  EXPECT_TRUE(is_figure(folder.path() / "fronts/pareto_dE.svg"));
  EXPECT_TRUE(is_figure(folder.path() / "fronts/pareto_energy.png"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "trade.h5.journal"));

  // What was picked is within the limit, and the scene says it and runs.
  const std::string picked = json["choice"]["name"];
  const auto row = std::ranges::find_if(candidates, [&](const auto& one) { return one["name"] == picked; });
  ASSERT_NE(row, candidates.end());
  EXPECT_LE((*row)["error_percent"]["dE"].get<double>(), 5.0);
  EXPECT_NE(json["choice"]["sentence"].get<std::string>().find("for dE under 5 % use"), std::string::npos);
  const slipmode::scene::Scene written = slipmode::scene::load_scene(folder.path() / "picked.toml");
  if (picked.find("tolerance 1e-03") != std::string::npos) {
    EXPECT_EQ(written.flow.tolerance, 1e-3);
  }
  EXPECT_EQ(slipmode_in(folder, {"simulate", "picked.toml", "-o", "run.h5", "--quiet"}).exit_code, 0);
  EXPECT_EQ(slipmode_in(folder, {"plot", "trade.h5", "-o", "front.svg", "--quiet"}).exit_code, 0);
  EXPECT_TRUE(is_figure(folder.path() / "front.svg"));
}

TEST_F(TradeVerbs, WaysToThePeriodicOrbitBesideTheExactOne) {
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/jenkins_chain/scene.toml";
  const Outcome outcome = call({"trade", chain, "--axes", "harmonics,mixed", "--error", "0.2%", "-o", "trade.h5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = outcome.json();
  const auto& rows = json["orbits"]["rows"];
  const slipmode::results::Table table =
      slipmode::results::load_table(slipmode::results::StoreReader(folder.path() / "trade.h5"), "trade/orbits");
  ASSERT_EQ(table.rows(), rows.size() + 1) << "shooting is the first row";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(table.texts("name")[i + 1], rows[i]["name"]);
    EXPECT_EQ(table.numbers("time")[i + 1], rows[i]["time_s"].get<double>());
  }
  // An error is what the command that a row names says itself.
  const auto row = std::ranges::find_if(rows, [](const auto& one) { return one["name"] == "mixed, 9 harmonics"; });
  ASSERT_NE(row, rows.end());
  EXPECT_EQ((*row)["options"], "--by mixed --harmonics 9");
  const auto found = call({"orbit", "find", chain, "--by", "mixed", "--harmonics", "9", "--certify"}).json();
  const double certified = 100.0 * found["certificate"]["relative"].get<double>();
  EXPECT_NEAR((*row)["error_percent"].get<double>(), certified, 1e-3 * certified);
  EXPECT_EQ(json["orbits"]["regimes"], found["word"]);
  ASSERT_EQ(json["recommendations"].size(), 7U) << "one sentence per measure, and the orbit's";
  EXPECT_TRUE(json["recommendations"][6].get<std::string>().starts_with("for the periodic orbit under 0.2 % use --by"));
  EXPECT_FALSE(call({"trade", "free.toml", "--axes", "flow"}).json().contains("orbits"));
}

TEST_F(TradeVerbs, BadInputIsRefusedAndSaysWhatIsValid) {
  refused({"trade", "free.toml", "--axes", "mixed"}, "valid: modes, flow, law");
  refused({"trade", "free.toml", "--axes", "modes,colour"}, "valid: modes, flow, law");
  refused({"trade", "free.toml", "--measure", "dY"}, "valid: dX, dE, points, spread, energy, stick");
  refused({"trade", "free.toml", "--error", "much"}, "--error much: expected a share in percent");
  refused({"trade", "free.toml", "--budget", "-1s"}, "--budget -1s: expected a time");
  refused({"trade", "free.toml", "--set", "drive.speed={ from = 0.1, to = 0.2, begin = 0.0, end = 9.0 }"}, "one speed");
  refused({"trade", "two.toml", "--axes", "law", "--set", "validation.limit=100.0", "--set", "validation.block=100.0",
           "--set", "validation.transient=10.0", "--set", "validation.cost_duration=50.0", "--set",
           "validation.horizon=2.0", "--budget", "0.001ms", "--write", "picked.toml"},
          "the cheapest that exists: ");
}

TEST_F(TradeVerbs, AdviceSaysFirstWhatTheSceneRequiresAndWritesIt) {
  const Outcome outcome = call(
      {"advise", "free.toml", "--question", "statistics", "--error", "5%", "-o", "advice.h5", "--write", "lean.toml"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = outcome.json();
  const std::string sentence = json["sentence"];
  EXPECT_TRUE(sentence.starts_with("The motion is ")) << sentence;
  EXPECT_NE(sentence.find("\nFor the statistics within 5 % the scene requires "), std::string::npos) << sentence;
  const auto effect = [&](const std::string& name) {
    return *std::ranges::find_if(json["effects"], [&](const auto& one) { return one["effect"] == name; });
  };
  // Without the falling slope the belt does not excite the masses: what moves them is needed.
  EXPECT_EQ(effect("static friction peak")["verdict"], "needed");
  // The contact is in the middle of three masses: the antisymmetric mode 2 never moves, modes 1 and 3 do.
  EXPECT_EQ(effect("modes above 2")["statistics"]["verdict"], "needed");
  const double one = effect("modes above 1")["statistics"]["error_percent"];
  const double two = effect("modes above 2")["statistics"]["error_percent"];
  EXPECT_NEAR(one, two, 1e-6 * one);
  EXPECT_EQ(effect("tolerance below 1e-06")["motion"]["verdict"], "can be left out");
  EXPECT_EQ(json["lean"]["left_out"], std::vector<std::string>{"tolerance below 1e-03"});
  EXPECT_EQ(json["lean"]["verdict"], "can be left out");
  EXPECT_EQ(slipmode::scene::load_scene(folder.path() / "lean.toml").flow.tolerance, 1e-3);
  const Outcome text = slipmode_in(folder, {"advise", "free.toml", "--question", "statistics", "--error", "5%"});
  EXPECT_EQ(text.out.find("free ends\nThe motion is "), 0U) << text.out;
}

TEST_F(TradeVerbs, AdviceRefusesWhatItCannotAnswer) {
  refused({"advise", "free.toml", "--question", "colour"},
          "--question colour: no such question; valid: motion, statis");
  refused({"advise", "free.toml", "--question", "motion", "--measure", "energy"},
          "--measure energy: answers the question statistics, not motion");
  refused({"advise", "free.toml", "--error", "0"}, "--error 0: expected a share in percent");
  refused({"advise", "free.toml", "--error", "0.02"}, "--error 0.02: write 0.02% or 2%, whichever is meant");
}

TEST_F(TradeVerbs, WithoutAFileGoOnWhereTheyWereStopped) {
  setenv("XDG_CACHE_HOME", (folder.path() / "cache").c_str(), 1);
  const auto kept = [&] {
    std::uintmax_t bytes = 0;
    std::error_code none;
    for (const auto& file : std::filesystem::directory_iterator(folder.path() / "cache/slipmode", none))
      bytes += file.file_size();
    return bytes;
  };
  for (const char* verb : {"advise", "trade"}) {
    SCOPED_TRACE(verb);
    const std::vector<std::string> words = {
        verb,        "free.toml", "--set", "validation.limit=4e4", "--set", "validation.block=4e4",
        "--threads", "1",         "--json"};
    SlipmodeProcess process(words, folder.path());
    ASSERT_TRUE(process.signal_when([&] { return kept() > 500; }, SIGINT)) << "over before it was stopped";
    EXPECT_EQ(process.wait().exit_code, 130);
    EXPECT_GT(kept(), 500U);
    const Outcome repeated = slipmode_in(folder, words);
    ASSERT_EQ(repeated.exit_code, 0) << repeated.err;
    EXPECT_GT(repeated.json()["resumed"], 0);
    EXPECT_EQ(kept(), 0U) << "what is finished is not kept twice";
  }
  unsetenv("XDG_CACHE_HOME");
}

}  // namespace
