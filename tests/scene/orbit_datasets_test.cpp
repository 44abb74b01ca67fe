// Finds the orbits of every dataset with a force and compares with its expected.toml.

#include <slipmode/core/decompositions.hpp>
#include <slipmode/orbits/shooting.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/internal/toml_reader.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace slipmode;

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Calls `check(entry, scene file)` for each [[kind]] of each expected.toml. @return how many there were
int for_each(const std::string& kind, const std::function<void(scene::TomlReader&, const std::string&)>& check) {
  int count = 0;
  for (const auto& folder : std::filesystem::directory_iterator(SLIPMODE_SOURCE_DIR "/datasets")) {
    const auto path = folder.path() / "expected.toml";
    if (!std::filesystem::exists(path)) continue;
    const scene::TomlDocument document(text_of(path), path.string(), {});
    scene::TomlReader in(document);
    if (!in.has(kind)) continue;
    for (scene::TomlReader& entry : in.tables(kind)) {
      const std::string name = entry.text_or("label", std::to_string(count));
      SCOPED_TRACE(folder.path().filename().string() + ", " + kind + " " + name);
      check(entry, (folder.path() / "scene.toml").string());
      EXPECT_FALSE(entry.text_or("origin", "").empty()) << "every value needs its origin";
      entry.finish();
      ++count;
    }
  }
  return count;
}

/// The scene of an entry: its file with `set` applied.
scene::Scene scene_of(scene::TomlReader& entry, const std::string& file) {
  return scene::load_scene(file, entry.has("set") ? entry.texts("set") : std::vector<std::string>{});
}

dynamics::State start_of(scene::TomlReader& entry, const scene::Scene& scene, const dynamics::HybridSystem& system) {
  if (!entry.has("start")) {
    const double periods = std::round(scene.time.transient / *system.drive().period());
    return orbits::settle_guess(system, scene::initial_state(scene, system), periods);
  }
  const std::vector<double> x = entry.numbers("start", kFinite, 2 * system.size());
  const Eigen::Map<const Eigen::VectorXd> values(x.data(), 2 * system.size());
  return {.q = values.head(system.size()), .v = values.tail(system.size())};
}

void check_multipliers(scene::TomlReader& entry, const orbits::PeriodicOrbit& orbit, double tolerance) {
  if (!entry.has("multipliers")) return;
  for (const auto& [re, im] : entry.pairs("multipliers", kFinite, kFinite)) {
    double nearest = INFINITY;
    for (const std::complex<double>& found : orbit.multipliers) {
      nearest = std::min({nearest, std::max(std::abs(found.real() - re), std::abs(found.imag() - im))});
    }
    EXPECT_LE(nearest, tolerance) << re << " + " << im << "i";
  }
}

void check_orbit(scene::TomlReader& entry, const std::string& file) {
  const scene::Scene scene = scene_of(entry, file);
  const dynamics::HybridSystem system = build_system(scene);
  const int order = entry.has("order") ? entry.integer<int>("order", kCount) : 1;
  const bool half = entry.flag_or("half", false);
  const orbits::ShootingResult found =
      orbits::shoot(system, start_of(entry, scene, system), {.order = order, .half_period = half});
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_LE(found.orbit.residual, 1e-11);
  EXPECT_EQ(found.orbit.repeats, 1);
  const double tolerance = entry.number_or("tolerance", 0.0, kPositive);
  check_multipliers(entry, found.orbit, tolerance);
  if (entry.has("modulus")) {
    EXPECT_NEAR(found.orbit.leading_modulus, entry.number("modulus", kFinite), tolerance);
  }
  if (entry.has("stability")) {
    EXPECT_EQ(orbits::to_string(found.orbit.stability), entry.text_or("stability", ""));
  }
  if (entry.has("symmetric")) {
    EXPECT_EQ(found.orbit.symmetric, entry.flag_or("symmetric", false));
  }
  if (entry.has("crossings")) {
    EXPECT_EQ(found.orbit.crossings, entry.integer<int>("crossings", kFromZero));
  }
  if (entry.has("family")) {
    EXPECT_EQ(found.orbit.family.cols(), entry.integer<int>("family", kFromZero));
  }
  if (entry.has("amplitude")) {
    const orbits::Amplitude size = orbits::amplitude(system, found.orbit, system.contacts().front().direction);
    EXPECT_NEAR(size.alternating, entry.number("amplitude", kFinite), tolerance);
  }
}

/// The least number of drive periods after which the motion repeats, after so many cycles; 0: none up to 16.
int settled_period(const scene::Scene& scene, double cycles) {
  constexpr Eigen::Index kWatched = 128, kLongest = 16;
  constexpr double kSame = 1e-5;
  const dynamics::HybridSystem system = build_system(scene);
  const double period = *system.drive().period();
  const dynamics::Trajectory run = dynamics::simulate(system, initial_state(scene, system),
                                                      {.duration = (cycles + kWatched) * period,
                                                       .transient = cycles * period,
                                                       .sample = period,
                                                       .keep_events = false,
                                                       .flow = {.audit = false}});
  for (Eigen::Index p = 1; p <= kLongest; ++p) {
    const Eigen::Index pairs = run.q.cols() - p;
    const double moved = (run.q.rightCols(pairs) - run.q.leftCols(pairs)).cwiseAbs().maxCoeff();
    if (moved < kSame) return static_cast<int>(p);
  }
  return 0;
}

void check_settled(scene::TomlReader& entry, const std::string& file) {
  const scene::Scene scene = scene_of(entry, file);
  const int period = settled_period(scene, entry.number("cycles", kPositive));
  EXPECT_EQ(period > 0, entry.flag_or("periodic", true)) << period;
  if (entry.has("period")) {
    EXPECT_EQ(period, entry.integer<int>("period", kCount));
  }
}

TEST(OrbitDatasets, OrbitsAreThoseOfTheSources) { EXPECT_GE(for_each("orbit", check_orbit), 20); }

TEST(OrbitDatasets, MotionsSettleAsTheSourcesSay) { EXPECT_GE(for_each("settled", check_settled), 5); }

}  // namespace
