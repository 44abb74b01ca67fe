// Scenes of shaken beams: what is read, written, built. Their error messages: beam_scene_errors_test.cpp.

#include "scene/beam_scene.hpp"
#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/scene/scene.hpp>
#include "fixtures/test_names.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace {

using namespace slipmode;
using scene::parse_scene;
using scene::Scene;
using tests::kBeamScene;
using tests::replaced;

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(BeamScene, ReadsEveryValue) {
  const Scene s = parse_scene(kBeamScene);
  const fem::BeamOptions& beam = *s.beam();
  ASSERT_EQ(beam.spans.size(), 1U);
  EXPECT_EQ(beam.theory, fem::BeamTheory::kEulerBernoulli);
  EXPECT_EQ(beam.spans[0].length, 0.4);
  EXPECT_EQ(beam.spans[0].width, 0.0128);
  EXPECT_EQ(beam.spans[0].thickness, 0.00086);
  EXPECT_EQ(beam.spans[0].youngs_modulus, 128e9);
  EXPECT_EQ(beam.spans[0].density, 7488.0);
  EXPECT_EQ(beam.spans[0].elements, 8);
  EXPECT_EQ(beam.tip.mass, 0.015);
  EXPECT_EQ(beam.tip.extension, 0.064);
  EXPECT_EQ(std::get<fem::ModalRatios>(beam.damping).ratios, (std::vector<double>{0.01}));
  EXPECT_EQ(s.size(), 16);

  EXPECT_TRUE(std::holds_alternative<scene::AtTip>(s.contacts[0].at));
  const auto& law = std::get<friction::CompliantCoulomb>(s.contacts[0].law);
  EXPECT_EQ(law.mu_s, 0.748);
  EXPECT_EQ(law.mu_k, 0.55);
  EXPECT_EQ(law.stiffness, 20e3);
  EXPECT_EQ(s.contacts[0].normal_load.constant, 0.345);
  EXPECT_EQ(s.contacts[0].normal_load.slope, -1.54);
  EXPECT_EQ(s.contacts[0].tilt_deg, 0.312);

  EXPECT_EQ(s.drive.shaker()->frequency_hz, 12.5);
  EXPECT_EQ(s.drive.shaker()->phase, 0.25);
  EXPECT_DOUBLE_EQ(s.drive.shaker()->amplitude, 3e-3 * std::exp(-7.5 / 20.0));
  EXPECT_DOUBLE_EQ(s.time.duration, 20.0 / 12.5);
  EXPECT_DOUBLE_EQ(s.time.transient, 4.0 / 12.5);
  EXPECT_DOUBLE_EQ(s.time.sample, 1.0 / (12.5 * 16.0));
  EXPECT_EQ(s.ensemble.frequencies, (std::vector<double>{12.0, 41.1}));
  EXPECT_EQ(s.sensors->x, (std::vector<double>{0.3, 0.2, 0.05}));
  EXPECT_EQ(s.sensors->kind, pod::SensorKind::kStrain);
  EXPECT_EQ(s.sensors->noise, 0.01);
  EXPECT_EQ(s.sensors->seed, 3U);
  EXPECT_EQ(s.reduction.basis, scene::BasisChoice::kPomf);
  EXPECT_EQ(s.reduction.fit, pod::FitFamily::kPolynomials);
  EXPECT_EQ(s.reduction.functions, 3);
  EXPECT_EQ(s.reduction.choice.modes, 2);
  EXPECT_EQ(s.driven.frequencies->values().size(), 551U);  // 5 to 60 by 0.1
  EXPECT_EQ(s.driven.bases, (std::vector{scene::BasisChoice::kPomf, scene::BasisChoice::kLnmStatic}));
  EXPECT_EQ(s.driven.follow, scene::DrivenValidationSpec::Follow::kBoth);
  EXPECT_EQ(s.driven.kept, 50.0);
}

/// Every way of saying a thing, each with a part of the text it must be written back as.
struct Variant {
  std::string from, to, written;
};

void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.written; }

class BeamVariants : public testing::TestWithParam<Variant> {};

