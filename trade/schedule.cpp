#include <slipmode/trade/schedule.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::trade {

namespace {

/// Samples up to a belt's horizon, and numbers that all its records together may hold: long chains are sampled coarser.
constexpr double kHorizonSamples = 1000.0, kFewestSamples = 100.0;
constexpr double kHorizonNumbers = 4e6;
constexpr double kHorizonPeriods = 10.0;
constexpr Eigen::Index kSectionSamples = 32;
constexpr double kTimedPeriods = 50.0;
constexpr int kPeriodicStarts = 4;

Schedule on_belt(const scene::Scene& scene) {
  const scene::ValidationSpec& spec = scene.validation;
  Schedule s;
  s.first_transient = scene.time.transient;
  s.transient = spec.transient;
  s.duration = spec.limit;
  s.sample = scene.time.sample;
  s.horizon = spec.horizon;
  s.gap = 2.0 * spec.horizon;
  s.starts = std::max(1, spec.horizon_starts / s.runs);
  const double fits = kHorizonNumbers / static_cast<double>(scene.size() * s.starts * s.runs);
  s.horizon_sample = spec.horizon / std::clamp(std::floor(fits), kFewestSamples, kHorizonSamples);
  s.timed = spec.cost_duration > 0.0 ? spec.cost_duration : spec.block;
  s.repeats = spec.cost_repeats;
  return s;
}

/// @param settling, kept  whole numbers of periods
Schedule in_periods(double period, double settling, double kept, double timed, int repeats) {
  Schedule s;
  s.period = period;
  s.first_transient = s.transient = settling * period;
  s.duration = kept * period;
  s.per_section = kSectionSamples;
  s.sample = period / static_cast<double>(kSectionSamples);
  s.horizon = kHorizonPeriods * period;
  s.horizon_sample = 0.5 * s.sample;
  s.gap = (kHorizonPeriods - 3.0) * period;
  s.starts = kPeriodicStarts;
  s.timed = timed * period;
  s.repeats = repeats;
  return s;
}

}  // namespace

Schedule schedule_of(const scene::Scene& scene) {
  if (scene.drive.belt() != nullptr) {
    if (scene.drive.is_constant()) return on_belt(scene);
    throw InvalidInput(
        fmt::format("{}: drive.speed: a ramp never settles to a motion that could be compared; valid: one speed",
                    scene.source.path));
  }
  const double period = *scene.drive.period();
  if (scene.drive.shaker() != nullptr) {
    const scene::DrivenValidationSpec& spec = scene.driven;
    const double kept = std::max(1.0, std::floor(spec.kept));
    const double timed = spec.cost_cycles > 0.0 ? std::min(spec.cost_cycles, kTimedPeriods) : kTimedPeriods;
    return in_periods(period, std::max(0.0, std::floor(spec.cycles) - kept), kept, timed, spec.cost_repeats);
  }
  const double settling = std::ceil(scene.time.transient / period);
  const double kept = std::max(1.0, std::floor((scene.time.duration - scene.time.transient) / period));
  return in_periods(period, settling, kept, kTimedPeriods, Schedule{}.repeats);
}

}  // namespace slipmode::trade
