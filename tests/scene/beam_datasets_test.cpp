// Reruns the shipped beam and compares with its expected.toml.

#include <slipmode/diagnostics/attractors/driven.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/modal_fit.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/expected_numbers.hpp"
#include "scene/internal/toml_reader.hpp"

#include <gtest/gtest.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

namespace {

using namespace slipmode;

const std::filesystem::path kFolder = std::filesystem::path(SLIPMODE_SOURCE_DIR) / "datasets" / "beam_12hz";

struct BeamExpectation {
  std::vector<double> value, tolerance, frequencies;
};

/// The measures of the file, each with its origin said.
std::map<std::string, BeamExpectation> expectations() {
  std::ostringstream text;
  text << std::ifstream(kFolder / "expected.toml").rdbuf();
  const scene::TomlDocument document(text.str(), (kFolder / "expected.toml").string(), {});
  scene::TomlReader in(document);
  std::map<std::string, BeamExpectation> found;
  for (scene::TomlReader& item : in.tables("driven")) {
    BeamExpectation e;
    e.value = tests::numbers_if_any(item, "value", kFinite);
    e.tolerance = tests::numbers_if_any(item, "tolerance", kPositive);
    e.frequencies = tests::numbers_if_any(item, "frequencies", kPositive);
    EXPECT_FALSE(item.text_or("origin", "").empty());
    (void)item.text_or("units", "");
    found[item.text_or("measure", "")] = e;
    item.finish();
  }
  return found;
}

diagnostics::DrivenMotion motion_at(const scene::Scene& scene, const fem::Beam& beam,
                                    const dynamics::HybridSystem& system, double frequency) {
  const diagnostics::Readings strain{beam.strain_row(0.05).transpose(), {}};
  return diagnostics::settle_driven(system.with_drive(drive_at(scene, frequency)), strain, system.rest(),
                                    {.cycles = 600, .kept = 100});
}

TEST(BeamDataset, FrequenciesAreThoseOfTheTranscendentalEquation) {
  const BeamExpectation e = expectations().at("slipping_hz");
  const fem::Beam beam = build_beam(scene::load_scene(kFolder / "scene.toml"));
  const fem::Modes modes = fem::natural_modes(beam.structure(), static_cast<Eigen::Index>(e.value.size()));
  for (std::size_t k = 0; k < e.value.size(); ++k)
    EXPECT_NEAR(modes.omega(static_cast<Eigen::Index>(k)) / (2.0 * std::numbers::pi), e.value[k], e.tolerance[k]);
}

TEST(BeamDataset, GaugesSeeTheSharesOfTheExperiment) {
  const BeamExpectation e = expectations().at("gauge_energy_shares");
  scene::Scene scene = scene::load_scene(kFolder / "scene.toml", {"ensemble.members=1"});
  const fem::Beam beam = build_beam(scene);
  const dynamics::HybridSystem system = build_system(scene, beam);
  const pod::SensorArray gauges = sensor_array(scene, beam);
  const dynamics::Trajectory run =
      dynamics::simulate(system, ensemble_states(scene, system).front(), simulate_options(scene));
  EXPECT_LT(std::abs(run.audit.residual()), 1e-9);
  std::vector<double> places;
  for (const pod::Sensor& sensor : gauges.sensors()) places.push_back(sensor.x);
  const pod::ModalFit fit(gauges, pod::natural_functions(beam, 6));
  const pod::SensorArray displacements(beam, pod::sensors_at(pod::SensorKind::kDisplacement, places));
  const pod::PodResult result = pod::pod(pod::converted({gauges.readings(run.q)}, fit, displacements));
  for (std::size_t k = 0; k < e.value.size(); ++k)
    EXPECT_NEAR(result.shares(static_cast<Eigen::Index>(k)), e.value[k], e.tolerance[k]);
}

TEST(BeamDataset, SticksAndSlipsWhereTheSourceSaysAndBalancesItsEnergy) {
  const std::map<std::string, BeamExpectation> all = expectations();
  const scene::Scene scene = scene::load_scene(kFolder / "scene.toml");
  const fem::Beam beam = build_beam(scene);
  const dynamics::HybridSystem system = build_system(scene, beam);
  for (const std::string label : {"stick", "stick-slip"})
    for (const double frequency : all.at(label + "_at").frequencies)
      EXPECT_EQ(to_string(motion_at(scene, beam, system, frequency).label), label) << frequency << " Hz";
  const BeamExpectation& audit = all.at("audit");
  for (const double frequency : audit.frequencies)
    EXPECT_LT(std::abs(motion_at(scene, beam, system, frequency).audit_residual), audit.tolerance.front())
        << frequency << " Hz";
}

}  // namespace