TEST_P(BeamVariants, AreWrittenAndReadBackToTheSameBytes) {
  const std::string text = scene_to_toml(parse_scene(replaced(kBeamScene, GetParam().from, GetParam().to)));
  EXPECT_NE(text.find(GetParam().written), std::string::npos) << text;
  EXPECT_EQ(scene_to_toml(parse_scene(text)), text);
}

const std::string kSpan =
    "length = 0.4\nwidth = 0.0128\nthickness = 0.00086\nyoungs_modulus = 128e9\ndensity = 7488\n"
    "elements = 8\n";
const std::string kTime = "cycles = 20\ntransient_cycles = 4\nsamples_per_cycle = 16\n";

INSTANTIATE_TEST_SUITE_P(
    Written, BeamVariants,
    testing::Values(
        Variant{"title", "title", "at = \"tip\""}, Variant{"at = \"tip\"", "at = 0.35", "at = 0.35\n"},
        Variant{"\"euler-bernoulli\"", "\"timoshenko\"\npoisson_ratio = 0.25", "poisson_ratio = 0.25\nshear_coefficie"},
        Variant{kSpan, "[[structure.span]]\n" + kSpan + "[[structure.span]]\n" + replaced(kSpan, "0.4", "0.1"),
                "[[structure.span]]\nlength = 0.1\n"},
        Variant{"modal_ratio = 0.01", "modal_ratio = [0.01, 0.02]", "modal_ratio = [0.01, 0.02]"},
        Variant{"modal_ratio = 0.01", "ratio = 0.01\nfrequency = 3", "ratio = 0.01\nfrequency = 3.0"},
        Variant{"modal_ratio = 0.01", "ratio = [0.01, 0.02]\nfrequency = [3, 50]", "frequency = [3.0, 50.0]"},
        Variant{"modal_ratio = 0.01", "coefficient = 1e-5", "coefficient = 1e-05\nmass_coefficient = 0.0"},
        Variant{"[structure.damping]\nmodal_ratio = 0.01\n", "", "coefficient = 0.0\nmass_coefficient = 0.0"},
        Variant{tests::kBeamLaw, "law = \"dahl\"\nmu = 0.5\nstiffness = 1e4\nnormal_load = 0.3\n",
                "mu = 0.5\nstiffness = 10000"},
        Variant{tests::kBeamLaw,
                "law = \"lugre\"\nmu_s = 0.5\nmu_k = 0.4\nstribeck_speed = 0.1\nstiffness = 1e4\ndamping = 0.2\n"
                "viscous = 0.3\nnormal_load = 0.3\n",
                "stribeck_speed = 0.1\nstiffness = 10000.0\ndamping = 0.2\nviscous = 0.3\n"},
        Variant{
            tests::kBeamLaw,
            "law = \"table\"\nmu_s = 0.5\nspeeds = [0, 0.05, 1]\ncoefficients = [0.4, 0.2, 0.25]\nnormal_load = 0.3\n",
            "mu_s = 0.5\nspeeds = [0.0, 0.05, 1.0]\ncoefficients = [0.4, 0.2, 0.25]\n"},
        Variant{"slope = -1.54 }",
                "oscillator = { mass = 0.02, support_stiffness = 90.0, spring_stiffness = 282.8, slope = -5e-3 } }",
                "oscillator = { mass = 0.02, support_stiffness = 90.0, support_damping = 0.0, spring_stiffness"},
        Variant{tests::kBeamCurve, "2e-3", "amplitude = 0.002\n"},
        Variant{tests::kBeamCurve, "{ polynomial = [1e-3, 2e-5] }", "{ polynomial = [0.001, 2e-05] }"},
        Variant{tests::kBeamCurve, "{ table = [[5, 3e-3], [60, 1e-3]] }", "{ table = [[5.0, 0.003], [60.0, 0.001]] }"},
        Variant{kTime, "duration = 3\nsample = 0.01\n", "duration = 3.0\ntransient = 0.0\nsample = 0.01"},
        Variant{"gauge = 0.1\n", "", "kept = 50.0\nmodes = [1, 2]"},
        Variant{"frequencies = { from = 5.0, to = 60.0, step = 0.1 }\n", "", "[validation]\ncycles = 60.0"},
        Variant{"kind = \"strain\"", "kind = \"displacement\"", "kind = \"displacement\""}),
    [](const auto& one) { return fixtures::numbered_name(one.index, one.param.written); });

