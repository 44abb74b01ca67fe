// slipmode orbit find and continue: what they say, store and draw, and what they refuse.

#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/store.hpp>
#include "cli/slipmode_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <numbers>

namespace {

using namespace slipmode;
using namespace slipmode::tests;
using testing::HasSubstr;

const std::string kSdof = SLIPMODE_SOURCE_DIR "/datasets/backlash_sdof/scene.toml";

class OrbitVerbs : public testing::Test {
 protected:
  Outcome call(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "orbit");
    return slipmode_in(folder, arguments);
  }
  nlohmann::json json_of(std::vector<std::string> arguments, int exit_code = 0) const {
    arguments.emplace_back("--json");
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    return outcome.json();
  }
  /// The call must be refused as bad input, naming these.
  void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& said) const {
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    for (const std::string& part : said) EXPECT_THAT(outcome.err, HasSubstr(part));
  }

  TemporaryFolder folder;
};

TEST_F(OrbitVerbs, EachHasHelpWithAnExample) {
  for (const std::string verb : {"find", "continue", "map", "basins", "spectrum"}) {
    const Outcome outcome = call({verb, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << verb;
    EXPECT_THAT(outcome.out, HasSubstr("slipmode orbit " + verb)) << verb;
    for (const char* option : {"--json", "--set", "--threads", "--seed", "--quiet"}) {
      EXPECT_THAT(outcome.out, HasSubstr(option)) << verb;
    }
  }
}

TEST_F(OrbitVerbs, FindsTheOrbitsOfTheSource) {
  const auto unstable = json_of({"find", kSdof, "--start", "2.0,0.0"});
  // S0 Table 4.1, orbit B, to the digits printed
  EXPECT_NEAR(unstable["multipliers"][0][0], 1.4210, 5e-5);
  EXPECT_NEAR(unstable["multipliers"][1][0], 0.1482, 5e-5);
  EXPECT_EQ(unstable["stability"], "unstable");
  EXPECT_EQ(unstable["word"], "g l g r");
  EXPECT_TRUE(unstable["symmetric"]);
  EXPECT_LE(unstable["residual"], 1e-11);
  EXPECT_DOUBLE_EQ(unstable["period"], 2.0 * std::numbers::pi / 1.4);
  const auto gap = json_of({"find", kSdof});
  EXPECT_EQ(gap["family_dimension"], 1);
  EXPECT_THAT(gap["family_note"].get<std::string>(), HasSubstr("family"));
  // In the gap the motion is linear: amplitude A / (ω sqrt(ω² + c²)).
  EXPECT_NEAR(gap["amplitudes"][0]["alternating"], 1.0 / (1.4 * std::sqrt(1.4 * 1.4 + 0.05 * 0.05)), 1e-10);
}

TEST_F(OrbitVerbs, PeriodIsAMultipleOfTheDrives) {
  const auto third = json_of(
      {"find", kSdof, "--set", "drive.omega=0.47", "--period", std::to_string(6.0 * std::numbers::pi / 0.47)}, 2);
  EXPECT_THAT(third["message"].get<std::string>(), HasSubstr("no multiple"));  // six decimals are too few
  const auto found = json_of({"find", kSdof, "--set", "drive.omega=0.47", "--order", "3"});
  EXPECT_EQ(found["order"], 3);
  EXPECT_EQ(found["stability"], "stable");
  expect_refused({"find", kSdof, "--period", "5.0"}, {"--period 5", "no multiple of the drive's", "--order 1"});
  expect_refused({"find", kSdof, "--period", "8.97597901026", "--order", "3"}, {"--order 3", "order 2"});
}

TEST_F(OrbitVerbs, StoresTheOrbitAndOnePeriodOfIt) {
  const auto said = json_of({"find", kSdof, "--start", "2.5,0", "-o", "orbit.h5"});
  const results::StoreReader store(folder.path() / "orbit.h5");
  const orbits::PeriodicOrbit orbit = results::load_orbit(store);
  EXPECT_EQ(orbit.period, said["period"]);
  EXPECT_EQ(orbit.multipliers[0].real(), said["multipliers"][0][0]);
  EXPECT_EQ(orbit.crossings, 4);
  EXPECT_EQ(orbit.regimes.front().modes.size(), 1U);
  const Eigen::MatrixXd q = store.matrix("trajectory/q");  // time x dof
  EXPECT_NEAR(q(0, 0), q(q.rows() - 1, 0), 1e-9);
  for (const char* figure : {"orbit", "multipliers"}) {
    const std::string file = std::string(figure) + ".svg";
    EXPECT_EQ(slipmode_in(folder, {"plot", "orbit.h5", "--figure", figure, "-o", file}).exit_code, 0);
    EXPECT_TRUE(is_figure(folder.path() / file));
  }
}

TEST_F(OrbitVerbs, SpectrumOfAStoredOrbit) {
  const auto found = json_of({"find", kSdof, "--start", "2.5,0", "-o", "orbit.h5"});
  const auto said = json_of({"spectrum", "orbit.h5", "--harmonics", "9", "--dof", "1", "-o", "spectrum.h5"});
  EXPECT_DOUBLE_EQ(said["omega"], 1.4);
  const auto& displacement = said["quantities"][0];
  EXPECT_EQ(displacement["name"], "displacement_1");
  EXPECT_EQ(displacement["cosine"].size(), 10U);
  // The row of the only mass is the contact's displacement; ẍ = −cẋ + λ + sin ωt at order 1: cosines of it.
  EXPECT_EQ(said["quantities"][3]["name"], "q1");
  EXPECT_EQ(said["quantities"][3]["cosine"], displacement["cosine"]);
  const double force = said["quantities"][2]["cosine"][1], speed = said["quantities"][1]["cosine"][1];
  EXPECT_NEAR(-1.4 * 1.4 * displacement["cosine"][1].get<double>(), force - 0.05 * speed, 1e-10);
  const results::StoreReader store(folder.path() / "spectrum.h5");
  EXPECT_EQ(store.vector("spectrum/coefficients/force_1_cosine")(1), force);
  EXPECT_EQ(slipmode_in(folder, {"plot", "spectrum.h5", "-o", "spectrum.svg"}).exit_code, 0);
  EXPECT_TRUE(is_figure(folder.path() / "spectrum.svg"));
  expect_refused({"spectrum", "spectrum.h5"}, {"holds a spectrum", "expected an orbit", "slipmode orbit find"});
  expect_refused({"spectrum", "orbit.h5", "--dof", "2"}, {"--dof 2", "1 to 1"});
}

TEST_F(OrbitVerbs, BalanceWithItsTrueError) {
  const std::string play = SLIPMODE_SOURCE_DIR "/datasets/play_oscillator/scene.toml";
  const std::vector<std::string> find = {"find", play, "--by", "balance"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), find.begin(), find.end());
    return more;
  };
  const auto said =
      json_of(with({"--set", "drive.amplitude=1.0833", "--harmonics", "auto", "--error", "1e-4", "-o", "b.h5"}));
  EXPECT_TRUE(said["converged"]);
  EXPECT_LE(said["certificate"]["relative"], 1e-4);
  EXPECT_EQ(said["certificate"]["orbit"]["word"], "g l g r");
  EXPECT_EQ(said["trials"].back()["harmonics"], said["harmonics"]);
  // S2 Table 2, 7(a): e₁ = −1.1456, d₁ = 0.0486
  EXPECT_NEAR(said["contacts"][0]["displacement"]["cosine"][1], -1.1456, 1e-4);
  EXPECT_NEAR(said["contacts"][0]["displacement"]["sine"][1], 0.0486, 1e-4);
  for (const char* figure : {"portrait", "error"}) {
    const std::string file = std::string(figure) + ".svg";
    EXPECT_EQ(slipmode_in(folder, {"plot", "b.h5", "--figure", figure, "-o", file}).exit_code, 0);
    EXPECT_TRUE(is_figure(folder.path() / file));
  }
  // Backlash at 1.4, orbit C: S0's 0.6086; without jumps Hill's method tends to 1.409.
  const auto c = json_of({"find", kSdof, "--by", "balance", "--harmonics", "25", "--certify"});
  EXPECT_EQ(c["certificate"]["orbit"]["word"], "g l g r");
  EXPECT_NEAR(c["hill"]["multipliers"][0][0], 0.6086, 2e-4);
  EXPECT_NEAR(c["hill"]["without_jumps"][0][0], 1.409, 1e-3);
  const auto sampled = json_of(with({"--harmonics", "11", "--samples", "128"}));
  EXPECT_EQ(sampled["samples"], 128);
  EXPECT_FALSE(sampled.contains("certificate"));
  const auto failed = json_of({"find", kSdof, "--set", "drive.omega=0.4", "--by", "balance", "--harmonics", "5"}, 3);
  EXPECT_GT(failed["residual"], 0.0);
  EXPECT_THAT(failed["message"].get<std::string>(), HasSubstr("no balance of 5 harmonics"));
  expect_refused(with({"--harmonics", "0"}), {"--harmonics 0", "from 1 on"});
  expect_refused(with({"--harmonics", "9", "--samples", "18"}), {"samples: 18", "more than 18"});
  expect_refused(with({"--harmonics", "auto"}), {"--error", "a true error > 0"});
  expect_refused(with({"--harmonics", "9", "--error", "1e-3"}), {"--harmonics auto and --error", "together"});
  expect_refused({"find", play, "--harmonics", "9"}, {"--harmonics", "--by balance"});
  expect_refused(with({"--start", "1,0"}), {"--start 1,0", "contact", "gap"});
  expect_refused({"find", SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml", "--by", "balance"},
                 {"needs a drive with a period", "shooting"});
}

TEST_F(OrbitVerbs, MixedWithItsTrueError) {
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/jenkins_chain/scene.toml";
  const std::vector<std::string> find = {"find", chain, "--by", "mixed"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), find.begin(), find.end());
    return more;
  };
  const auto said = json_of(with({"--certify", "-o", "mixed.h5"}));
  EXPECT_TRUE(said["converged"]);
  EXPECT_EQ(said["harmonics"], 9);
  EXPECT_EQ(said["near"], nlohmann::json({"x5", "x10"}));
  EXPECT_LT(said["certificate"]["relative"], 1e-4);  // 2.2e-5; a balance of 9 harmonics has 1.1e-3
  EXPECT_EQ(said["certificate"]["orbit"]["word"], said["word"]);
  EXPECT_EQ(json_of({"spectrum", "mixed.h5"})["omega"], said["omega"]);  // what is kept is the exact orbit
  const auto wider = json_of(with({"--near", "1", "--certify"}));
  EXPECT_EQ(wider["near"].size(), 5U);
  EXPECT_LT(wider["certificate"]["relative"], 0.1 * said["certificate"]["relative"].get<double>());
  const auto chosen = json_of(with({"--harmonics", "auto", "--error", "1e-6", "-o", "chosen.h5"}));
  EXPECT_LE(chosen["certificate"]["relative"], 1e-6);
  EXPECT_EQ(chosen["trials"].back()["harmonics"], chosen["harmonics"]);
  EXPECT_EQ(chosen["trials"].back()["error"], chosen["certificate"]["relative"]);
  EXPECT_GT(chosen["trials"][chosen["trials"].size() - 2]["error"], 1e-6) << "no order too many";
  const auto kept = slipmode_in(folder, {"info", "chosen.h5", "--json"});
  EXPECT_THAT(kept.out, AllOf(HasSubstr("mixed/trials/error"), HasSubstr("mixed/relative"), HasSubstr("orbit/")));
  const auto missed = json_of({"find", SLIPMODE_SOURCE_DIR "/datasets/stop_2mass/scene.toml", "--by", "mixed",
                               "--harmonics", "auto", "--error", "1e-300"},
                              3);
  EXPECT_THAT(missed["message"].get<std::string>(), HasSubstr("not met up to 175 harmonics: the least is"));
  for (const auto& trial : missed["trials"]) EXPECT_LE(missed["certificate"]["relative"], trial["error"]);
  expect_refused(with({"--harmonics", "auto"}), {"--error", "a true error > 0"});
  expect_refused(with({"--error", "1e-3"}), {"--harmonics auto and --error", "together"});
  expect_refused(with({"--harmonics", "auto", "--error", "0"}), {"--error", "a number > 0"});
  expect_refused(with({"-o", "mixed.h5"}), {"-o mixed.h5", "--certify"});
  expect_refused(with({"--samples", "64"}), {"--samples", "--by balance"});
  expect_refused(with({"--harmonics", "0"}), {"--harmonics 0"});
  expect_refused(with({"--start", "gap"}), {"--start gap", "leave it out"});
  expect_refused({"find", chain, "--by", "balance", "--near", "1"}, {"--near 1", "--by mixed"});
  expect_refused({"find", SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml", "--by", "mixed"},
                 {"needs a force drive", "shooting"});
}

