#pragma once

#include <slipmode/scene/scene.hpp>

#include <array>

namespace slipmode::scene {

/// A time that a scene does not give, in slowest natural periods of its structure.
template <class Spec>
struct TimeInPeriods {
  const char* key;
  double Spec::*time;
  double periods;
};

/// Those of a belt's [validation]: of chain10, whose period is 42, the values its source has or that were found to do.
inline constexpr std::array<TimeInPeriods<ValidationSpec>, 7> kValidationTimes = {
    {{"transient", &ValidationSpec::transient, 24.0},
     {"block", &ValidationSpec::block, 120.0},
     {"limit", &ValidationSpec::limit, 2400.0},
     {"sweep_limit", &ValidationSpec::sweep_limit, 120.0},
     {"horizon", &ValidationSpec::horizon, 2.4},
     {"lyapunov_duration", &ValidationSpec::lyapunov_duration, 480.0},
     {"cost_duration", &ValidationSpec::cost_duration, 240.0}}};

/// [time] on a belt: what is not kept where neither it nor a duration is given, what is kept, and the sampling
/// interval.
inline constexpr double kTransientPeriods = 24.0, kKeptPeriods = 216.0, kSamplePeriods = 1.0 / 80.0;

/// [time] under a shaker or a force, in its cycles.
inline constexpr TimeSpec::Cycles kUsualCycles = {.cycles = 300.0, .transient_cycles = 200.0};

}  // namespace slipmode::scene
