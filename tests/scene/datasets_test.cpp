// Reruns every dataset that ships and compares with its expected.toml.

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/diagnostics/attractors/settle.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/scene/scene.hpp>
#include "fixtures/test_names.hpp"
#include "scene/expected_numbers.hpp"
#include "scene/internal/toml_reader.hpp"

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
  std::vector<double> displacement, velocity;  // where the run starts; empty: as the scene says
  std::string origin;
};

std::filesystem::path folder_of(const std::string& dataset) {
  return std::filesystem::path(SLIPMODE_SOURCE_DIR) / "datasets" / dataset;
}

Expectation read_expectation(scene::TomlReader& in, const std::string& dataset, double own_speed) {
  Expectation e;
  e.dataset = dataset;
  e.measure = in.text_or("measure", "");
  e.speed = in.number_or("speed", own_speed, kFinite);
  if (in.has("modes")) e.modes = in.integers("modes", {.low = 1.0, .high = 1e6});
  e.value = tests::numbers_if_any(in, "value", kFinite);
  e.tolerance = tests::numbers_if_any(in, "tolerance", kPositive, static_cast<std::int64_t>(e.value.size()));
  e.displacement = tests::numbers_if_any(in, "displacement", kFinite);
  e.velocity = tests::numbers_if_any(in, "velocity", kFinite, static_cast<std::int64_t>(e.displacement.size()));
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
    if (!in.has("expect")) continue;  // shaken: beam_datasets_test
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
  if (!e.displacement.empty()) s.initial = {scene::InitialSpec::At::kGiven, e.displacement, e.velocity};
  dynamics::HybridSystem system = build_system(s);
  dynamics::State start = initial_state(s, system);
  return {std::move(s), std::move(system), std::move(start), e.modes};
}

/// Calls measure(start) for every member of the scene's ensemble and returns one column of values per member.
Eigen::MatrixXd by_member(const Case& c, const std::function<Eigen::VectorXd(const dynamics::State&)>& measure) {
  const std::vector<dynamics::State> starts = ensemble_states(c.scene, c.system);
  std::vector<Eigen::VectorXd> columns(starts.size());
  rethrow_first(parallel_for(starts.size(), {}, [&](std::size_t k) { columns[k] = measure(starts[k]); }));
  Eigen::MatrixXd table(columns.front().size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) table.col(static_cast<Eigen::Index>(k)) = columns[k];
  return table;
}

std::vector<double> mean_over_members(const Eigen::MatrixXd& table) {
  const Eigen::VectorXd mean = table.rowwise().mean();
  return {mean.begin(), mean.end()};
}

/// A run of `length` after the scene's transient.
dynamics::SimulateOptions record(const Case& c, double length, double sample) {
  return {.duration = c.scene.time.transient + length,
          .transient = c.scene.time.transient,
          .sample = sample,
          .output = dynamics::SimulateOptions::Output::kContacts,
          .flow = c.scene.flow};
}

std::vector<double> energy_share_cumulative(const Case& c) {
  // Of 40 ensembles of the scene's eight members six modes' share has a standard deviation of 0.024 %, and one was off
  // by 0.09: four times as many members halve that.
  scene::Scene many = c.scene;
  many.ensemble.members *= 4;
  const diagnostics::EnsembleRun run = diagnostics::run_ensemble(
      diagnostics::belt_model(c.system), {c.scene.drive.velocity(0.0)}, ensemble_states(many, c.system),
      {.duration = c.scene.time.duration,
       .transient = c.scene.time.transient,
       .sample = c.scene.time.sample,
       .flow = c.scene.flow});
  const pod::PodResult result = pod::pod(run.ensemble);
  std::vector<double> shares;
  for (const int modes : c.modes) shares.push_back(100.0 * result.shares.head(modes).sum());
  return shares;
}

std::vector<double> mean_displacement_per_mass(const Case& c) {
  dynamics::SimulateOptions options = record(c, 50000.0, 1.0);
  options.output = dynamics::SimulateOptions::Output::kAllDofs;
  const Eigen::VectorXd number = Eigen::VectorXd::LinSpaced(c.system.size(), 1.0, static_cast<double>(c.system.size()));
  return mean_over_members(by_member(c, [&](const dynamics::State& start) -> Eigen::VectorXd {
    const Eigen::VectorXd mean = dynamics::simulate(c.system, start, options).q.rowwise().mean();
    return Eigen::VectorXd::Constant(1, number.dot(mean) / number.squaredNorm());
  }));
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
  // Single records scatter by 2 %: of eight, a mean by 0.7 %.
  Case many = c;
  many.scene.ensemble.members *= 2;
  diagnostics::LyapunovOptions options;
  options.transient = c.scene.time.transient;
  options.duration = 200000.0;
  options.flow = c.scene.flow;
  return mean_over_members(by_member(many, [&](const dynamics::State& start) -> Eigen::VectorXd {
    return Eigen::VectorXd::Constant(1, diagnostics::largest_exponent(c.system, start, options).bits);
  }));
}

std::vector<double> slip_rate(const Case& c) {
  constexpr double kLength = 100000.0;
  return mean_over_members(by_member(c, [&](const dynamics::State& start) -> Eigen::VectorXd {
    const dynamics::Trajectory run = dynamics::simulate(c.system, start, record(c, kLength, 0.0));
    const auto slips = std::ranges::count(run.events, dynamics::EventKind::kRelease, &dynamics::Event::kind);
    return Eigen::VectorXd::Constant(1, static_cast<double>(slips) / kLength);
  }));
}

/// Samples in stick are those between an event that starts a stick and the next event; the ends come from the events.
Eigen::VectorXd stick_forces(const dynamics::Trajectory& run) {
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
  return Eigen::Vector2d(low, high);
}

std::vector<double> stick_force_range(const Case& c) {
  return mean_over_members(by_member(c, [&](const dynamics::State& start) -> Eigen::VectorXd {
    return stick_forces(dynamics::simulate(c.system, start, record(c, 50000.0, 0.1)));
  }));
}

std::vector<double> driven_velocity_range(const Case& c) {
  return mean_over_members(by_member(c, [&](const dynamics::State& start) -> Eigen::VectorXd {
    const dynamics::Trajectory run = dynamics::simulate(c.system, start, record(c, 50000.0, 0.1));
    return Eigen::Vector2d(run.contact_v.row(0).minCoeff(), run.contact_v.row(0).maxCoeff());
  }));
}

/// This number of every event at which the first contact turns or comes to rest.
std::vector<double> at_turns(const Case& c, double dynamics::Event::*number) {
  const dynamics::SimulateOptions run{.duration = c.scene.time.duration, .flow = c.scene.flow};
  std::vector<double> found;
  for (const dynamics::Event& event : dynamics::simulate(c.system, c.start, run).events)
    if (event.contact == 0 &&
        (event.kind == dynamics::EventKind::kReversal || event.kind == dynamics::EventKind::kStick))
      found.push_back(event.*number);
  return found;
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
      {"mean_displacement_per_mass", mean_displacement_per_mass},
      {"turning_points", [](const Case& c) { return at_turns(c, &dynamics::Event::displacement); }},
      {"turning_times", [](const Case& c) { return at_turns(c, &dynamics::Event::time); }}};
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

void PrintTo(const Expectation& e, std::ostream* out) { *out << e.dataset << " " << e.measure; }

INSTANTIATE_TEST_SUITE_P(Shipped, Dataset, testing::ValuesIn(all_expectations()), [](const auto& instance) {
  const Expectation& e = instance.param;
  return fixtures::name_part(e.dataset + "_" + e.measure + "_" + std::to_string(instance.index));
});

}  // namespace
