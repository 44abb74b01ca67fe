// slipmode orbit find and spectrum: what they say and store, and what they refuse.

#include "cli/orbit_verbs.hpp"
#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/store.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace {

using namespace slipmode;
using namespace slipmode::tests;
using testing::HasSubstr;

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

TEST_F(OrbitVerbs, SaysHowFarItCameWithoutAnOrbit) {
  const auto said = json_of({"find", kSdof, "--start", "2.0,0.0", "--iterations", "2"}, 3);
  EXPECT_EQ(said["status"], "failed");
  EXPECT_EQ(said["residuals"].size(), 3U);
  EXPECT_THAT(said["message"].get<std::string>(), HasSubstr("no orbit from this guess"));
  EXPECT_EQ(said["best"]["displacement"].size(), 1U);
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

TEST_F(OrbitVerbs, AMistypedVerbIsNamedBesideThoseThereAre) {
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
