// Scenes of masses and matrices with clearances under a force: what they say, and what they may not say.

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/beam_scene.hpp"
#include "scene/messages.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>
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
using tests::replaced;

const std::string kPair = R"(title = "two masses"
units = "dimensionless"
[structure]
kind = "masses"
mass = [0.5, 2.0]
[[structure.link]]
at = 1
stiffness = 0.25
damping = 0.125
[[structure.link]]
between = [1, 2]
damping = 0.0625
[[contact]]
name = "gear"
between = [1, 2]
law = "clearance"
loss = "gap"
left = { stiffness = 3.0, gap = 0.5 }
right = { stiffness = 4.0, damping = 0.5, gap = 1.0 }
[drive]
kind = "force"
omega = 1.25
amplitude = 2.0
phase = 0.3
at = 2
mean = 0.125
[[drive.harmonic]]
order = 3
amplitude = 0.75
direction = [1.0, -0.5]
[[drive.harmonic]]
order = 2
amplitude = 0.0625
phase = -1.0
[time]
cycles = 20
transient_cycles = 5
samples_per_cycle = 16
[initial]
displacement = [0.1, 0.7]
)";

TEST(ClearanceScene, BuildsTheSystemItSays) {
  const dynamics::HybridSystem system = build_system(parse_scene(kPair));
  // by hand from the text
  EXPECT_EQ(fem::to_dense(system.structure().K()), (Eigen::Matrix2d{{0.25, 0.0}, {0.0, 0.0}}));
  EXPECT_EQ(fem::to_dense(system.structure().C()), (Eigen::Matrix2d{{0.1875, -0.0625}, {-0.0625, 0.0625}}));
  EXPECT_EQ(system.contacts()[0].direction, Eigen::Vector2d(-1.0, 1.0));  // x2 − x1
  const auto& law = std::get<friction::Clearance>(system.contacts()[0].law);
  EXPECT_EQ(law.loss, friction::ContactLoss::kGap);
  EXPECT_EQ(law.left->stiffness, 3.0);
  EXPECT_EQ(law.left->damping, 0.0);
  EXPECT_EQ(law.left->gap, 0.5);
  EXPECT_EQ(law.right->damping, 0.5);
  EXPECT_EQ(system.load(), Eigen::Vector2d(0.0, 0.125));
  ASSERT_NE(system.drive().force(), nullptr);
  const friction::Force& force = *system.drive().force();
  ASSERT_EQ(force.harmonics.size(), 3U);
  EXPECT_EQ(system.force_directions(), (Eigen::Matrix2d{{0.0, 1.0}, {1.0, -0.5}}));  // a place once, as a column
  EXPECT_EQ(force.harmonics[1].order, 3);
  EXPECT_EQ(force.harmonics[1].direction, 1);
  EXPECT_EQ(force.harmonics[2].direction, 0);  // where the first acts
  EXPECT_EQ(force.value(0, 0.4), 2.0 * std::sin(1.25 * 0.4 + 0.3) + 0.0625 * std::sin(2.0 * 1.25 * 0.4 - 1.0));
}