TEST(BeamScene, ABeamCanLieOnABelt) {
  const Scene s = parse_scene(tests::kBeamOnBelt);
  EXPECT_EQ(s.validation.speeds.step, 0.001);
  EXPECT_EQ(scene_to_toml(parse_scene(scene_to_toml(s))), scene_to_toml(s));
}

/// Every numeric key of a written scene, dotted.
TEST(BeamScene, EveryNumericKeyCanBeReadAndSet) {
  const std::vector<std::string> keys = {"structure.length",
                                         "structure.width",
                                         "structure.thickness",
                                         "structure.youngs_modulus",
                                         "structure.density",
                                         "structure.elements",
                                         "structure.tip.mass",
                                         "structure.tip.inertia",
                                         "structure.tip.offset",
                                         "structure.tip.extension",
                                         "structure.damping.modal_ratio",
                                         "contact.0.mu_s",
                                         "contact.0.mu_k",
                                         "contact.0.stiffness",
                                         "contact.0.normal_load.constant",
                                         "contact.0.normal_load.slope",
                                         "contact.0.tilt_deg",
                                         "drive.frequency",
                                         "drive.phase",
                                         "drive.amplitude.exponential.at",
                                         "drive.amplitude.exponential.amplitude",
                                         "drive.amplitude.exponential.decay",
                                         "time.cycles",
                                         "time.transient_cycles",
                                         "time.samples_per_cycle",
                                         "ensemble.members",
                                         "ensemble.seed",
                                         "ensemble.spread",
                                         "ensemble.frequencies.1",
                                         "sensors.x.2",
                                         "sensors.noise",
                                         "sensors.seed",
                                         "reduction.modes",
                                         "reduction.functions",
                                         "validation.frequencies.from",
                                         "validation.frequencies.to",
                                         "validation.frequencies.step",
                                         "validation.cycles",
                                         "validation.kept",
                                         "validation.gauge",
                                         "validation.modes.0",
                                         "validation.period_tolerance",
                                         "validation.max_period",
                                         "validation.cost_cycles",
                                         "validation.cost_repeats",
                                         "flow.tolerance"};
  const Scene s = parse_scene(kBeamScene);
  for (const std::string& key : keys) {
    SCOPED_TRACE(key);
    const double before = get_key(s, key);
    // A change that keeps whole numbers whole and stays within every limit of this scene.
    const bool whole = before == std::round(before) && before != 0.0;
    const bool limited = key == "reduction.modes" || key == "reduction.functions" || key == "contact.0.mu_k";
    const double after = limited ? before : whole ? before + 1.0 : before * 0.97 + 1e-9;
    const Scene t = set_key(s, key, after);
    EXPECT_EQ(get_key(t, key), after);
    EXPECT_EQ(scene_to_toml(parse_scene(t.source.text, t.source.overrides)), scene_to_toml(t));
  }
}

// Expected: SI units of what each key is, by hand; the shaker's amplitude is a way, a force's would be a force.
TEST(BeamScene, KeysHaveTheUnitsOfTheirFields) {
  const Scene scene = parse_scene(kBeamScene);
  ASSERT_EQ(scene.units, "SI");
  for (const auto& [key, unit] :
       std::vector<std::pair<std::string, std::string>>{{"structure.length", "m"},
                                                        {"structure.density", "kg/m^3"},
                                                        {"structure.tip.mass", "kg"},
                                                        {"structure.damping.modal_ratio", "1"},
                                                        {"contact.0.mu_s", "1"},
                                                        {"contact.0.stiffness", "N/m"},
                                                        {"contact.0.normal_load", "N"},
                                                        {"contact.0.normal_load.constant", "N"},
                                                        {"contact.0.normal_load.slope", "N/m"},
                                                        {"contact.0.tilt_deg", "degrees"},
                                                        {"drive.frequency", "Hz"},
                                                        {"drive.amplitude", "m"},
                                                        {"drive.amplitude.exponential.decay", "Hz"}})
    EXPECT_EQ(unit_of_key(scene, key), unit) << key;
  EXPECT_EQ(unit_of_key(parse_scene(tests::kBeamOnBelt), "drive.speed"), "m/s");
}

