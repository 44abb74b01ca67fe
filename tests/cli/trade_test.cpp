// slipmode trade and slipmode advise, through the executable, on scenes of milliseconds.

#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/scene/scene.hpp>
#include "cli/slipmode_process.hpp"
#include "cli/small_scenes.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <string>
#include <vector>

namespace {

using namespace slipmode::tests;

class TradeVerbs : public testing::Test {
 protected:
  void SetUp() override {
    write_file(folder.path() / "free.toml", kFreeEnds);
    write_file(folder.path() / "two.toml", kTwoContacts);
  }
  [[nodiscard]] Outcome call(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--json", "--quiet"});
    return slipmode_in(folder, arguments);
  }
  /// Exit code 2, a message that holds the words, and no file left behind.
  void refused(const std::vector<std::string>& arguments, const std::string& words) const {
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "picked.toml"));
  }

  TemporaryFolder folder;
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

TEST_F(TradeVerbs, BadInputIsRefusedAndSaysWhatIsValid) {
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

TEST_F(TradeVerbs, AdviceNamesEveryEffectWithOneSentence) {
  const Outcome outcome = call({"advise", "free.toml", "-o", "advice.h5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = outcome.json();
  std::vector<std::string> names;
  for (const auto& effect : json["effects"]) {
    names.push_back(effect["effect"]);
    EXPECT_TRUE(effect["sentence"].get<std::string>().starts_with(names.back() + ": "));
  }
  const std::vector<std::string> expected = {
      "static friction peak", "Stribeck slope", "structural damping", "mode 1", "mode 2", "mode 3"};
  EXPECT_EQ(names, expected);
  // Without the falling slope the belt does not excite the masses: what moves them is needed.
  EXPECT_EQ(json["effects"][0]["verdict"], "needed");
  // The contact is in the middle of three masses: the antisymmetric mode 2 never moves, modes 1 and 3 do.
  EXPECT_EQ(json["effects"][3]["verdict"], "needed");
  EXPECT_EQ(json["effects"][4]["verdict"], "can be left out");
  EXPECT_EQ(json["effects"][5]["verdict"], "needed");
}

}  // namespace