TEST_F(OrbitVerbs, BalanceOfFrictionBehindContactSprings) {
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/jenkins_chain/scene.toml";
  const auto said = json_of({"find", chain, "--by", "balance", "--harmonics", "auto", "--error", "1e-4", "-o", "b.h5"});
  EXPECT_TRUE(said["converged"]);
  EXPECT_LE(said["certificate"]["relative"], 1e-4);
  EXPECT_EQ(said["certificate"]["orbit"]["crossings"], said["switches"]);
  EXPECT_TRUE(said["hill"]["multipliers"].is_null());
  EXPECT_THAT(said["hill"]["message"].get<std::string>(), HasSubstr("--certify"));
  EXPECT_EQ(said["stuck"], 0);
  EXPECT_EQ(slipmode_in(folder, {"plot", "b.h5", "-o", "portrait.svg"}).exit_code, 0);
  // By the alternating scheme: 512 samples miss a turning point by 0.006 rad at most, the force by its square.
  const auto exact = json_of({"find", chain, "--by", "balance", "--harmonics", "9"});
  const auto sampled = json_of({"find", chain, "--by", "balance", "--harmonics", "9", "--samples", "512"});
  EXPECT_NEAR(sampled["contacts"][1]["displacement"]["cosine"][1].get<double>(),
              exact["contacts"][1]["displacement"]["cosine"][1].get<double>(), 1e-3);
  // At 0.65 neither contact reaches its limit, expected.toml.
  const auto held =
      slipmode_in(folder, {"orbit", "find", chain, "--set", "drive.omega=0.65", "--by", "balance", "--harmonics", "3"});
  EXPECT_THAT(held.out, HasSubstr("2 of 2 contacts never slide"));
  const auto beside = json_of({"find", chain, "--set", "contact.0.at=10", "--by", "balance", "--certify"});
  EXPECT_TRUE(beside["certificate"]["behind"]) << "both on the last mass";
  const auto branch = json_of({"continue", chain, "--by", "balance", "--harmonics", "5", "--over",
                               "drive.omega=0.3:0.7", "--certify", "--every", "50", "-o", "c.h5"});
  EXPECT_EQ(branch["branches"][0]["end"], "range");
  EXPECT_EQ(branch["certificate"]["behind"], branch["certificate"]["certified"]);
  EXPECT_EQ(slipmode_in(folder, {"plot", "c.h5", "-o", "response.svg"}).exit_code, 0);
  EXPECT_NE(slipmode_in(folder, {"plot", "c.h5", "--figure", "multipliers", "-o", "none.svg"}).exit_code, 0);
  expect_refused({"find", chain, "--by", "balance", "--set", "contact.1.mu_s=0.3"}, {"contact.1.mu_s", "shooting"});
}

