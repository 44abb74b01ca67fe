#include <slipmode/core/errors.hpp>
#include <slipmode/trade/parting.hpp>
#include "trade/internal/horizon.hpp"

#include <cmath>

namespace slipmode::trade {

Parting parting(const Case& model, const dynamics::State& from, int starts, const Schedule& schedule,
                const StopFlag* stop) {
  constexpr double kApart = 1e-6, kStill = 1e-9;  // of the reading itself
  const auto columns = static_cast<Eigen::Index>(std::llround(schedule.horizon / schedule.horizon_sample));
  const auto reading_from = [&](const dynamics::State& start) {
    const dynamics::Trajectory run = dynamics::simulate(
        model.model.system, start,
        {.duration = schedule.horizon, .sample = schedule.horizon_sample, .keep_events = false, .flow = model.flow});
    return Eigen::ArrayXd(model.model.readings.of(run.q.leftCols(columns)).row(0).transpose());
  };
  double apart = 0.0, size = 0.0, whole = 0.0;
  for (const dynamics::State& start : states_of(model, from, starts, schedule.gap, stop)) {
    dynamics::State other = start;
    other.q *= 1.0 + kApart;
    other.v *= 1.0 + kApart;
    other.modes.clear();
    const Eigen::ArrayXd own = reading_from(start);
    apart += (reading_from(other) - own).square().sum();
    size += (own - own.mean()).square().sum();
    whole += own.square().sum();
  }
  if (size <= kStill * kStill * whole) return {};
  return {.apart = 100.0 * std::sqrt(apart / size), .reach = std::sqrt(size / static_cast<double>(starts * columns))};
}

void require_motion(const Parting& from_start, const Parting& later) {
  if (from_start.reach == 0.0 && later.reach == 0.0)
    throw InvalidInput(
        "initial: nothing moves from the scene's start on, so there is nothing to compare; give "
        "initial.displacement or initial.velocity, or initial.at = \"rest\"");
}

}  // namespace slipmode::trade
