#include <slipmode/scene/own_times.hpp>

#include <slipmode/fem/modes.hpp>
#include "scene/internal/toml_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace slipmode::scene {

namespace {

/// A time of [validation] in slowest periods: of chain10, whose period is 42, the values its source has or that were
/// found to do.
struct TimeInPeriods {
  const char* key;
  double ValidationSpec::*time;
  double periods;
};
constexpr std::array<TimeInPeriods, 7> kTimes = {{{"transient", &ValidationSpec::transient, 24.0},
                                                  {"block", &ValidationSpec::block, 120.0},
                                                  {"limit", &ValidationSpec::limit, 2400.0},
                                                  {"sweep_limit", &ValidationSpec::sweep_limit, 120.0},
                                                  {"horizon", &ValidationSpec::horizon, 2.4},
                                                  {"lyapunov_duration", &ValidationSpec::lyapunov_duration, 480.0},
                                                  {"cost_duration", &ValidationSpec::cost_duration, 240.0}}};

double to_one_digit(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)));
  return std::round(value / unit) * unit;
}

/// Of the slowest mode that is not one of free motion; 0 where there is none among the first.
double slowest_period(const fem::Structure& structure) {
  constexpr Eigen::Index kLooked = 8;  // of which a structure in space has six without stiffness
  constexpr double kFree = 1e-6;       // of the fastest of these
  const Eigen::VectorXd omega = fem::natural_modes(structure, std::min(kLooked, structure.size())).omega;
  for (const double own : omega) {
    if (own > kFree * omega.maxCoeff()) return 2.0 * std::numbers::pi / own;
  }
  return 0.0;
}

}  // namespace

Scene with_own_times(Scene scene) {
  if (scene.drive.belt() == nullptr || scene.source.text.empty()) return scene;
  const TomlDocument document(scene.source.text, scene.source.path, scene.source.overrides);
  const auto is_given = [&](const char* key) { return static_cast<bool>(document.root()["validation"][key]); };
  ValidationSpec& spec = scene.validation;
  const double speed = scene.drive.velocity(0.0);
  if (!is_given("speeds") && speed != 0.0) spec.speeds = {2.5 * speed, speed / 20.0, std::abs(speed) / 20.0};
  if (std::ranges::all_of(kTimes, is_given, &TimeInPeriods::key)) return scene;
  const double period = slowest_period(build_system(scene).structure());
  if (period == 0.0) return scene;
  for (const TimeInPeriods& own : kTimes) {
    if (!is_given(own.key)) spec.*own.time = to_one_digit(own.periods * period);
  }
  if (!is_given("block")) spec.block = std::min(spec.block, spec.limit);
  if (!is_given("limit")) spec.limit = std::max(spec.limit, spec.block);
  return scene;
}

}  // namespace slipmode::scene