TEST(BeamScene, KeysOfOtherLawsLoadsCurvesAndDampingsCanBeSet) {
  const auto sets = [](const std::string& text, const std::string& key, double value) {
    SCOPED_TRACE(key);
    EXPECT_EQ(get_key(set_key(parse_scene(text), key, value), key), value);
  };
  sets(replaced(kBeamScene, tests::kBeamCurve, "{ table = [[5, 3e-3], [60, 1e-3]] }"), "drive.amplitude.table.1.1",
       2e-3);
  sets(replaced(kBeamScene, tests::kBeamCurve, "{ polynomial = [1e-3, 2e-5] }"), "drive.amplitude.polynomial.1", 3e-5);
  sets(kBeamScene, "drive.amplitude", 2e-3);  // a number takes the curve's place
  sets(kBeamScene, "contact.0.normal_load", 0.5);
  sets(replaced(kBeamScene, "modal_ratio = 0.01", "ratio = [0.01, 0.02]\nfrequency = [3, 50]"),
       "structure.damping.ratio.1", 0.015);
  sets(replaced(kBeamScene, "modal_ratio = 0.01", "coefficient = 1e-5"), "structure.damping.mass_coefficient", 0.1);
  sets(replaced(kBeamScene, "slope = -1.54 }",
                "oscillator = { mass = 0.02, support_stiffness = 90.0, spring_stiffness = 282.8, slope = -5e-3 } }"),
       "contact.0.normal_load.oscillator.spring_damping", 0.02);
}

TEST(BeamScene, AnotherFrequencyBringsItsAmplitudeAndItsTime) {
  const Scene s = parse_scene(kBeamScene);
  const Scene t = set_key(s, "drive.frequency", 25.0);
  EXPECT_DOUBLE_EQ(t.drive.shaker()->amplitude, 3e-3 / std::exp(1.0));
  EXPECT_DOUBLE_EQ(t.time.duration, 20.0 / 25.0);
  // drive_at and time_at say the same without reading the scene again.
  EXPECT_EQ(drive_at(s, 25.0).shaker()->amplitude, t.drive.shaker()->amplitude);
  EXPECT_EQ(drive_at(s, 25.0).shaker()->phase, 0.25);
  EXPECT_EQ(time_at(s, 25.0).duration, t.time.duration);
  EXPECT_EQ(time_at(s, 25.0).sample, t.time.sample);
  EXPECT_EQ(drive_parameter(s), 12.5);
}

