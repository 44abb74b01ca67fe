// Reruns every dataset that ships and compares with its expected.toml.

#include "diagnostics/ensemble_run.hpp"
#include "diagnostics/lyapunov.hpp"
#include "diagnostics/settle.hpp"
#include "dynamics/simulate.hpp"
#include "pod/pod.hpp"
#include "scene/scene.hpp"
#include "scene/toml_reader.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace slipmode;
using scene::Scene;

struct Expectation {
  std::string dataset;
  std::string measure;
  double speed = 0.0;
  std::vector<int> modes;
  std::vector<double> value, tolerance;
  std::string origin;
};

std::filesystem::path folder_of(const std::string& dataset) {
  return std::filesystem::path(SLIPMODE_SOURCE_DIR) / "datasets" / dataset;
}

Expectation read_expectation(scene::TomlReader& in, const std::string& dataset, double own_speed) {
  Expectation e;
  e.dataset = dataset;
  e.measure = in.text_or("measure", "");
  e.speed = in.number_or("speed", own_speed, scene::kFinite);
  e.modes = in.integers_or("modes", {}, 1, 1'000'000);
  e.value = in.numbers_or("value", {}, scene::kFinite);
  e.tolerance = in.numbers_or("tolerance", {}, scene::kPositive, static_cast<std::int64_t>(e.value.size()));
  e.origin = in.text_or("origin", "");
  (void)in.text_or("units", "");
  in.finish();
  return e;
}

std::vector<Expectation> all_expectations() {
  std::vector<Expectation> found;
  for (const auto& entry : std::filesystem::directory_iterator(SLIPMODE_SOURCE_DIR "/datasets")) {
    const auto path = entry.path() / "expected.toml";
    if (!std::filesystem::exists(path)) continue;
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    const scene::TomlDocument document(text.str(), path.string(), {});
    scene::TomlReader in(document);
    const double own_speed = scene::load_scene(entry.path() / "scene.toml").drive.velocity(0.0);
    for (scene::TomlReader& item : in.tables("expect")) {
      found.push_back(read_expectation(item, entry.path().filename(), own_speed));
    }
  }
  return found;
}

/// One scene at one speed, with what its measures are computed from.
struct Case {
  Scene scene;
  dynamics::HybridSystem system;
  dynamics::State start;
  std::vector<int> modes;
};

Case make_case(const Expectation& e) {
  Scene s = scene::load_scene(folder_of(e.dataset) / "scene.toml");
  s = set_key(s, "drive.speed", e.speed);
  dynamics::HybridSystem system = build_system(s);
  dynamics::State start = initial_state(s, system);
  return {std::move(s), std::move(system), std::move(start), e.modes};
}

diagnostics::EnsembleRun run_ensemble(const Case& c) {
  const diagnostics::Model model = diagnostics::belt_model(c.system);
  return diagnostics::run_ensemble(model, {c.scene.drive.velocity(0.0)}, ensemble_states(c.scene, c.system),
                                   {.duration = c.scene.time.duration,
                                    .transient = c.scene.time.transient,
                                    .sample = c.scene.time.sample,
                                    .flow = c.scene.flow});
}

std::vector<double> energy_share_cumulative(const Case& c) {
  const pod::PodResult result = pod::pod(run_ensemble(c).ensemble);
  std::vector<double> shares;
  for (const int modes : c.modes) shares.push_back(100.0 * result.shares.head(modes).sum());
  return shares;
}

std::vector<double> mean_displacement_per_mass(const Case& c) {
  const Eigen::VectorXd mean = run_ensemble(c).ensemble.snapshots.rowwise().mean();
  const Eigen::VectorXd number = Eigen::VectorXd::LinSpaced(mean.size(), 1.0, static_cast<double>(mean.size()));
  return {number.dot(mean) / number.squaredNorm()};
}

