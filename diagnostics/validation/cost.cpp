#include <slipmode/diagnostics/validation/cost.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/timing.hpp>
#include <slipmode/diagnostics/model.hpp>
#include <slipmode/rom/reduce.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace slipmode::diagnostics {

double Cost::break_even(double basis_wall) const {
  const double saved = full_wall - reduced_wall;
  if (!(saved > 0.0)) return std::numeric_limits<double>::infinity();
  return (basis_wall + projection_wall) / saved;
}

Cost measure_cost(const dynamics::HybridSystem& full, const pod::Basis& basis, const dynamics::State& start,
                  double duration, int repeats, const dynamics::FlowOptions& flow) {
  if (!(duration > 0.0) || repeats < 1) {
    throw InvalidInput(fmt::format("cost: expected duration > 0 and repeats >= 1, found {} and {}", duration, repeats));
  }
  dynamics::SimulateOptions run{.duration = duration, .keep_events = false, .flow = flow};
  run.output = dynamics::SimulateOptions::Output::kContacts;
  const auto simulate = [&](const dynamics::HybridSystem& system, const dynamics::State& from) {
    return timed([&] { (void)dynamics::simulate(system, from, run); });
  };

  std::optional<dynamics::HybridSystem> reduced;
  const Times projection = timed([&] { reduced = rom::reduce(full, basis); });
  const dynamics::State full_start = dynamics::handed_on(full, start);
  const dynamics::State reduced_start =
      dynamics::handed_on(*reduced, rom::restrict_state(full.structure(), basis, start));
  const Times full_first = simulate(full, full_start);
  const Times reduced_first = simulate(*reduced, reduced_start);
  std::vector<Times> full_times;
  std::vector<Times> reduced_times;
  for (int k = 0; k < repeats; ++k) {
    full_times.push_back(simulate(full, full_start));
    reduced_times.push_back(simulate(*reduced, reduced_start));
  }
  const Times full_median = median_times(full_times);
  const Times reduced_median = median_times(reduced_times);
  return {.duration = duration,
          .full_wall = full_median.wall,
          .full_cpu = full_median.cpu,
          .reduced_wall = reduced_median.wall,
          .reduced_cpu = reduced_median.cpu,
          .full_setup_wall = std::max(0.0, full_first.wall - full_median.wall),
          .projection_wall = projection.wall + std::max(0.0, reduced_first.wall - reduced_median.wall)};
}

}  // namespace slipmode::diagnostics
