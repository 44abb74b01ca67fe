// What a scene of a shaken beam may not say, and the message: file, line, key, value, what is wrong, what is valid.

#include <slipmode/scene/scene.hpp>
#include "scene/beam_scene.hpp"
#include "scene/messages.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace {

using namespace slipmode;
using slipmode::tests::BadValue;
using slipmode::tests::error_of;
using slipmode::tests::expect_parts;
using slipmode::tests::expect_refused;
using slipmode::tests::message_of;
using tests::kBeamOnBelt;
using tests::kBeamScene;
using tests::replaced;

class BadBeam : public testing::TestWithParam<BadValue> {};
class BadBelt : public testing::TestWithParam<BadValue> {};

TEST_P(BadBeam, NamesPlaceKeyValueAndRemedy) { expect_refused(kBeamScene, GetParam()); }

TEST_P(BadBelt, NamesPlaceKeyValueAndRemedy) { expect_refused(kBeamOnBelt, GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Structure, BadBeam,
    testing::Values(
        BadValue{"units = \"SI\"",
                 "units = \"dimensionless\"",
                 {"s.toml:4: structure.kind = \"beam\": units are \"dimensionless\"", "valid: units = \"SI\""}},
        BadValue{"length = 0.4", "length = 0.0", {"s.toml:6: structure.length = 0: impossible value", "a number > 0"}},
        BadValue{"width = 0.0128", "width = -1", {"s.toml:7: structure.width = -1", "a number > 0"}},
        BadValue{"thickness = 0.00086", "", {"structure.thickness: missing key"}},
        BadValue{"thickness = 0.00086", "thickness = 0", {"structure.thickness = 0", "a number > 0"}},
        BadValue{"density = 7488", "density = nan", {"structure.density = nan: not a finite number"}},
        BadValue{"youngs_modulus = 128e9", "youngs_modulus = 0", {"structure.youngs_modulus = 0", "a number > 0"}},
        BadValue{"elements = 8", "elements = 0", {"structure.elements = 0", "an integer from 1"}},
        BadValue{"\"euler-bernoulli\"", "\"euler\"", {"structure.theory = \"euler\": unknown word", "\"timoshenko\""}},
        BadValue{"elements = 8",
                 "elements = 8\npoisson_ratio = 0.3",
                 {"s.toml:12: structure.poisson_ratio = 0.3", "has no shear", "theory = \"timoshenko\""}},
        BadValue{"\"euler-bernoulli\"",
                 "\"timoshenko\"\npoisson_ratio = 0.6",
                 {"structure.poisson_ratio = 0.6", "> -1 and <= 0.5"}},
        BadValue{"elements = 8", "elements = 8\nmasses = 4", {"structure.masses = 4: unknown key", "elements"}},
        BadValue{"mass = 0.015", "mass = -1", {"structure.tip.mass = -1", "a number >= 0"}},
        BadValue{"extension = 0.064", "extension = -0.1", {"structure.tip.extension = -0.1", "a number >= 0"}},
        BadValue{"inertia = 1e-6", "inertai = 1", {"structure.tip.inertai = 1: unknown key", "'inertia'"}},
        BadValue{"modal_ratio = 0.01", "modal_ratio = -0.1", {"structure.damping.modal_ratio = -0.1", "number >= 0"}},
        BadValue{"modal_ratio = 0.01", "modal_ratio = []", {"structure.damping.modal_ratio = []: no values"}},
        BadValue{"modal_ratio = 0.01",
                 "modal_ratio = 0.01\ncoefficient = 1",
                 {"structure.damping.modal_ratio = 0.01: coefficient is given too", "exactly one of"}},
        BadValue{"modal_ratio = 0.01", "ratio = 0.01", {"structure.damping.frequency: missing key"}},
        BadValue{"modal_ratio = 0.01",
                 "ratio = [0.01, 0.02]\nfrequency = [3, 3]",
                 {"structure.damping.frequency = [3, 3]: the same twice"}},
        BadValue{"modal_ratio = 0.01",
                 "ratio = [0.01, 0.02]\nfrequency = 3",
                 {"structure.damping.frequency = 3: wrong type", "an array of 2 values"}},
        BadValue{"modal_ratio = 0.01", "", {"structure.damping.coefficient: missing key"}}),
    tests::bad_value_name);

INSTANTIATE_TEST_SUITE_P(
    Contact, BadBeam,
    testing::Values(
        BadValue{"at = \"tip\"", "at = \"tp\"", {"s.toml:20: contact.0.at = \"tp\"", "did you mean \"tip\""}},
        BadValue{"at = \"tip\"", "at = 0.5", {"contact.0.at = 0.5", "\"tip\", or x > 0 and <= 0.464"}},
        BadValue{"at = \"tip\"", "at = 0", {"contact.0.at = 0: impossible value"}},
        BadValue{"[drive]",
                 "[[contact]]\nat = 0.464\nlaw = \"coulomb\"\nmu_s = 0\nmu_k = 0\nnormal_load = 1\n[drive]",
                 {"contact.1.at = 0.464: contact.0 is on this place already", "one per place"}},
        BadValue{"stiffness = 20e3", "stiffness = 0", {"s.toml:24: contact.0.stiffness = 0", "a number > 0"}},
        BadValue{"stiffness = 20e3", "", {"contact.0.stiffness: missing key"}},
        BadValue{"mu_s = 0.748", "mu_s = 0.5", {"contact.0.mu_s = 0.5: less than mu_k = 0.55"}},
        BadValue{"\"compliant\"", "\"coulomb\"", {"contact.0.stiffness = 20000: law \"coulomb\" is rigid"}},
        BadValue{tests::kBeamLaw,
                 "law = \"dahl\"\nmu_s = 0.5\nnormal_load = 1\n",
                 {"contact.0.mu_s = 0.5: law \"dahl\"", "valid: mu"}},
        BadValue{tests::kBeamLaw,
                 "law = \"dahl\"\nmu = 0.5\nstiffness = 0\nnormal_load = 1\n",
                 {"contact.0.stiffness = 0", "a number > 0"}},
        BadValue{tests::kBeamLaw,
                 "law = \"table\"\nmu_s = 0.5\nspeeds = [0, 2, 1]\ncoefficients = [0.4, 0.2, 0.25]\nnormal_load = 1\n",
                 {"contact.0.speeds", "2 m/s before 1", "speeds that ascend"}},
        BadValue{tests::kBeamLaw,
                 "law = \"table\"\nmu_s = 0.3\nspeeds = [0, 2]\ncoefficients = [0.4, 0.2]\nnormal_load = 1\n",
                 {"contact.0.mu_s", "less than the first coefficient", "at least that"}},
        BadValue{
            tests::kBeamLaw,
            "law = \"table\"\nmu_s = 0.5\nmu_k = 0.3\nspeeds = [0, 2]\ncoefficients = [0.4, 0.2]\nnormal_load = 1\n",
            {"contact.0.mu_k = 0.3: law \"table\" slides by its points", "coefficients"}},
        BadValue{tests::kBeamLaw,
                 "law = \"lugre\"\nmu_s = 0.5\nmu_k = 0.0\nnormal_load = 1\n",
                 {"contact.0.mu_k = 0: impossible value with law \"lugre\"", "a number > 0"}},
        BadValue{tests::kBeamLaw,
                 "law = \"lugre\"\nmu_s = 0.5\nmu_k = 0.4\nstribeck_speed = 0\nnormal_load = 1\n",
                 {"contact.0.stribeck_speed = 0", "a number > 0"}},
        BadValue{tests::kBeamLaw,
                 "law = \"dahl\"\nmu = 0.5\nstiffness = 1\nnormal_load = 1\ntilt_deg = 1\n",
                 {"contact.0.tilt_deg = 1: does not go with law \"dahl\"", "\"compliant\""}},
        BadValue{tests::kBeamLaw,
                 "law = \"dahl\"\nmu = 0.5\nstiffness = 1\nnormal_load = { constant = 1, slope = 2 }\n",
                 {"contact.0.normal_load = a table: does not go with law \"dahl\"", "a number"}},
        BadValue{"constant = 0.345", "constant = -1", {"contact.0.normal_load.constant = -1", "a number > 0"}},
        BadValue{"{ constant = 0.345, slope = -1.54 }", "-0.3", {"contact.0.normal_load = -0.3", "a number > 0"}},
        BadValue{", slope = -1.54", "", {"contact.0.normal_load.slope: missing key"}},
        BadValue{"slope = -1.54",
                 "slope = 1, oscillator = {}",
                 {"contact.0.normal_load.slope = 1: an oscillator is given too"}},
        BadValue{"slope = -1.54",
                 "oscillator = { mass = 0 }",
                 {"contact.0.normal_load.oscillator.mass = 0", "a number > 0"}},
        BadValue{"tilt_deg = 0.312", "tilt_deg = 90", {"contact.0.tilt_deg = 90", "between -90 and 90"}},
        BadValue{"tilt_deg = 0.312", "tilt_deg = 40", {"contact.0.tilt_deg = 40", "slides by itself", "valid: mu tan"}},
        BadValue{"tilt_deg = 0.312", "tilt_deg = -65", {"contact.0.tilt_deg = -65", "jams the slider"}}),
    tests::bad_value_name);

INSTANTIATE_TEST_SUITE_P(
    Drive, BadBeam,
    testing::Values(
        BadValue{"kind = \"shaker\"", "kind = \"shakr\"", {"drive.kind = \"shakr\"", "did you mean \"shaker\""}},
        BadValue{"frequency = 12.5", "frequency = 0", {"s.toml:29: drive.frequency = 0", "a number > 0"}},
        BadValue{"phase = 0.25", "speed = 0.2", {"drive.speed = 0.2: belongs to a belt", "frequency and amplitude"}},
        BadValue{tests::kBeamCurve, "-1e-3", {"drive.amplitude = -0.001", "a number >= 0, or a curve"}},
        BadValue{
            tests::kBeamCurve, "{ polynomal = [1] }", {"drive.amplitude.polynomal = [1]: unknown key", "'polynomial'"}},
        BadValue{tests::kBeamCurve, "{ polynomial = [] }", {"drive.amplitude.polynomial = []", "without coefficients"}},
        BadValue{tests::kBeamCurve,
                 "{ polynomial = [1], table = [[1, 1], [2, 2]] }",
                 {"drive.amplitude.table", "another curve", "exactly one of"}},
        BadValue{tests::kBeamCurve,
                 "{ table = [[5, 1e-3]] }",
                 {"drive.amplitude.table = [[5, 0.001]]", "a table of 1 points"}},
        BadValue{tests::kBeamCurve, "{ table = [[5, 1e-3], [4, 1e-3]] }", {"drive.amplitude.table", "4 Hz after 5 Hz"}},
        BadValue{tests::kBeamCurve, "{ table = [[5, 1e-3], [6]] }", {"drive.amplitude.table", "[6] is no pair"}},
        BadValue{tests::kBeamCurve, "{ table = [[5, 1e-3], [6, -1]] }", {"drive.amplitude.table", "a number >= 0"}},
        BadValue{tests::kBeamCurve,
                 "{ exponential = { at = 5, amplitude = 1, decay = 0 } }",
                 {"drive.amplitude.exponential.decay = 0", "a number > 0"}},
        BadValue{tests::kBeamCurve,
                 "{ table = [[5, 1e-3], [12, 1e-3]] }",
                 {"drive.frequency = 12.5", "no value at 12.5 Hz", "from 5 to 12 Hz"}},
        BadValue{tests::kBeamCurve,
                 "{ table = [[5, 1e-3], [40, 1e-3]] }",
                 {"ensemble.frequencies = [12, 41.1]", "no value >= 0 at 41.1 Hz"}},
        BadValue{tests::kBeamCurve,
                 "{ table = [[5, 1e-3], [50, 1e-3]] }",
                 {"s.toml:52: validation.frequencies", "no value >= 0 everywhere from 5 to 60 Hz"}},
        BadValue{tests::kBeamCurve,
                 "{ polynomial = [3e-3, -1.95e-4, 3e-6] }",  // negative between 25 and 40 Hz only
                 {"validation.frequencies", "everywhere from 5 to 60 Hz"}}),
    tests::bad_value_name);

INSTANTIATE_TEST_SUITE_P(
    Runs, BadBeam,
    testing::Values(
        BadValue{"cycles = 20", "cycles = 20\nduration = 1", {"s.toml:34: time.duration = 1", "cycles too"}},
        BadValue{"transient_cycles = 4", "transient_cycles = 20", {"time.transient_cycles = 20: nothing is left"}},
        BadValue{"samples_per_cycle = 16", "samples_per_cycle = 0", {"time.samples_per_cycle = 0", "an integer >= 1"}},
        BadValue{"[ensemble]", "[initial]\nat = \"static\"\n[ensemble]", {"initial.at = \"static\": a shaker has no"}},
        BadValue{"[ensemble]", "[initial]\nvelocity = [1]\n[ensemble]", {"initial.velocity", "an array of 16 values"}},
        BadValue{"spread = 1e-4", "speeds = [1]", {"ensemble.speeds = [1]: belongs to a belt", "valid: frequencies"}},
        BadValue{"x = [0.3, 0.2, 0.05]", "x = [0.3, 0.41]", {"s.toml:43: sensors.x", "x >= 0 and <= 0.4 (its length)"}},
        BadValue{"kind = \"strain\"\nx = [0.3", "kind = \"displacement\"\nx = [0.5", {"sensors.x", "<= 0.464"}},
        BadValue{"kind = \"strain\"\nx = [0.3", "kind = \"displacement\"\nx = [0.0", {"sensors.x", "x > 0"}},
        BadValue{"x = [0.3, 0.2, 0.05]", "x = [0.3, 0.2, 0.3]", {"sensors.x = [0.3, 0.2, 0.3]: two sensors at 0.3"}},
        BadValue{"x = [0.3, 0.2, 0.05]", "x = []", {"sensors.x = []: no sensors"}},
        BadValue{"x = [0.3, 0.2, 0.05]", "", {"sensors.x: missing key"}},
        BadValue{"noise = 0.01", "noise = -1", {"sensors.noise = -1", "a number >= 0"}},
        BadValue{"functions = 3", "functions = 4", {"reduction.functions = 4: more modal functions than 3 sensors"}},
        BadValue{"modes = 2", "modes = 4", {"reduction.modes = 4: more than the 3 modal functions", "1 to 3"}},
        BadValue{"fit = \"polynomial\"", "fit = \"poly\"", {"reduction.fit = \"poly\"", "\"modes\", \"polynomial\""}},
        BadValue{"basis = \"pomf\"", "basis = \"pod\"", {"reduction.basis = \"pod\"", "\"lnm+static\""}},
        BadValue{"[sensors]\nkind = \"strain\"\nx = [0.3, 0.2, 0.05]\nnoise = 0.01\nseed = 3\n",
                 "",
                 {"reduction.basis = \"pomf\": modal functions are made from sensors", "add [sensors]"}},
        BadValue{"frequencies = { from = 5.0", "frequencies = { from = 0.0", {"validation.frequencies.from = 0"}},
        BadValue{"kept = 50", "kept = 61", {"validation.kept = 61: more than are run", "at most cycles = 60"}},
        BadValue{"gauge = 0.1", "gauge = 0.41", {"validation.gauge = 0.41", "<= 0.4 (its length)"}},
        BadValue{"modes = [1, 2]", "modes = [17]", {"validation.modes = [17]", "an integer from 1 to 16"}},
        BadValue{"\"lnm+static\"]", "\"pomf\"]", {"validation.bases", "\"pomf\" twice"}},
        BadValue{"[\"pomf\", \"lnm+static\"]", "[]", {"validation.bases = []: empty", "one or more of"}},
        BadValue{"follow = \"both\"", "follow = \"back\"", {"validation.follow = \"back\"", "\"none\""}},
        BadValue{"follow = \"both\"", "segments = 3", {"validation.segments = 3: belongs to a belt"}},
        BadValue{"follow = \"both\"", "orbits = [1]", {"validation.orbits = [1]: belongs to a belt"}}),
    tests::bad_value_name);

INSTANTIATE_TEST_SUITE_P(
    Belt, BadBelt,
    testing::Values(
        BadValue{"speed = 0.2", "speed = 0.2\nfrequency = 3", {"drive.frequency = 3: belongs to a shaker", "speed"}},
        BadValue{"duration = 3", "cycles = 3", {"time.cycles = 3: counts a shaker's cycles", "valid: duration"}},
        BadValue{"[time]", "[ensemble]\nfrequencies = [1]\n[time]", {"ensemble.frequencies", "a shaker", "speeds"}},
        BadValue{"[time]", "[validation]\nkept = 1\n[time]", {"validation.kept = 1: belongs to a shaker"}},
        BadValue{"[time]", "[reduction]\nfunctions = 1\n[time]", {"reduction.functions = 1", "add [sensors]"}}),
    tests::bad_value_name);

TEST(BadBeamScene, ChainsHaveNoSensorsAndNoBeamBases) {
  const std::string chain = "units = \"SI\"\n[structure]\nkind = \"chain\"\nmasses = 3\n" +
                            kBeamOnBelt.substr(kBeamOnBelt.find("[[contact]]"));
  const std::string on_mass = replaced(chain, "at = \"tip\"", "at = 3");
  EXPECT_EQ(error_of(on_mass), "no InvalidInput");
  expect_parts(error_of(chain), {"contact.0.at = \"tip\": wrong type", "an integer from 1 to 3"});
  expect_parts(error_of(on_mass + "[sensors]\nx = [1]\n"), {"sensors = a table: sensors are for beams"});
  expect_parts(error_of(on_mass + "[reduction]\nbasis = \"pomf\"\n"),
               {"reduction.basis = \"pomf\"", "\"pom\", \"lnm\""});
}

TEST(BadBeamScene, OverridesAreNamedInsteadOfTheLine) {
  expect_parts(error_of(kBeamScene, {"drive.amplitude.exponential.decay=0"}),
               {"s.toml: override drive.amplitude.exponential.decay=0", "a number > 0"});
  expect_parts(error_of(kBeamScene, {"contact.0.stiffness=0"}), {"override contact.0.stiffness=0", "a number > 0"});
}

TEST(BadBeamScene, WhatNeedsABeamOrSensorsSaysSo) {
  const scene::Scene chain = scene::load_scene(SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml");
  expect_parts(message_of([&] { (void)build_beam(chain); }), {"chain10/scene.toml", "structure.kind", "valid"});
  expect_parts(message_of([&] { (void)gauge_position(chain); }), {"chain10/scene.toml", "structure.kind"});
  const scene::Scene belt = scene::parse_scene(kBeamOnBelt, {}, "s.toml");
  expect_parts(message_of([&] { (void)sensor_noise(belt); }), {"s.toml", "sensors", "add [sensors]"});
  // The stretch of a soft beam under a large slope leaves the slider: no sliding equilibrium with contact.
  const scene::Scene steep = scene::parse_scene(kBeamOnBelt, {"contact.0.normal_load.slope=1000.0"}, "s.toml");
  expect_parts(message_of([&] { (void)initial_state(steep, build_system(steep)); }),
               {"s.toml: initial.at = \"static\"", "contact 1", "N; valid: \"rest\""});
}

}  // namespace
