#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/messages.hpp"

#include <gtest/gtest.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace {

using namespace slipmode;
using scene::parse_scene;
using scene::Scene;
using slipmode::tests::BadValue;
using slipmode::tests::error_of;
using slipmode::tests::expect_parts;
using slipmode::tests::expect_refused;
using slipmode::tests::message_of;
using slipmode::tests::replaced;

const std::string kChain = R"(title = "test"
units = "dimensionless"
[structure]
kind = "chain"
masses = 10
damping = 0.006
[[contact]]
at = 10
law = "stribeck"
mu_s = 0.4
mu_k = 0.2
alpha = 8.0
normal_load = 3.0
[drive]
kind = "belt"
speed = 0.2
[time]
duration = 100.0
)";

TEST(Scene, ReadsEveryValueAndFillsDefaults) {
  const Scene s = parse_scene(kChain);
  EXPECT_EQ(s.title, "test");
  EXPECT_EQ(s.chain()->masses, 10);
  EXPECT_EQ(s.chain()->damping, 0.006);
  EXPECT_TRUE(s.chain()->left_fixed);
  EXPECT_FALSE(s.chain()->right_fixed);
  ASSERT_EQ(s.contacts.size(), 1U);
  EXPECT_EQ(std::get<int>(s.contacts[0].at), 10);
  EXPECT_EQ(s.contacts[0].normal_load.constant, 3.0);
  EXPECT_EQ(std::get<friction::Stribeck>(s.contacts[0].law).alpha, 8.0);
  EXPECT_EQ(s.drive.velocity(7.0), 0.2);
  EXPECT_EQ(s.time.duration, 100.0);
  EXPECT_EQ(s.reduction.choice.energy, 0.99);
  EXPECT_EQ(s.ensemble.members, 1);
}

TEST(Scene, RampIsLinearBetweenItsEnds) {
  const Scene s =
      parse_scene(replaced(kChain, "speed = 0.2", "speed = { from = 0.5, to = 0.1, begin = 10.0, end = 20.0 }"));
  EXPECT_DOUBLE_EQ(s.drive.velocity(0.0), 0.5);
  EXPECT_DOUBLE_EQ(s.drive.velocity(15.0), 0.3);
  EXPECT_DOUBLE_EQ(s.drive.velocity(30.0), 0.1);
}

TEST(Scene, WrittenSceneReadsBackToTheSameBytes) {
  const std::string rich = R"(title = "quotes \" and \\ and a
"
units = "SI"
[structure]
kind = "chain"
masses = 3
ends = "fixed-fixed"
mass = [1.0, 2.5, 0.1]
stiffness = [1e5, 2e-3, 3.0, 4]
ground_stiffness = [0.0, 0.25, 0.0]
damping = 0.1
mass_damping = 0.3333333333333333
[[contact]]
at = 3
law = "coulomb"
mu_s = 0.4
mu_k = 0.4
normal_load = 1
[[contact]]
at = 1
law = "tanh"
mu_s = 0.5
mu_k = 0.4
epsilon = 1e-5
normal_load = 2.0
name = "left"
[drive]
kind = "belt"
speed = { from = -0.5, to = 1e-9, begin = 0.0, end = 20.0 }
[time]
duration = 1e7
transient = 3.0
sample = 0.1
[initial]
displacement = [1, 2, 3.25]
[ensemble]
members = 3
seed = 9223372036854775807
spread = 0.1
speeds = [0.1, 0.2]
[reduction]
basis = "lnm"
modes = 2
[validation]
speeds = { from = 0.1, to = 0.2, step = 0.05 }
orbits = [0.45]
modes = [1, 3]
sweep_limit = 700.0
[flow]
method = "closed-form"
tolerance = 1e-11
)";
  const std::string text = scene_to_toml(parse_scene(replaced(rich, "a\n\"", "a\"")));
  EXPECT_EQ(scene_to_toml(parse_scene(text)), text);
  const Scene s = parse_scene(text);
  EXPECT_EQ(s.title, "quotes \" and \\ and a");
  EXPECT_EQ(s.chain()->mass_damping, 0.3333333333333333);
  EXPECT_EQ(s.chain()->stiffness, (std::vector<double>{1e5, 2e-3, 3.0, 4.0}));
  EXPECT_EQ(s.contacts[1].name, "left");
  EXPECT_EQ(s.initial.displacement, (std::vector<double>{1.0, 2.0, 3.25}));
  EXPECT_EQ(s.initial.velocity, (std::vector<double>{0.0, 0.0, 0.0}));
  EXPECT_EQ(s.ensemble.seed, 9223372036854775807ULL);
  EXPECT_EQ(s.reduction.basis, scene::BasisChoice::kLnm);
  EXPECT_EQ(s.validation.modes, (std::vector<int>{1, 3}));
  EXPECT_EQ(s.validation.sweep_limit, 700.0);
  EXPECT_EQ(s.validation.limit, 100000.0);
  EXPECT_EQ(s.flow.method, dynamics::FlowMethod::kClosedForm);
}