TEST_F(OrbitVerbs, BalanceUnderAShaker) {
  const std::string beam = SLIPMODE_SOURCE_DIR "/datasets/beam_12hz/scene.toml";
  const auto with = [&](const char* verb, const std::vector<std::string>& more) {
    std::vector<std::string> all = {verb,    beam,
                                    "--set", "structure.elements=5",
                                    "--set", "contact.0.mu_s=0.55",
                                    "--set", "contact.0.normal_load.slope=0",
                                    "--set", "contact.0.tilt_deg=0",
                                    "--by",  "balance"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const auto said = json_of(with("find", {"--harmonics", "auto", "--error", "1e-2", "-o", "b.h5"}));
  EXPECT_LE(said["certificate"]["relative"], 1e-2);
  EXPECT_EQ(said["certificate"]["orbit"]["crossings"], said["switches"]);
  EXPECT_EQ(slipmode_in(folder, {"plot", "b.h5", "-o", "portrait.svg"}).exit_code, 0);
  const auto branch =
      json_of(with("continue", {"--harmonics", "9", "--over", "drive.frequency=13:13.3", "--certify", "-o", "c.h5"}));
  EXPECT_EQ(branch["branches"][0]["end"], "range");
  // Next to a change of the word shooting may end elsewhere.
  EXPECT_GE(branch["certificate"]["behind"].get<int>(), 0.9 * branch["certificate"]["certified"].get<int>());
  expect_refused({"find", beam, "--by", "balance"}, {"contact.0.mu_s = 0.748", "shooting"});
  expect_refused({"find", SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml", "--by", "balance"}, {"drive.kind"});
}

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

TEST_F(OrbitVerbs, SaysHowFarItCameWithoutAnOrbit) {
  const auto said = json_of({"find", kSdof, "--start", "2.0,0.0", "--iterations", "2"}, 3);
  EXPECT_EQ(said["status"], "failed");
  EXPECT_EQ(said["residuals"].size(), 3U);
  EXPECT_THAT(said["message"].get<std::string>(), HasSubstr("no orbit from this guess"));
  EXPECT_EQ(said["best"]["displacement"].size(), 1U);
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
  expect_refused(with("fold", "drive.amplitude=0.5:2", "drive.omega=0.6:1.5", {"--by", "balance"}),
                 {"--along, --point", "--by balance"});
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
  // A branch, a certificate and a curve that would take minutes; each is stopped later until something was found.
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/jenkins_chain/scene.toml";
  const std::vector<std::vector<std::string>> each = {
      {"continue", kSdof, "--over", "drive.omega=1.8:0.65", "--start", "2.5,0", "--max-step", "2e-6", "--points",
       "1000000"},
      {"continue", chain, "--over", "drive.omega=0.1:1", "--by", "balance", "--harmonics", "25", "--certify",
       "--max-step", "1e-5", "--points", "1000000"},
      {"continue", kSdof, "--over", "drive.omega=1.3:1.5", "--start", "2.5,0", "--point", "fold", "--along",
       "drive.amplitude=0.2:2", "--max-step", "3e-4", "--points", "1000000"}};
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

TEST_F(OrbitVerbs, FindsTheChainsOwnPeriod) {
  const std::string chain = SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml";
  const auto said = json_of({"find", chain, "--set", "drive.speed=0.45"});
  // datasets/chain10/expected.toml: event-driven fixed-step integration by another program
  EXPECT_NEAR(said["period"], 45.10211, 1e-5);
  EXPECT_EQ(said["kind"], "self-excited");
  EXPECT_EQ(said["trivial_multipliers"], 1);
  EXPECT_GE(said["zero_multipliers"], 1);
  expect_refused({"find", chain, "--order", "2"}, {"--order 2", "--period"});
  expect_refused({"find", chain, "--start", "initial"}, {"--start initial", "--period"});
  expect_refused({"find", chain, "--start", "1,2", "--period", "45"}, {"2 values for 10 degrees of freedom", "20"});
}

TEST_F(OrbitVerbs, ReducedModelWithAllModesHasTheSameOrbit) {
  const std::string four = SLIPMODE_SOURCE_DIR "/datasets/backlash_4mass/scene.toml";
  ASSERT_EQ(slipmode_in(folder, {"simulate", four, "-o", "run.h5"}).exit_code, 0);
  ASSERT_EQ(slipmode_in(folder, {"pod", "run.h5", "-o", "pod.h5"}).exit_code, 0);
  ASSERT_EQ(slipmode_in(folder, {"reduce", four, "pod.h5", "--modes", "4", "-o", "rom.h5"}).exit_code, 0);
  const auto full = json_of({"find", four});
  const auto reduced = json_of({"find", four, "--model", "rom:rom.h5"});
  // A basis of all modes is a change of coordinates.
  EXPECT_EQ(reduced["model"], "reduced model, 4 modes");
  EXPECT_NEAR(reduced["leading_modulus"], full["leading_modulus"], 1e-9);
  for (const char* size : {"min", "max", "mean"}) {
    EXPECT_NEAR(reduced["amplitudes"][0][size], full["amplitudes"][0][size], 1e-9) << size;
  }
  const auto branch =
      json_of({"continue", four, "--model", "rom:rom.h5", "--over", "drive.omega=0.93:0.95", "-o", "b.h5"});
  EXPECT_EQ(branch["branches"][0]["end"], "range");
  expect_refused({"find", four, "--model", "pod.h5"}, {"--model pod.h5", "rom:FILE"});
  expect_refused({"find", four, "--model", "rom:pod.h5"}, {"pod.h5", "expected a reduced model", "slipmode reduce"});
}

TEST_F(OrbitVerbs, OtherVerbsSayWhatToUseUnderAForce) {
  const Outcome sweep = slipmode_in(folder, {"sweep", kSdof, "--over", "drive.omega=1:2:1", "-o", "s.h5"});
  EXPECT_EQ(sweep.exit_code, 2);
  EXPECT_THAT(sweep.err, HasSubstr("slipmode orbit"));
  const Outcome typing = call({"fnd"});
  EXPECT_EQ(typing.exit_code, 2);
  EXPECT_THAT(typing.err, HasSubstr("orbit fnd: no such verb; valid: find, continue"));
}

TEST_F(OrbitVerbs, ModesAtTheStopsAreThoseOfTheirSprings) {
  const Outcome outcome = slipmode_in(folder, {"modes", kSdof, "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["slipping"]["omega"][0], 0.0);                // it floats
  EXPECT_DOUBLE_EQ(outcome.json()["held_by_springs"]["omega"][0], 2.0);  // sqrt(4/1)
}

}  // namespace