TEST(BeamScene, SystemIsTheBeamWithItsContactAtTheEndOfTheExtension) {
  const Scene s = parse_scene(kBeamScene);
  const fem::Beam beam = build_beam(s);
  const auto system = build_system(s, beam);
  EXPECT_EQ(system.size(), 16);
  // y(L) + l y'(L), S4 (6.6) corrected
  Eigen::VectorXd w = Eigen::VectorXd::Zero(16);
  w(14) = 1.0;
  w(15) = 0.064;
  EXPECT_LT((system.contacts()[0].direction - w).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_DOUBLE_EQ(system.contacts()[0].tilt, 0.312 * kDegree);
  EXPECT_EQ(system.structure().units(), "SI");
  EXPECT_EQ(fem::to_dense(build_system(s).structure().K()), fem::to_dense(beam.structure().K()));
  // A static force P there bends the beam by its force and by its moment P l: y + l y' = P (L³/3 + L²l + L l²)/EI,
  // exact with Hermite elements.
  const double L = 0.4, l = 0.064, EI = 128e9 * 0.0128 * std::pow(0.00086, 3) / 12.0;
  const Eigen::VectorXd q = fem::to_dense(system.structure().K()).ldlt().solve(w);
  EXPECT_NEAR(w.dot(q) * EI / (L * L * L / 3.0 + L * L * l + L * l * l), 1.0, 1e-10);
}

TEST(BeamScene, SensorsReadTheirPlaces) {
  const Scene s = parse_scene(kBeamScene);
  const fem::Beam beam = build_beam(s);
  const pod::SensorArray sensors = sensor_array(s, beam);
  ASSERT_EQ(sensors.size(), 3);
  EXPECT_EQ(sensors.rows().row(1).transpose(), beam.strain_row(0.2));
  EXPECT_EQ(sensor_noise(s).deviation, 0.01);
  EXPECT_EQ(sensor_noise(s).seed, 3U);
  EXPECT_EQ(gauge_position(s), 0.1);
  EXPECT_DOUBLE_EQ(gauge_position(parse_scene(replaced(kBeamScene, "gauge = 0.1\n", ""))), 0.05);
}

TEST(BeamScene, SpreadOfABeamIsOneOfItsLowestModes) {
  const Scene s = parse_scene(kBeamScene, {"ensemble.members=400", "ensemble.spread=1e-3"});
  const auto system = build_system(s);
  const auto states = ensemble_states(s, system);
  Eigen::MatrixXd q(16, 400), v(16, 400);
  for (Eigen::Index k = 0; k < 400; ++k) {
    q.col(k) = states[static_cast<std::size_t>(k)].q;
    v.col(k) = states[static_cast<std::size_t>(k)].v;
  }
  const fem::Modes modes = fem::natural_modes(system.structure());
  const Eigen::MatrixXd amplitudes = modes.shapes.transpose() * fem::multiply(system.structure().M(), q);
  const Eigen::VectorXd rms = (amplitudes.rowwise().squaredNorm() / 400.0).cwiseSqrt();
  for (Eigen::Index k = 0; k < 16; ++k) {
    const double largest = modes.shapes(Eigen::seq(0, 15, 2), k).cwiseAbs().maxCoeff();
    // Standard deviation 1e-3 of the largest displacement; five standard errors of 400 samples.
    if (k < 6) {
      EXPECT_NEAR(rms(k) * largest, 1e-3, 5e-3 / std::sqrt(800.0)) << k;
    } else {
      EXPECT_LT(rms(k) * largest, 1e-12) << k;
    }
  }
  EXPECT_GT(v.norm(), 0.0);
  const auto calm = ensemble_states(parse_scene(kBeamScene, {"ensemble.spread=0.0"}), system);
  EXPECT_EQ(calm[1].q, Eigen::VectorXd::Zero(16));
}

TEST(BeamScene, StaticStartOnABeltHoldsTheSlidingForce) {
  // Sliding along +w: the load, which depends on where the contact is, times the tilted slider's coefficient.
  const Scene s = parse_scene(tests::kBeamOnBelt);
  const auto system = build_system(s);
  const auto state = initial_state(s, system);
  const friction::Contact& contact = system.contacts()[0];
  const double y = contact.direction.dot(state.q);
  const double mu = (0.55 * std::cos(contact.tilt) + std::sin(contact.tilt)) /
                    (std::cos(contact.tilt) - 0.55 * std::sin(contact.tilt));
  const double force = mu * (0.345 - 1.54 * y);
  const Eigen::VectorXd pull = fem::multiply(system.structure().K(), state.q);
  EXPECT_LT((pull - force * contact.direction).norm(), 1e-9 * force);
  ASSERT_EQ(state.internal.size(), 1);
  EXPECT_NEAR(state.internal(0), force / 20e3, 1e-12 * force / 20e3);  // stretch of the contact spring
}

TEST(BeamScene, StaticStartOfANormalOscillatorIsItsEquilibrium) {
  const Scene s = parse_scene(replaced(tests::kBeamOnBelt, "slope = -1.54 }",
                                       "oscillator = { mass = 0.02, support_stiffness = 90.0, spring_stiffness = "
                                       "282.8, slope = -5e-3 } }"));
  const auto system = build_system(s);
  const auto state = initial_state(s, system);
  ASSERT_EQ(state.internal.size(), 3);
  const double y = system.contacts()[0].direction.dot(state.q), z = state.internal(1);
  EXPECT_NEAR((90.0 + 282.8) * z, 282.8 * -5e-3 * y, 1e-15);  // of the equation in friction/contact.hpp, at rest
  EXPECT_EQ(state.internal(2), 0.0);
  const double normal = 0.345 + 282.8 * (-5e-3 * y - z);
  const double mu = friction::effective_coefficient(0.55, 0.312 * kDegree, 1.0);
  EXPECT_NEAR(state.internal(0) * 20e3, mu * normal, 1e-12);
}

}  // namespace
