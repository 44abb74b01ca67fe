#include "cli/folder_tests.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace {

using namespace slipmode::tests;
using testing::HasSubstr;

class Verbs : public OnSmallScenes {
 protected:
  Outcome call(const std::vector<std::string>& arguments) const { return slipmode_in(folder, arguments); }
  /// The call must end well; its JSON.
  nlohmann::json json_of(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json();
  }
};

TEST_F(Verbs, EachHasHelpWithAnExample) {
  for (const std::string verb : {"run", "modes", "simulate", "pod", "reduce", "validate", "sweep", "plot", "info"}) {
    const Outcome outcome = call({verb, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << verb;
    EXPECT_THAT(outcome.out, HasSubstr("Example:\n  slipmode " + verb)) << verb;
    for (const char* option : {"--json", "--threads", "--seed", "--quiet"}) {
      EXPECT_THAT(outcome.out, HasSubstr(option)) << verb;
    }
    const bool has_scene = verb != "plot" && verb != "info";
    EXPECT_EQ(outcome.out.find("--set") != std::string::npos, has_scene) << verb;
  }
}

TEST_F(Verbs, ModesAreThoseOfAChainBetweenWalls) {
  const auto found = json_of({"modes", "two.toml"});
  // Uniform chain of n masses between walls: ω_k = 2 sqrt(k/m) sin(kπ / (2(n + 1))). With masses 2 and 4 stuck, masses
  // 1 and 3 each swing alone between two fixed points: ω = sqrt(2k/m), twice.
  for (int k = 1; k <= 4; ++k) {
    EXPECT_NEAR(found["slipping"]["omega"][k - 1], 2.0 * 5.0 * std::sin(k * std::numbers::pi / 10.0), 1e-12);
  }
  ASSERT_EQ(found["sticking"]["omega"].size(), 2U);
  for (const double omega : found["sticking"]["omega"]) EXPECT_NEAR(omega, std::sqrt(50.0), 1e-12);
}

TEST_F(Verbs, SetOverridesAnyKey) {
  // One more of everything: 9 masses; ω_1 = 2 sqrt(k/m) sin(π / 20) with k/m = 200/2.
  const auto found =
      json_of({"modes", "two.toml", "--set", "structure.masses=9", "--set", "structure.stiffness=200.0"});
  EXPECT_NEAR(found["slipping"]["omega"][0], 20.0 * std::sin(std::numbers::pi / 20.0), 1e-12);
}

TEST_F(Verbs, QuietSaysNothing) {
  const Outcome outcome = call({"simulate", "two.toml", "-o", "run.h5", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Verbs, ATrajectoryClosesItsEnergyBalance) {
  const auto found = json_of({"simulate", "two.toml", "-o", "run.h5"});
  EXPECT_EQ(found["kind"], "trajectory");
  // (duration − transient) / sample + 1
  EXPECT_EQ(found["samples"], 601);
  EXPECT_GT(found["events"], 10);
  EXPECT_LT(std::abs(found["audit_residual"].get<double>()), 1e-9);
  for (const double share : found["stick_fraction"]) {
    EXPECT_GE(share, 0.0);
    EXPECT_LE(share, 1.0);
  }
}

TEST_F(Verbs, ARunSaysHowManyOfItsStepsAreCertified) {
  const std::vector<std::string> words = {"simulate", "two.toml", "-o", "run.h5", "--set", "flow.method=collocation"};
  const auto found = json_of(words);
  EXPECT_GT(found["steps"], 100);
  EXPECT_EQ(found["certified"], found["steps"]);
  std::vector<std::string> without = words;
  without.insert(without.end(), {"--set", "flow.certify=false"});
  EXPECT_EQ(json_of(without)["certified"], 0);
  EXPECT_NE(call({"simulate", "two.toml", "-o", "run.h5"}).out.find("certified"), std::string::npos);
}

TEST_F(Verbs, TheChainOfVerbsEndsInAValidation) {
  const auto ensemble = json_of({"simulate", "free.toml", "-o", "ensemble.h5"});
  EXPECT_EQ(ensemble["members"], 3);
  EXPECT_EQ(ensemble["snapshots"], 3 * 401);  // (300 − 100) / 0.5 + 1 each

  const auto pod = json_of({"pod", "ensemble.h5", "-o", "pod.h5"});
  double sum = 0.0;
  for (const double share : pod["shares"]) sum += share;
  EXPECT_NEAR(sum, 1.0, 1e-14);

  // All modes kept: a change of coordinates, so the frequencies are the same to rounding.
  const auto reduced = json_of({"reduce", "free.toml", "pod.h5", "--modes", "3", "-o", "rom.h5"});
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(reduced["omega_reduced"][k], reduced["omega_full"][k].get<double>(), 1e-12);
  }

  const auto validation = json_of({"validate", "free.toml", "pod.h5", "-o", "validation.h5"})["validation"];
  for (const char* basis : {"POM", "LNM"}) {
    const auto& shares = validation["bases"][basis]["shares"];
    ASSERT_EQ(shares.size(), 3U);
    EXPECT_NEAR(shares[2]["energy"], 100.0, 1e-9);
    EXPECT_LT(shares[2]["horizon"]["dX"].get<double>(), 1e-5) << "all modes kept: full and reduced are the same";
    EXPECT_GT(shares[0]["horizon"]["dX"].get<double>(), 1e-3) << "one mode of three cannot be exact";
  }
  // No basis of one vector holds more of the ensemble's energy than the first POM.
  EXPECT_GE(validation["bases"]["POM"]["shares"][0]["energy"], validation["bases"]["LNM"]["shares"][0]["energy"]);
  EXPECT_EQ(validation["bifurcation"]["values"], 5);
}

TEST_F(Verbs, SayWhereAllRunsOfAnEnsembleAreOne) {
  const std::string said = "All 3 runs of the ensemble start alike, as ensemble.spread = 0";
  const Words three = {"simulate", "two.toml", "-o", "e.h5", "--set", "ensemble.members=3"};
  EXPECT_THAT(call(three + Words{"--set", "ensemble.spread=0.0"}).out, HasSubstr(said));
  EXPECT_THAT(call(three + Words{"--set", "ensemble.spread=0.1"}).out, testing::Not(HasSubstr(said)));
}

TEST_F(Verbs, InfoListsWhatAFileHolds) {
  json_of({"modes", "two.toml", "-o", "modes.h5"});
  ASSERT_EQ(call({"plot", "modes.h5", "-o", "modes.svg"}).exit_code, 0);
  EXPECT_THAT(bytes_of(folder.path() / "modes.svg"), HasSubstr("sticking"));
  const Outcome text = call({"info", "modes.h5"});
  EXPECT_THAT(text.out, HasSubstr("[rad/s]"));
  const auto found = json_of({"info", "modes.h5"});
  bool shapes = false;
  for (const auto& entry : found["contents"]) {
    if (entry["name"] == "modes/slipping/shapes") shapes = entry["shape"] == nlohmann::json({4, 4});
  }
  EXPECT_TRUE(shapes);
}

TEST_F(Verbs, PlotDrawsEveryFigureAFileCanGive) {
  json_of({"simulate", "two.toml", "-o", "run.h5"});
  json_of({"simulate", "free.toml", "-o", "ensemble.h5"});
  json_of({"pod", "ensemble.h5", "-o", "pod.h5"});
  json_of({"validate", "free.toml", "pod.h5", "-o", "validation.h5"});
  for (const std::string file : {"run.h5", "pod.h5", "validation.h5"}) {
    auto names = json_of({"plot", file, "-o", "first.svg"})["others"];
    EXPECT_TRUE(is_figure(folder.path() / "first.svg")) << file;
    EXPECT_FALSE(names.empty()) << file;
    for (const std::string name : names) {
      json_of({"plot", file, "--figure", name, "-o", name + ".png"});
      EXPECT_TRUE(is_figure(folder.path() / (name + ".png"))) << file << ' ' << name;
    }
  }
}

TEST_F(Verbs, PlotDrawsAContactThatNeverSlips) {
  // μ_s N of 500 against springs of 50 that are stretched by less than 4 in 40 units of time at speed 0.1.
  json_of({"simulate", "two.toml", "-o", "stuck.h5", "--set", "contact.0.normal_load=1000.0", "--set",
           "contact.1.normal_load=1000.0", "--set", "initial.displacement=[0.0,0.0,0.0,0.0]", "--set",
           "initial.velocity=[0.1,0.1,0.1,0.1]"});
  for (const char* figure : {"history", "portrait"}) {
    json_of({"plot", "stuck.h5", "--figure", figure, "-o", "stuck.png"});
    EXPECT_TRUE(is_figure(folder.path() / "stuck.png")) << figure;
  }
}

TEST_F(Verbs, TheSeedDecidesTheEnsembleAndThreadsDoNot) {
  json_of({"simulate", "free.toml", "-o", "a.h5", "--threads", "1"});
  json_of({"simulate", "free.toml", "-o", "b.h5", "--threads", "2"});
  json_of({"simulate", "free.toml", "-o", "c.h5", "--seed", "8"});
  EXPECT_EQ(bytes("a.h5"), bytes("b.h5"));
  EXPECT_NE(bytes("a.h5"), bytes("c.h5"));
}

}  // namespace
