#include <slipmode/scene/own_times.hpp>

#include <slipmode/fem/modes.hpp>
#include "scene/internal/periods.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::scene {

namespace {

constexpr double kSweptTo = 2.5, kSweptSteps = 20.0;  // of the belt's own speed

bool is_given_in(const Scene& scene, const char* table, const char* key) {
  return scene.source.given.contains(fmt::format("{}.{}", table, key));
}

}  // namespace

double to_one_digit(double time) {
  if (time == 0.0) return 0.0;
  const double exponent = std::floor(std::log10(time)), unit = std::pow(10.0, std::abs(exponent));
  // 3 / 10 is the number next to 0.3, 3 · 0.1 is not.
  return exponent < 0.0 ? std::round(time * unit) / unit : std::round(time / unit) * unit;
}

double slowest_period(const Scene& scene) {
  constexpr double kFree = 1e-6;  // of the fastest mode looked at
  const fem::Structure structure = build_system(scene).structure();
  // Eight are enough where no more than a structure in space has are without stiffness.
  for (Eigen::Index looked = 8;; looked *= 2) {
    const Eigen::VectorXd omega = fem::natural_modes(structure, std::min(looked, structure.size())).omega;
    for (const double own : omega)
      if (own > kFree * omega.maxCoeff()) return 2.0 * std::numbers::pi / own;
    if (looked >= structure.size()) return 0.0;
  }
}

bool has_sticking_law(const Scene& scene) {
  return std::ranges::any_of(scene.contacts,
                             [](const ContactSpec& contact) { return friction::sticks(friction::kind(contact.law)); });
}

Scene with_own_times(Scene scene) {
  if (scene.drive.belt() == nullptr || scene.source.text.empty()) return scene;
  const auto is_given = [&](const char* key) { return is_given_in(scene, "validation", key); };
  ValidationSpec& spec = scene.validation;
  const double speed = scene.drive.velocity(0.0);
  if (!is_given("speeds") && speed != 0.0) {
    spec.speeds = {kSweptTo * speed, speed / kSweptSteps, std::abs(speed) / kSweptSteps};
  }
  if (std::ranges::all_of(kValidationTimes, is_given, &TimeInPeriods<ValidationSpec>::key)) return scene;
  const double period = scene.source.period = slowest_period(scene);
  if (period == 0.0) return scene;
  for (const auto& own : kValidationTimes) {
    if (!is_given(own.key)) spec.*own.time = to_one_digit(own.periods * period);
  }
  if (!is_given("block")) spec.block = std::min(spec.block, spec.limit);
  if (!is_given("limit")) spec.limit = has_sticking_law(scene) ? std::max(spec.limit, spec.block) : spec.block;
  return scene;
}

ChosenTimes chosen_times(const Scene& scene, const std::vector<std::string>& names) {
  ChosenTimes chosen;
  if (scene.source.text.empty()) return chosen;
  const auto wanted = [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
  const auto add = [&](const char* table, const char* key, double value) {
    const std::string path = fmt::format("{}.{}", table, key);
    if ((wanted(table) || wanted(path)) && !scene.source.given.contains(path)) chosen.times.push_back({path, value});
  };
  const bool on_belt = scene.drive.belt() != nullptr;
  if (scene.time.cycles) {
    for_each_field<TimeSpec::Cycles>(
        [&](const auto& field) { add("time", field.name, static_cast<double>(*scene.time.cycles.*field.member)); });
  } else {
    for_each_field<TimeSpec>([&](const auto& field) {
      const bool is_plain = scene.time.*field.member == 0.0;  // no transient beside a given duration
      if (!is_plain) add("time", field.name, scene.time.*field.member);
    });
  }
  if (on_belt) {
    for (const auto& own : kValidationTimes) add("validation", own.key, scene.validation.*own.time);
  }
  if (chosen.times.empty()) return chosen;
  chosen.period = on_belt ? scene.source.period : scene.drive.period().value();
  // Of a short record a sample is a hundredth at most.
  const bool by_record =
      on_belt && wanted("time") && is_given_in(scene, "time", "duration") && !is_given_in(scene, "time", "sample");
  chosen.of = !on_belt    ? "the drive's period"
              : by_record ? "the record's length and the structure's slowest natural period"
                          : "the structure's slowest natural period";
  return chosen;
}

}  // namespace slipmode::scene