TEST(Scene, OverridesReachTablesArraysAndDefaults) {
  const Scene s = parse_scene(
      kChain, {"drive.speed=0.25", "structure.masses=40", "contact.0.mu_s = 0.5", "reduction.basis=lnm",
               "ensemble.seed=7", "drive.speed=0.3", "validation={orbits=[0.4]}", "validation.max_period=9"});
  EXPECT_EQ(s.drive.velocity(0.0), 0.3);
  EXPECT_EQ(s.chain()->masses, 40);
  EXPECT_EQ(std::get<friction::Stribeck>(s.contacts[0].law).mu_s, 0.5);
  EXPECT_EQ(s.reduction.basis, scene::BasisChoice::kLnm);
  EXPECT_EQ(s.ensemble.seed, 7U);
  EXPECT_EQ(s.validation.orbits, (std::vector<double>{0.4}));
  EXPECT_EQ(s.validation.max_period, 9);
  EXPECT_EQ(s.source.overrides.size(), 8U);
  EXPECT_EQ(s.source.text, kChain);
}

TEST(Scene, BadOverridesAreNamed) {
  expect_parts(error_of(kChain, {"drive.sped=0.25"}),
               {"s.toml", "override drive.sped=0.25", "unknown key", "did you mean 'speed'"});
  expect_parts(error_of(kChain, {"nowhere.speed=1"}), {"override nowhere.speed=1", "nowhere", "unknown key"});
  expect_parts(error_of(kChain, {"contact.1.alpha=2"}), {"override contact.1.alpha=2", "valid: 0 to 0"});
  expect_parts(error_of(kChain, {"contact.0.mu_s=0.1"}),
               {"override contact.0.mu_s=0.1", "contact.0.mu_s = 0.1", "less than mu_k = 0.2", "valid: mu_s >= 0.2"});
  expect_parts(error_of(kChain, {"drive.speed"}), {"override drive.speed", "PATH=VALUE"});
  expect_parts(error_of(kChain, {"drive.speed="}), {"override drive.speed=", "not TOML"});
  expect_parts(error_of(kChain, {"drive.speed=1\nx=2"}), {"expected one value"});
  expect_parts(error_of(kChain, {"drive..speed=1"}), {"empty part"});
  expect_parts(error_of(kChain, {"drive.speed.from=1"}), {"drive.speed = 0.2", "has no keys"});
  expect_parts(error_of(kChain, {"drive.speed=fast"}),
               {"drive.speed = \"fast\"", "wrong type", "valid: any finite number"});
}

TEST(Scene, MissingFileIsNamed) {
  expect_parts(message_of([] { (void)scene::load_scene("/nowhere/scene.toml"); }),
               {"/nowhere/scene.toml", "no such scene file", "check the path"});
}

TEST(Scene, FolderInsteadOfFileIsNamed) {
  const auto folder = std::filesystem::temp_directory_path();
  expect_parts(message_of([&] { (void)scene::load_scene(folder); }), {folder.string(), "is a folder"});
}

TEST(Scene, BadTomlNamesFileAndLine) {
  expect_parts(error_of("title = \"a\"\nunits = dimensionless\n"), {"s.toml:2:", "not valid TOML"});
}

class BadScene : public testing::TestWithParam<BadValue> {};