diagnostics::Orbit orbit_of(const Case& c) {
  diagnostics::SettleOptions options;
  options.period.tolerance = 1e-9;
  options.flow = c.scene.flow;
  return diagnostics::settle_to_orbit(c.system, c.start, options);
}

std::vector<double> orbit_period(const Case& c) { return {orbit_of(c).T}; }

std::vector<double> orbit_slip_states(const Case& c) {
  std::vector<double> states = orbit_of(c).displacements;
  std::ranges::sort(states);
  return states;
}

std::vector<double> largest_exponent(const Case& c) {
  diagnostics::LyapunovOptions options;
  options.transient = c.scene.time.transient;
  options.duration = 200000.0;
  options.flow = c.scene.flow;
  return {diagnostics::largest_exponent(c.system, c.start, options).bits};
}

/// A record long enough for rates and extremes, densely sampled at the contacts.
dynamics::Trajectory contact_record(const Case& c) {
  return dynamics::simulate(c.system, c.start,
                            {.duration = c.scene.time.transient + 50000.0,
                             .transient = c.scene.time.transient,
                             .sample = 0.05,
                             .output = dynamics::SimulateOptions::Output::kContacts,
                             .flow = c.scene.flow});
}

std::vector<double> slip_rate(const Case& c) {
  const dynamics::Trajectory run = contact_record(c);
  const auto slips = std::ranges::count(run.events, dynamics::EventKind::kRelease, &dynamics::Event::kind);
  return {static_cast<double>(slips) / 50000.0};
}

/// Samples in stick are those between an event that starts a stick and the next event; the ends come from the events.
std::vector<double> stick_force_range(const Case& c) {
  const dynamics::Trajectory run = contact_record(c);
  double low = INFINITY, high = -INFINITY;
  Eigen::Index k = 0;
  for (std::size_t i = 0; i + 1 < run.events.size(); ++i) {
    if (run.events[i].after != dynamics::ContactMode::kStick) continue;
    while (k < run.times.size() && run.times(k) <= run.events[i].time) ++k;
    for (; k < run.times.size() && run.times(k) < run.events[i + 1].time; ++k) {
      low = std::min(low, run.lambda(0, k));
      high = std::max(high, run.lambda(0, k));
    }
    if (run.events[i + 1].kind == dynamics::EventKind::kRelease) high = std::max(high, run.events[i + 1].force);
  }
  return {low, high};
}

std::vector<double> driven_velocity_range(const Case& c) {
  const dynamics::Trajectory run = contact_record(c);
  return {run.contact_v.row(0).minCoeff(), run.contact_v.row(0).maxCoeff()};
}

const std::map<std::string, std::function<std::vector<double>(const Case&)>>& measures() {
  static const std::map<std::string, std::function<std::vector<double>(const Case&)>> table = {
      {"energy_share_cumulative", energy_share_cumulative},
      {"orbit_period", orbit_period},
      {"orbit_slip_states", orbit_slip_states},
      {"largest_exponent", largest_exponent},
      {"slip_rate", slip_rate},
      {"stick_force_range", stick_force_range},
      {"driven_velocity_range", driven_velocity_range},
      {"mean_displacement_per_mass", mean_displacement_per_mass}};
  return table;
}

class Dataset : public testing::TestWithParam<Expectation> {};

TEST_P(Dataset, GivesWhatIsExpected) {
  const Expectation& e = GetParam();
  ASSERT_TRUE(measures().contains(e.measure)) << e.measure;
  ASSERT_FALSE(e.value.empty());
  EXPECT_FALSE(e.origin.empty()) << "an expected value without an origin proves nothing";
  const std::vector<double> found = measures().at(e.measure)(make_case(e));
  ASSERT_EQ(found.size(), e.value.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i], e.value[i], e.tolerance[i]) << e.dataset << " " << e.measure << " at speed " << e.speed;
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, Dataset, testing::ValuesIn(all_expectations()), [](const auto& instance) {
  std::string name = instance.param.dataset + "_" + instance.param.measure + "_" + std::to_string(instance.index);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

}  // namespace
