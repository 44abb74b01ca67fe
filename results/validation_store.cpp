#include <slipmode/results/validation_store.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/table.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {
namespace {

using diagnostics::CandidateReport;
using diagnostics::OrbitRow;
using diagnostics::Settled;
using diagnostics::ShareRow;
using diagnostics::ValidationReport;

/// The rows of all candidates in turn, and columns of them.
template <class Row>
class RowColumns {
 public:
  RowColumns(const ValidationReport& report, std::vector<Row> CandidateReport::*of_candidate) {
    for (const CandidateReport& candidate : report.candidates) {
      for (const Row& row : candidate.*of_candidate) {
        rows.push_back(&row);
        basis.push_back(candidate.name);
      }
    }
  }

  template <class Value>
  [[nodiscard]] std::vector<double> numbers(Value value) const {
    std::vector<double> out;
    for (const Row* row : rows) out.push_back(static_cast<double>(value(*row)));
    return out;
  }
  template <class Value>
  [[nodiscard]] std::vector<std::string> texts(Value value) const {
    std::vector<std::string> out;
    for (const Row* row : rows) out.push_back(value(*row));
    return out;
  }

  std::vector<const Row*> rows;
  std::vector<std::string> basis;
};

Table share_table(const ValidationReport& report, const Units& units) {
  const RowColumns own(report, &CandidateReport::shares);
  const auto settled = [&own](auto value) {
    return own.numbers([value](const ShareRow& row) { return row.attractor ? value(*row.attractor) : kNone; });
  };
  const auto horizon = [](const ShareRow* row) { return row->failure.empty() ? &row->horizon : nullptr; };
  const auto distance = [](const ShareRow* row) { return row->attractor ? &row->distance : nullptr; };
  return {
      "energy shares and deviations against the number of modes, at the table's speed",
      joined(
          {{{"basis", {"", "kind of basis"}, own.basis},
            {"modes", {"", "number of modes"}, own.numbers([](const ShareRow& row) { return row.modes; })},
            {"energy", {"%", "share of the ensemble's energy"}, own.numbers([](const ShareRow& row) {
               return row.energy;
             })}},
           columns_of(own.rows, horizon),
           {{"start_error", {"%", "part of dX there at time 0"}, own.numbers([](const ShareRow& row) {
               return row.failure.empty() ? row.start_error : kNone;
             })},
            {"motion", {"", "what the reduced model settles to"}, own.texts([](const ShareRow& row) {
               return std::string(row.attractor ? diagnostics::attractor_word(*row.attractor, row.lyapunov) : "failed");
             })},
            {"period", {"", "slips per period; 0: not periodic"}, settled([](const Settled& motion) {
               return static_cast<double>(motion.period.period);
             })},
            {"stick_fraction",
             {"1", "share of time in stick, mean over contacts whose law sticks"},
             settled([](const Settled& motion) { return motion.stick_fraction; })},
            {"slip_rate", {units.rate, "slips per unit of time"}, settled([](const Settled& motion) {
               return motion.slip_rate;
             })}},
           columns_of(own.rows, distance),
           {{"lyapunov",
             {units.bit_rate(), "largest exponent of an aperiodic motion"},
             own.numbers([](const ShareRow& row) { return row.lyapunov ? row.lyapunov->bits : kNone; })},
            {"lyapunov_error", {units.bit_rate(), "its standard error"}, own.numbers([](const ShareRow& row) {
               return row.lyapunov ? row.lyapunov->error_bits() : kNone;
             })},
            {"failure", {"", "why there is no result"}, own.texts([](const ShareRow& row) { return row.failure; })}}})};
}

Table orbit_table(const ValidationReport& report, const Units& units) {
  using Comparison = diagnostics::OrbitComparison;
  const RowColumns own(report, &CandidateReport::orbits);
  const auto compared = [&own](auto value) {
    return own.numbers([value](const OrbitRow& row) { return row.comparison ? value(*row.comparison) : kNone; });
  };
  const auto in_phase = [&compared](auto value) {
    return compared([value](const Comparison& c) { return c.same_period ? value(c.deviation) : kNone; });
  };
  return {"full against reduced on periodic orbits",
          {{"basis", {"", "kind of basis"}, own.basis},
           {"speed", {units.velocity, "belt speed"}, own.numbers([](const OrbitRow& row) { return row.speed; })},
           {"modes", {"", "number of modes"}, own.numbers([](const OrbitRow& row) { return row.modes; })},
           {"period_full", {"", "slips per period"}, compared([](const Comparison& c) { return c.full.period; })},
           {"period_reduced", {"", "slips per period"}, compared([](const Comparison& c) { return c.reduced.period; })},
           {"T_full", {units.time, "period"}, compared([](const Comparison& c) { return c.full.T; })},
           {"T_reduced", {units.time, "period"}, compared([](const Comparison& c) { return c.reduced.T; })},
           {"dX", {"%", "S4 (3.37) over one period, in phase"}, in_phase([](const auto& deviation) {
              return deviation.dX;
            })},
           {"dE", {"%", "S4 (3.36) over one period"}, in_phase([](const auto& deviation) { return deviation.dE; })},
           {"failure", {"", "why there is no result"}, own.texts([](const OrbitRow& row) { return row.failure; })}}};
}

void store_full(StoreWriter& writer, const ValidationReport& report, const Units& units) {
  const std::string group = "validation/full/";
  writer.write(group + "speed", report.speed, {units.velocity, "belt speed of the table"});
  writer.write(group + "motion", diagnostics::attractor_word(report.full, report.lyapunov),
               {"", "what the full model settles to"});
  writer.write(group + "stick_fraction", report.full.stick_fraction,
               {"1", "share of time in stick, mean over contacts whose law sticks"});
  writer.write(group + "slip_rate", report.full.slip_rate, {units.rate, "slips per unit of time"});
  writer.write(group + "mean_energy", report.full.mean_energy, {units.energy, "mean energy"});
  if (report.lyapunov) {
    writer.write(group + "lyapunov_bits", report.lyapunov->bits, {units.bit_rate(), "largest exponent"});
    writer.write(group + "lyapunov_error", report.lyapunov->error_bits(), {units.bit_rate(), "its standard error"});
  }
  writer.write(group + "noise_wasserstein", report.noise.wasserstein,
               {units.length, "slip states of two independent full runs: as close as full is to itself"});
  writer.write(group + "noise_hausdorff", report.noise.hausdorff, {units.length, "same"});
  writer.write(group + "noise_mean_energy", report.noise.mean_energy_percent, {"%", "same"});
  writer.write("validation/chosen_modes", static_cast<std::int64_t>(report.chosen),
               {"", "number of modes of the sweep and of the cost"});
}

}  // namespace

void store_validation(StoreWriter& writer, const ValidationReport& report, const scene::Scene& scene) {
  const Units units = Units::of(scene.units);
  store_full(writer, report, units);
  save(writer, "validation/shares", share_table(report, units));
  save(writer, "validation/orbits", orbit_table(report, units));
  if (report.bifurcation) save_fields(writer, "validation/bifurcation", *report.bifurcation);
  if (report.cost) save_fields(writer, "validation/cost", *report.cost);
  if (report.verdict) store_verdict(writer, *report.verdict, units);
  if (report.sweep) {
    const SweepAxis axis = sweep_axis(scene, "drive.speed");
    const std::string reduced = fmt::format("reduced model, {} {}s", report.chosen, report.candidates.front().name);
    store_sweep(writer, "sweep/full", "full model", axis, units, report.sweep->full);
    store_sweep(writer, "sweep/reduced", reduced, axis, units, report.sweep->reduced);
  }
}

}  // namespace slipmode::results