TEST_P(BadScene, NamesPlaceKeyValueAndRemedy) { expect_refused(kChain, GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Values, BadScene,
    testing::Values(
        BadValue{"damping = 0.006",
                 "dampng = 0.006",
                 {"s.toml:6: structure.dampng = 0.006: unknown key", "did you mean 'damping'", "valid: ", "masses"}},
        BadValue{"title =", "tilte =", {"s.toml:1: tilte", "unknown key", "did you mean 'title'"}},
        BadValue{"alpha = 8.0\n", "", {"s.toml:7: contact.0.alpha: missing key"}},
        BadValue{"mu_k = 0.2", "mu_kk = 0.2", {"contact.0.mu_k: missing key", "is 'mu_kk' meant to be 'mu_k'?"}},
        BadValue{"masses = 10", "masses = 10.5", {"s.toml:5: structure.masses = 10.5: wrong type", "an integer"}},
        BadValue{"masses = 10", "masses = \"ten\"", {"structure.masses = \"ten\"", "wrong type"}},
        BadValue{"masses = 10", "masses = 0", {"structure.masses = 0: impossible value; valid: an integer from 1"}},
        BadValue{"mu_s = 0.4", "mu_s = 0.1", {"s.toml:10: contact.0.mu_s = 0.1: less than mu_k = 0.2", "mu_s >= 0.2"}},
        BadValue{"masses = 10", "masses = 10\nmass = -1.0", {"s.toml:6: structure.mass = -1:", "a number > 0"}},
        BadValue{"masses = 10", "masses = 10\nmass = [1.0, 2.0]", {"structure.mass = ", "2 values", "array of 10"}},
        BadValue{"masses = 10", "masses = 10\nmass = [1,1,1,1,1,1,1,1,1,0]", {"structure.mass", "a number > 0"}},
        BadValue{"normal_load = 3.0", "normal_load = 0.0", {"s.toml:13: contact.0.normal_load = 0:", "a number > 0"}},
        BadValue{"at = 10", "at = 11", {"s.toml:8: contact.0.at = 11", "an integer from 1 to 10"}},
        BadValue{"speed = 0.2", "speed = nan", {"s.toml:16: drive.speed = nan: not a finite number"}},
        BadValue{"speed = 0.2", "speed = -inf", {"drive.speed = -inf: not a finite number"}},
        BadValue{"speed = 0.2", "speed = {from=1,to=2,begin=5,end=5}", {"drive.speed.end = 5: not after begin"}},
        BadValue{"units = \"dimensionless\"",
                 "units = \"si\"",
                 {"s.toml:2: units = \"si\": unknown word, did you mean \"SI\"?", "\"dimensionless\", \"SI\""}},
        BadValue{"law = \"stribeck\"", "law = \"stribek\"", {"did you mean \"stribeck\"", "\"coulomb\""}},
        BadValue{"law = \"stribeck\"",
                 "law = \"coulomb\"",
                 {"s.toml:12: contact.0.alpha = 8: law \"coulomb\" does not depend", "no alpha"}},
        BadValue{"kind = \"belt\"", "kind = \"shaken\"", {"drive.kind = \"shaken\"", "valid: \"belt\", \"shaker\""}},
        BadValue{
            "duration = 100.0", "duration = 100.0\ntransient = 100.0", {"time.transient = 100:", "nothing is left"}},
        BadValue{"[time]", "[validation]\nsweep_limit = 0\n[time]", {"validation.sweep_limit = 0:", "a number > 0"}},
        BadValue{"[time]", "[reduction]\nmodes = 11\n[time]", {"reduction.modes = 11", "an integer from 1 to 10"}},
        BadValue{"[time]", "[reduction]\nenergy = 1.5\n[time]", {"reduction.energy = 1.5", "<= 1"}},
        BadValue{"[time]", "[reduction]\nenergy = 0.9\nmodes = 2\n[time]", {"either modes or energy"}},
        BadValue{"[time]", "[initial]\nvelocity = [1.0]\n[time]", {"initial.velocity", "an array of 10 values"}},
        BadValue{"[[contact]]", "[contact]", {"contact", "wrong type", "[[contact]]"}},
        BadValue{"[drive]",
                 "[[contact]]\nat = 10\nlaw = \"coulomb\"\nmu_s = 0\nmu_k = 0\nnormal_load = 1\n[drive]",
                 {"contact.1.at = 10: contact.0 is on this mass already", "one per mass of those that stick rigidly"}}),
    tests::bad_value_name);

TEST(Scene, KeysCanBeReadAndSetByPath) {
  const Scene s = parse_scene(kChain);
  EXPECT_EQ(get_key(s, "drive.speed"), 0.2);
  EXPECT_EQ(get_key(s, "contact.0.alpha"), 8.0);
  EXPECT_EQ(get_key(s, "structure.masses"), 10.0);
  EXPECT_EQ(get_key(s, "validation.speeds.step"), 0.001);  // a default
  const Scene t = set_key(set_key(s, "drive.speed", 0.1 + 0.2), "structure.masses", 40);
  EXPECT_EQ(t.drive.velocity(0.0), 0.1 + 0.2);  // to the last bit
  EXPECT_EQ(t.chain()->masses, 40);
  EXPECT_EQ(t.source.text, kChain);
  EXPECT_EQ(t.source.overrides.size(), 2U);
  EXPECT_EQ(scene_to_toml(parse_scene(t.source.text, t.source.overrides)), scene_to_toml(t));
}

TEST(Scene, SetAndGetRejectWhatIsNotThere) {
  const Scene s = parse_scene(kChain, {}, "s.toml");
  expect_parts(message_of([&] { (void)set_key(s, "drive.sped", 1.0); }), {"drive.sped", "did you mean 'speed'"});
  expect_parts(message_of([&] { (void)set_key(s, "contact.0.normal_load", 0.0); }), {"contact.0.normal_load", "> 0"});
  expect_parts(message_of([&] { (void)get_key(s, "drive.sped"); }), {"s.toml", "drive.sped", "no such key"});
  expect_parts(message_of([&] { (void)get_key(s, "contact.7.mu_s"); }), {"contact.7.mu_s", "no such key"});
  expect_parts(message_of([&] { (void)get_key(s, "drive.kind"); }), {"drive.kind", "not a number"});
}

TEST(Scene, SystemHasTheContactOnItsMass) {
  const Scene s = parse_scene(kChain, {"contact.0.at=3"});
  const auto system = build_system(s);
  EXPECT_EQ(system.size(), 10);
  ASSERT_EQ(system.contacts().size(), 1U);
  EXPECT_EQ(system.contacts()[0].direction, Eigen::VectorXd::Unit(10, 2));
  EXPECT_EQ(system.drive().velocity(0.0), 0.2);
}

TEST(Scene, StaticStartStretchesTheChainLinearly) {
  // Unit springs in series from the wall, pulled at mass 10 by mu_k N = 0.6: x_i = 0.6 i.
  const Scene s = parse_scene(kChain, {"initial.at=static"});
  const auto state = initial_state(s, build_system(s));
  EXPECT_LT((state.q - 0.6 * Eigen::VectorXd::LinSpaced(10, 1.0, 10.0)).cwiseAbs().maxCoeff(), 1e-14 * 60);
  EXPECT_EQ(state.v, Eigen::VectorXd::Zero(10));
  const Scene back = parse_scene(kChain, {"initial.at=static", "drive.speed=-0.2"});
  EXPECT_LT((initial_state(back, build_system(back)).q + state.q).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Scene, StaticStartOfAFreeChainIsRefused) {
  const Scene s = parse_scene(kChain, {"initial.at=static", "structure.ends=free-free"});
  expect_parts(message_of([&] { (void)initial_state(s, build_system(s)); }),
               {"initial.at", "held by nothing", "valid"});
}

TEST(Scene, ShippedScenesParse) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SLIPMODE_SOURCE_DIR "/datasets")) {
    if (!std::filesystem::exists(entry.path() / "scene.toml")) continue;
    const Scene s = scene::load_scene(entry.path() / "scene.toml");
    EXPECT_FALSE(s.title.empty());
    ++scenes;
  }
  EXPECT_GE(scenes, 1);
}

}  // namespace
