#include <slipmode/results/validation_store.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/table.hpp>

#include <fmt/format.h>

namespace slipmode::results {
namespace {

using diagnostics::CandidateReport;
using diagnostics::OrbitRow;
using diagnostics::ShareRow;
using diagnostics::ValidationReport;

/// One column of numbers, a value per row of all candidates in turn.
template <class Rows, class Value>
std::vector<double> column(const ValidationReport& report, Rows rows, Value value) {
  std::vector<double> out;
  for (const CandidateReport& candidate : report.candidates) {
    for (const auto& row : candidate.*rows) out.push_back(static_cast<double>(value(row)));
  }
  return out;
}

template <class Rows, class Value>
std::vector<std::string> texts(const ValidationReport& report, Rows rows, Value value) {
  std::vector<std::string> out;
  for (const CandidateReport& candidate : report.candidates) {
    for (const auto& row : candidate.*rows) out.push_back(value(candidate, row));
  }
  return out;
}

Table share_table(const ValidationReport& report, const Units& units) {
  const auto numbers = [&report](auto value) { return column(report, &CandidateReport::shares, value); };
  const auto when_ok = [&numbers](auto value) {
    return numbers([value](const ShareRow& row) { return row.failure.empty() ? value(row) : kNone; });
  };
  const auto settled = [&numbers](auto value) {
    return numbers([value](const ShareRow& row) { return row.attractor ? value(row) : kNone; });
  };
  const auto words = [&report](auto value) { return texts(report, &CandidateReport::shares, value); };
  return {"energy shares and deviations against the number of modes, at the table's speed",
          {{"basis", {"", "kind of basis"}, words([](const auto& c, const ShareRow&) { return c.name; })},
           {"modes", {"", "number of modes"}, numbers([](const ShareRow& row) { return row.modes; })},
           {"energy", {"%", "share of the ensemble's energy"}, numbers([](const ShareRow& row) { return row.energy; })},
           {"dX",
            {"%", "S4 (3.37) from shared starts up to the horizon, root mean square over the starts"},
            when_ok([](const ShareRow& row) { return row.horizon.dX; })},
           {"dE", {"%", "S4 (3.36), same runs"}, when_ok([](const ShareRow& row) { return row.horizon.dE; })},
           {"dE_pointwise", {"%", "root mean square difference of the energies"}, when_ok([](const ShareRow& row) {
              return row.horizon.dE_pointwise;
            })},
           {"start_error", {"%", "part of dX there at time 0"}, when_ok([](const ShareRow& row) {
              return row.start_error;
            })},
           {"motion", {"", "what the reduced model settles to"}, words([](const auto&, const ShareRow& row) {
              return std::string(row.attractor ? diagnostics::attractor_word(*row.attractor, row.lyapunov) : "failed");
            })},
           {"period", {"", "slips per period; 0: not periodic"}, settled([](const ShareRow& row) {
              return static_cast<double>(row.attractor->period.period);
            })},
           {"stick_fraction", {"1", "share of time in stick"}, settled([](const ShareRow& row) {
              return row.attractor->stick_fraction;
            })},
           {"slip_rate", {units.rate, "slips per unit of time"}, settled([](const ShareRow& row) {
              return row.attractor->slip_rate;
            })},
           {"wasserstein",
            {units.length, "distance of the slip states to the full model's"},
            settled([](const ShareRow& row) { return row.distance.wasserstein; })},
           {"hausdorff",
            {units.length, "distance of the slip states to the full model's"},
            settled([](const ShareRow& row) { return row.distance.hausdorff; })},
           {"mean_energy",
            {"%", "difference of the mean energy from the full model's"},
            settled([](const ShareRow& row) { return row.distance.mean_energy_percent; })},
           {"lyapunov",
            {"bit per unit of time", "largest exponent of an aperiodic motion"},
            numbers([](const ShareRow& row) { return row.lyapunov ? row.lyapunov->bits : kNone; })},
           {"failure", {"", "why there is no result"}, words([](const auto&, const ShareRow& row) {
              return row.failure;
            })}}};
}

Table orbit_table(const ValidationReport& report, const Units& units) {
  const auto compared = [&report](auto value) {
    return column(report, &CandidateReport::orbits,
                  [value](const OrbitRow& row) { return row.comparison ? value(*row.comparison) : kNone; });
  };
  const auto in_phase = [&compared](auto value) {
    return compared([value](const diagnostics::OrbitComparison& c) { return c.same_period ? value(c) : kNone; });
  };
  const auto words = [&report](auto value) { return texts(report, &CandidateReport::orbits, value); };
  using Comparison = diagnostics::OrbitComparison;
  return {"full against reduced on periodic orbits",
          {{"basis", {"", "kind of basis"}, words([](const auto& c, const OrbitRow&) { return c.name; })},
           {"speed",
            {units.velocity, "belt speed"},
            column(report, &CandidateReport::orbits, [](const OrbitRow& row) { return row.speed; })},
           {"modes",
            {"", "number of modes"},
            column(report, &CandidateReport::orbits, [](const OrbitRow& row) { return row.modes; })},
           {"period_full", {"", "slips per period"}, compared([](const Comparison& c) { return c.full.period; })},
           {"period_reduced", {"", "slips per period"}, compared([](const Comparison& c) { return c.reduced.period; })},
           {"T_full", {units.time, "period"}, compared([](const Comparison& c) { return c.full.T; })},
           {"T_reduced", {units.time, "period"}, compared([](const Comparison& c) { return c.reduced.T; })},
           {"dX", {"%", "S4 (3.37) over one period, in phase"}, in_phase([](const Comparison& c) {
              return c.deviation.dX;
            })},
           {"dE", {"%", "S4 (3.36) over one period"}, in_phase([](const Comparison& c) { return c.deviation.dE; })},
           {"failure", {"", "why there is no result"}, words([](const auto&, const OrbitRow& row) {
              return row.failure;
            })}}};
}

void store_full(StoreWriter& writer, const ValidationReport& report, const Units& units) {
  const std::string group = "validation/full/";
  writer.write(group + "speed", report.speed, {units.velocity, "belt speed of the table"});
  writer.write(group + "motion", std::string(diagnostics::to_string(report.full.period.motion)),
               {"", "what the full model settles to"});
  writer.write(group + "stick_fraction", report.full.stick_fraction, {"1", "share of time in stick"});
  writer.write(group + "slip_rate", report.full.slip_rate, {units.rate, "slips per unit of time"});
  writer.write(group + "mean_energy", report.full.mean_energy, {units.energy, "mean energy"});
  if (report.lyapunov) {
    writer.write(group + "lyapunov_bits", report.lyapunov->bits, {"bit per unit of time", "largest exponent"});
    writer.write(group + "lyapunov_error", report.lyapunov->error, {units.rate, "standard error, natural logarithm"});
  }
  writer.write(group + "noise_wasserstein", report.noise.wasserstein,
               {units.length, "slip states of two independent full runs: as close as full is to itself"});
  writer.write(group + "noise_hausdorff", report.noise.hausdorff, {units.length, "same"});
  writer.write(group + "noise_mean_energy", report.noise.mean_energy_percent, {"%", "same"});
  writer.write("validation/chosen_modes", static_cast<std::int64_t>(report.chosen),
               {"", "number of modes of the sweep and of the cost"});
}

void store_bifurcation(StoreWriter& writer, const diagnostics::BifurcationComparison& comparison, const Units& units) {
  const std::string group = "validation/bifurcation/";
  writer.write(group + "values", static_cast<std::int64_t>(comparison.values), {"", "values with both results"});
  writer.write(group + "failed", static_cast<std::int64_t>(comparison.failed), {"", "values without"});
  writer.write(group + "decided", static_cast<std::int64_t>(comparison.decided),
               {"", "values where neither motion is undecided"});
  writer.write(group + "same_motion", comparison.same_motion,
               {"1", "share of those decided with the same kind of motion; NaN: none is"});
  writer.write(group + "same_period", comparison.same_period, {"1", "the same with the same kind and period"});
  writer.write(group + "periodic_full", comparison.periodic_full, {"1", "share periodic in the full model"});
  writer.write(group + "periodic_reduced", comparison.periodic_reduced, {"1", "share periodic in the reduced model"});
  writer.write(group + "mean_wasserstein", comparison.mean_wasserstein, {units.length, "mean distance of slip states"});
  writer.write(group + "median_wasserstein", comparison.median_wasserstein, {units.length, "median distance"});
  writer.write(group + "mean_hausdorff", comparison.mean_hausdorff, {units.length, "mean distance of slip states"});
}

void store_cost(StoreWriter& writer, const diagnostics::Cost& cost, const Units& units) {
  const std::string group = "validation/cost/";
  writer.write(group + "duration", cost.duration, {units.time, "simulated time of the timed run"});
  writer.write(group + "full_wall", cost.full_wall, {"s", "median wall time, full model", Meaning::Of::kClock});
  writer.write(group + "full_cpu", cost.full_cpu, {"s", "median CPU time, full model", Meaning::Of::kClock});
  writer.write(group + "reduced_wall", cost.reduced_wall,
               {"s", "median wall time, reduced model", Meaning::Of::kClock});
  writer.write(group + "reduced_cpu", cost.reduced_cpu, {"s", "median CPU time, reduced model", Meaning::Of::kClock});
  writer.write(group + "full_setup_wall", cost.full_setup_wall,
               {"s", "wall time of the full model's modal data, once", Meaning::Of::kClock});
  writer.write(group + "projection_wall", cost.projection_wall,
               {"s", "wall time of the projection and its set-up, once", Meaning::Of::kClock});
}

}  // namespace

void store_validation(StoreWriter& writer, const ValidationReport& report, const scene::Scene& scene) {
  const Units units = Units::of(scene.units);
  store_full(writer, report, units);
  save(writer, "validation/shares", share_table(report, units));
  save(writer, "validation/orbits", orbit_table(report, units));
  if (report.bifurcation) store_bifurcation(writer, *report.bifurcation, units);
  if (report.cost) store_cost(writer, *report.cost, units);
  if (report.verdict) store_verdict(writer, *report.verdict, units);
  if (report.sweep) {
    const SweepAxis axis = sweep_axis(scene, "drive.speed");
    const std::string reduced = fmt::format("reduced model, {} {}s", report.chosen, report.candidates.front().name);
    store_sweep(writer, "sweep/full", "full model", axis, units, report.sweep->full);
    store_sweep(writer, "sweep/reduced", reduced, axis, units, report.sweep->reduced);
  }
}

}  // namespace slipmode::results