TEST(ClearanceScene, ReadsBackFromItsOwnTextToTheSameBytes) {
  const std::vector<std::vector<std::string>> changes = {
      {},
      {"drive={kind=\"force\", frequency=0.3333333333333333, amplitude=1.0, between=[2,1], mean=[0.1,0.2]}"},
      {"contact.0.stop={stiffness=7.0, gap=-0.25}", "contact.0.left={gap=0.75}", "contact.0.right={}"},
      {"structure={kind=\"matrices\", mass=[[2.0,0.1],[0.1,1.0]], damping=[[0.3,0.1],[0.0,0.2]]}"},
      {"contact.0.right={stiffness=1.0, gap=0.0}", "contact.0.loss=zero-force"},
      {"time={duration=50.0, sample=0.1}"},
      {"ensemble.omegas=[0.5, 1.5]", "validation={omegas={from=0.5, to=1.5, step=0.25}, cycles=50.0, kept=20.0}"},
      {"drive={kind=\"force\", frequency=0.3, amplitude=1.0, at=1}", "ensemble.frequencies=[0.2, 0.4]",
       "validation.frequencies={from=0.2, to=0.4, step=0.1}"},
  };
  for (const auto& overrides : changes) {
    const Scene scene = parse_scene(kPair, overrides);
    const std::string text = scene_to_toml(scene);
    EXPECT_EQ(scene_to_toml(parse_scene(text)), text);
    const auto a = build_system(scene), b = build_system(parse_scene(text));
    EXPECT_EQ(fem::to_dense(a.structure().C()), fem::to_dense(b.structure().C()));
    EXPECT_EQ(a.force_directions(), b.force_directions());
    EXPECT_EQ(a.drive().force()->omega, b.drive().force()->omega);
    EXPECT_EQ(scene.time.duration, parse_scene(text).time.duration);
  }
}

TEST(ClearanceScene, SideKeysOverrideWhatBothStopsShare) {
  const Scene scene = parse_scene(replaced(kPair, "left = { stiffness = 3.0, gap = 0.5 }\nright =", "stop ="),
                                  {"contact.0.left={gap=0.25}"});
  const auto& law = std::get<friction::Clearance>(scene.contacts[0].law);
  EXPECT_EQ(law.left->gap, 0.25);
  EXPECT_EQ(law.left->stiffness, 4.0);
  EXPECT_EQ(law.left->damping, 0.5);
  EXPECT_EQ(law.right->gap, 1.0);
}

// Expected: SI units of what each key is, by hand.
TEST(ClearanceScene, KeysHaveTheUnitsOfTheirFields) {
  const std::string si = replaced(kPair, "\"dimensionless\"", "\"SI\"");
  const Scene apart = parse_scene(si);
  const Scene shared = parse_scene(replaced(si, "left = { stiffness = 3.0, gap = 0.5 }\nright =", "stop ="));
  for (const auto& [key, unit] : std::vector<std::pair<std::string, std::string>>{{"structure.mass.1", "kg"},
                                                                                  {"structure.link.0.stiffness", "N/m"},
                                                                                  {"structure.link.1.damping", "N s/m"},
                                                                                  {"contact.0.right.gap", "m"},
                                                                                  {"contact.0.left.stiffness", "N/m"},
                                                                                  {"contact.0.right.damping", "N s/m"},
                                                                                  {"drive.omega", "rad/s"},
                                                                                  {"drive.amplitude", "N"},
                                                                                  {"drive.mean", "N"},
                                                                                  {"drive.phase", "rad"},
                                                                                  {"drive.harmonic.1.amplitude", "N"},
                                                                                  {"drive.harmonic.1.order", "1"},
                                                                                  {"initial.displacement.0", "m"},
                                                                                  {"initial.velocity.1", "m/s"},
                                                                                  {"no.such.key", "1"}}) {
    EXPECT_EQ(unit_of_key(apart, key), unit) << key;
    EXPECT_EQ(unit_of_key(shared, key), unit) << key;
    EXPECT_EQ(unit_of_key(parse_scene(kPair), key), "1") << key;
  }
}

TEST(ClearanceScene, SideOfSharedStopsCanBeReadAndSet) {
  const Scene shared = parse_scene(replaced(kPair, "left = { stiffness = 3.0, gap = 0.5 }\nright =", "stop ="));
  EXPECT_EQ(get_continuous_key(shared, "contact.0.left.gap"), 1.0);
  const Scene other = set_key(shared, "contact.0.left.gap", 0.75);
  EXPECT_EQ(get_key(other, "contact.0.left.gap"), 0.75);
  EXPECT_EQ(get_key(other, "contact.0.right.gap"), 1.0);
}

TEST(ClearanceScene, OneStopIsEnough) {
  const Scene scene = parse_scene(replaced(kPair, "left = { stiffness = 3.0, gap = 0.5 }\n", ""));
  EXPECT_FALSE(std::get<friction::Clearance>(scene.contacts[0].law).left.has_value());
}

TEST(ClearanceScene, CyclesAreTheForcesOwn) {
  const Scene scene = parse_scene(kPair);
  const double period = 2.0 * std::numbers::pi / 1.25;
  EXPECT_NEAR(scene.time.duration, 20.0 * period, 1e-13 * scene.time.duration);
  EXPECT_NEAR(scene.time.sample, period / 16.0, 1e-14);
  EXPECT_NEAR(set_key(scene, "drive.omega", 2.5).time.duration, 10.0 * period, 1e-13 * scene.time.duration);
}

TEST(ClearanceScene, FrequencyIsOmegaInCycles) {
  const Scene scene = parse_scene(replaced(kPair, "omega = 1.25", "frequency = 0.25"));
  EXPECT_DOUBLE_EQ(scene.drive.force()->omega, 0.5 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(set_key(scene, "drive.frequency", 0.5).drive.force()->omega, std::numbers::pi);
}

TEST(ClearanceScene, DriveMovesAlongOmegaWithItsHarmonics) {
  const Scene scene = parse_scene(kPair);
  EXPECT_EQ(drive_parameter(scene), 1.25);
  const friction::Drive other = drive_at(scene, 0.5);
  EXPECT_EQ(other.force()->omega, 0.5);
  EXPECT_EQ(other.force()->harmonics.size(), 3U);
}

TEST(ClearanceScene, ADriveAndItsTimesMoveAlongTheKeyTheSceneGives) {
  const Scene by_omega = parse_scene(kPair);
  const Scene by_frequency = parse_scene(replaced(kPair, "omega = 1.25", "frequency = 0.25"));
  EXPECT_EQ(drive_key(by_omega), "drive.omega");
  EXPECT_EQ(drive_key(by_frequency), "drive.frequency");
  EXPECT_EQ(drive_parameter(by_frequency), 0.25);
  for (const Scene& scene : {by_omega, by_frequency}) {
    const Scene other = set_key(scene, drive_key(scene), 0.7);
    EXPECT_EQ(drive_at(scene, 0.7).force()->omega, other.drive.force()->omega);
    EXPECT_EQ(time_at(scene, 0.7).duration, other.time.duration);
    EXPECT_EQ(time_at(scene, 0.7).sample, other.time.sample);
  }
}

TEST(ClearanceScene, ContinuousKeysAreRealNumbersOfTheModel) {
  const Scene scene = parse_scene(kPair);
  EXPECT_EQ(get_continuous_key(scene, "drive.omega"), 1.25);
  EXPECT_EQ(get_continuous_key(scene, "contact.0.right.gap"), 1.0);
  EXPECT_EQ(get_continuous_key(scene, "structure.link.0.stiffness"), 0.25);
  const auto message = [&](const std::string& key) {
    try {
      (void)get_continuous_key(scene, key);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("no InvalidInput");
  };
  expect_parts(message("drive.harmonic.0.order"), {"drive.harmonic.0.order = 3", "counts something", "real number"});
  expect_parts(message("contact.0.law"), {"contact.0.law = \"clearance\"", "not a number"});
  expect_parts(message("time.cycles"), {"time.cycles = 20", "not part of the model"});
  expect_parts(message("drive.speed"), {"drive.speed", "no such key"});
}

TEST(ClearanceScene, FrictionBetweenMassesOfAChainIsAContactToo) {
  const Scene scene = parse_scene(R"(units = "dimensionless"
[structure]
kind = "chain"
masses = 3
[[contact]]
between = [3, 1]
law = "coulomb"
mu_s = 0.4
mu_k = 0.2
normal_load = 3.0
[drive]
kind = "belt"
speed = 0.2
[time]
duration = 10.0
)");
  EXPECT_EQ(build_system(scene).contacts()[0].direction, Eigen::Vector3d(1.0, 0.0, -1.0));
  EXPECT_EQ(to_string(scene.contacts[0].at), "3-1");
}

class BadClearance : public testing::TestWithParam<BadValue> {};

TEST_P(BadClearance, NamesPlaceKeyValueAndRemedy) { expect_refused(kPair, GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Structure, BadClearance,
    testing::Values(
        BadValue{"\"masses\"", "\"mases\"", {"s.toml:4: structure.kind = \"mases\": unknown word", "\"matrices\""}},
        BadValue{"mass = [0.5, 2.0]", "mass = [0.5, 0.0]", {"s.toml:5: structure.mass", "a number > 0"}},
        BadValue{"mass = [0.5, 2.0]", "mass = []", {"structure.mass = []: no masses"}},
        BadValue{"at = 1\nstiffness", "stiffness", {"structure.link.0.at: missing", "between = [mass, mass]"}},
        BadValue{"at = 1\nstiffness", "at = 3\nstiffness", {"s.toml:7: structure.link.0.at = 3", "from 1 to 2"}},
        BadValue{
            "at = 1\nstiffness", "at = 1\nbetween = [1, 2]\nstiffness", {"structure.link.0.between", "at is given"}},
        BadValue{"between = [1, 2]\ndamping", "between = [1, 1]\ndamping", {"structure.link.1.between", "different"}},
        BadValue{"stiffness = 0.25", "stiffness = -1.0", {"structure.link.0.stiffness = -1", "a number >= 0"}},
        BadValue{"kind = \"masses\"\nmass = [0.5, 2.0]",
                 "kind = \"matrices\"\nmass = [[1.0, 2.0], [2.0, 1.0]]",
                 {"structure.mass", "not positive definite"}},
        BadValue{"kind = \"masses\"\nmass = [0.5, 2.0]",
                 "kind = \"matrices\"\nmass = [[1.0, 0.0], [0.0]]",
                 {"s.toml:5: structure.mass", "row 2 is no array of 2 numbers", "square matrix"}},
        BadValue{"kind = \"masses\"\nmass = [0.5, 2.0]",
                 "kind = \"matrices\"\nmass = [[1.0, 0.0], [0.0, 1.0]]\ndamping = [[1.0]]",
                 {"s.toml:6: structure.damping", "1 rows", "a 2 x 2 matrix"}}),
    tests::bad_value_name);

INSTANTIATE_TEST_SUITE_P(
    Contact, BadClearance,
    testing::Values(
        BadValue{"loss = \"gap\"", "loss = \"never\"", {"s.toml:17: contact.0.loss = \"never\"", "\"zero-force\""}},
        BadValue{"loss = \"gap\"", "normal_load = 3.0", {"contact.0.normal_load = 3", "no friction", "stop"}},
        BadValue{"gap = 0.5 }", "gap = -1.5 }", {"contact.0.law", "stops overlap", ">= 0"}},
        BadValue{"stiffness = 3.0", "stiffness = 0.0", {"contact.0.left.stiffness = 0", "a number > 0"}},
        BadValue{"damping = 0.5, gap = 1.0", "damping = -1, gap = 1.0", {"contact.0.right.damping = -1", ">= 0"}},
        BadValue{"damping = 0.5, gap = 1.0", "damping = 0.5", {"contact.0.right.gap: missing key"}},
        BadValue{"left = { stiffness = 3.0, gap = 0.5 }\nright = { stiffness = 4.0, damping = 0.5, gap = 1.0 }\n",
                 "",
                 {"contact.0.stop: missing key"}},
        BadValue{"between = [1, 2]\nlaw", "between = [1, 2]\nat = 1\nlaw", {"contact.0.at", "between is given too"}},
        BadValue{"between = [1, 2]\nlaw", "between = [1, 3]\nlaw", {"contact.0.between", "from 1 to 2"}},
        BadValue{"between = [1, 2]\nlaw", "between = [1]\nlaw", {"contact.0.between = [1]", "two different masses"}},
        BadValue{"[drive]",
                 "[[contact]]\nbetween = [2, 1]\nlaw = \"coulomb\"\nmu_s = 0.1\nmu_k = 0.1\nnormal_load = 1\n"
                 "[[contact]]\nbetween = [1, 2]\nlaw = \"compliant\"\nstiffness = 1\nmu_s = 0.1\nmu_k = 0.1\n"
                 "normal_load = 1\n[drive]",
                 {"contact.2.between", "contact.1 is on this pair of masses already"}}),
    tests::bad_value_name);

INSTANTIATE_TEST_SUITE_P(
    Drive, BadClearance,
    testing::Values(
        BadValue{"omega = 1.25", "omega = 0.0", {"s.toml:22: drive.omega = 0", "a number > 0"}},
        BadValue{"omega = 1.25", "", {"drive.omega: missing key"}},
        BadValue{"omega = 1.25", "omega = 1.25\nfrequency = 2.0", {"drive.omega", "frequency is given too"}},
        BadValue{"omega = 1.25", "omega = 1.25\nspeed = 2.0", {"drive.speed", "belongs to a belt"}},
        BadValue{"amplitude = 2.0", "amplitude = -2.0", {"drive.amplitude = -2", ">= 0"}},
        BadValue{"at = 2\nmean", "at = 5\nmean", {"drive.at = 5", "from 1 to 2"}},
        BadValue{"mean = 0.125", "mean = [1.0]", {"drive.mean = [1]: 1 values", "an array of 2 values"}},
        BadValue{"order = 3", "order = 0", {"drive.harmonic.0.order = 0", ">= 1"}},
        BadValue{"[1.0, -0.5]", "[0.0, 0.0]", {"drive.harmonic.0.direction", "all zero"}},
        BadValue{"[initial]",
                 "[ensemble]\nspeeds = [1.0]\n[initial]",
                 {"ensemble.speeds", "the drive is a force given by omega", "omegas"}},
        BadValue{"[initial]",
                 "[validation]\nfrequencies = { from = 1, to = 2, step = 1 }\n[initial]",
                 {"validation.frequencies", "the drive is a force given by omega", "omegas"}},
        BadValue{"[initial]",
                 "[validation]\nomegas = { from = 0, to = 2, step = 1 }\n[initial]",
                 {"validation.omegas.from = 0", "a number > 0"}},
        BadValue{"[initial]",
                 "[validation]\nhorizon = 2.0\n[initial]",
                 {"validation.horizon", "the drive has a period", "belt"}},
        BadValue{"[initial]",
                 "[validation]\nbases = [\"lnm\"]\n[initial]",
                 {"validation.bases", "the drive is a force", "POMs, LNMs"}},
        BadValue{"[initial]", "[validation]\nmodes = [1, 3]\n[initial]", {"validation.modes = [1, 3]", "from 1 to 2"}},
        BadValue{"displacement = [0.1, 0.7]", "at = \"static\"", {"initial.at = \"static\"", "a force", "\"rest\""}},
        BadValue{"[time]", "[time]\nduration = 3.0", {"time.duration", "given in cycles too"}}),
    tests::bad_value_name);

TEST(ClearanceScene, StaticStartOnABeltIsRefusedWithAClearance) {
  std::string text = kPair.substr(0, kPair.find("[drive]"));
  text += "[drive]\nkind = \"belt\"\nspeed = 0.1\n[time]\nduration = 1.0\n[initial]\nat = \"static\"\n";
  expect_parts(error_of(text), {"initial.at = \"static\"", "which stops are touched"});
}

}  // namespace
