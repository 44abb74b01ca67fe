#include "cli/sweep_store.hpp"
#include "cli/text_table.hpp"
#include "cli/validation_store.hpp"

#include <fmt/format.h>
#include <cmath>
#include <limits>

namespace slipmode::cli {
namespace {

using diagnostics::CandidateReport;
using diagnostics::OrbitRow;
using diagnostics::ShareRow;
using diagnostics::ValidationReport;

std::string motion_text(const diagnostics::PeriodResult& period) {
  if (period.motion == diagnostics::Motion::kPeriodic) return fmt::format("period {}", period.period);
  return diagnostics::to_string(period.motion);
}

Json settled_json(const diagnostics::Settled& settled) {
  return {{"motion", diagnostics::to_string(settled.period.motion)},
          {"period", settled.period.period},
          {"T", settled.period.T},
          {"stick_fraction", settled.stick_fraction},
          {"slip_rate", settled.slip_rate},
          {"mean_energy", settled.mean_energy},
          {"audit_residual", settled.audit_residual}};
}

Json deviation_json(const diagnostics::Deviation& deviation) {
  return {{"dX", deviation.dX}, {"dE", deviation.dE}, {"dE_pointwise", deviation.dE_pointwise}};
}

Json distance_json(const diagnostics::AttractorDistance& distance) {
  return {{"wasserstein", distance.wasserstein},
          {"hausdorff", distance.hausdorff},
          {"mean_energy_percent", distance.mean_energy_percent},
          {"stick_fraction", distance.stick_fraction},
          {"slip_rate", distance.slip_rate}};
}

Json share_json(const ShareRow& row) {
  Json out = {{"modes", row.modes}, {"energy", row.energy}};
  if (!row.failure.empty()) {
    out["failure"] = row.failure;
    return out;
  }
  out["horizon"] = deviation_json(row.horizon);
  out["start_error"] = row.start_error;
  if (row.attractor) {
    out["attractor"] = settled_json(*row.attractor);
    out["distance"] = distance_json(row.distance);
  }
  if (row.lyapunov) out["lyapunov_bits"] = row.lyapunov->bits;
  return out;
}

Json orbit_json(const OrbitRow& row) {
  Json out = {{"speed", row.speed}, {"modes", row.modes}};
  if (!row.failure.empty()) out["failure"] = row.failure;
  if (row.comparison) {
    const auto& comparison = *row.comparison;
    out["period_full"] = comparison.full.period;
    out["period_reduced"] = comparison.reduced.period;
    out["T_full"] = comparison.full.T;
    out["T_reduced"] = comparison.reduced.T;
    if (comparison.same_period) out["deviation"] = deviation_json(comparison.deviation);
  }
  return out;
}

Json motions_json(const std::vector<diagnostics::SweepPoint>& points) {
  Json out = Json::object();
  for (const MotionCount& count : count_motions(points)) out[count.motion] = count.values;
  return out;
}

/// Rows of all candidates side by side: L, then for each its energy, ΔX, ΔE and motion.
std::string shares_text(const ValidationReport& report) {
  std::vector<std::string> header = {"modes"};
  for (const CandidateReport& candidate : report.candidates) {
    for (const char* what : {"energy %", "ΔX %", "ΔE %", "motion", "λ₁ bit"}) {
      header.push_back(fmt::format("{} {}", candidate.name, what));
    }
  }
  TextTable table(header);
  for (std::size_t i = 0; i < report.candidates.front().shares.size(); ++i) {
    std::vector<std::string> cells = {fmt::format("{}", report.candidates.front().shares[i].modes)};
    for (const CandidateReport& candidate : report.candidates) {
      if (i >= candidate.shares.size()) continue;
      const ShareRow& row = candidate.shares[i];
      const bool ok = row.failure.empty();
      const double none = std::numeric_limits<double>::quiet_NaN();
      cells.push_back(fixed(row.energy, 2));
      cells.push_back(fixed(ok ? row.horizon.dX : none, 2));
      cells.push_back(fixed(ok ? row.horizon.dE : none, 2));
      cells.push_back(row.attractor ? motion_text(row.attractor->period) : "failed");
      cells.push_back(fixed(row.lyapunov ? row.lyapunov->bits : none, 4));
    }
    table.add(cells);
  }
  return table.str();
}

std::string orbits_text(const ValidationReport& report) {
  TextTable table({"speed", "modes", "basis", "period full", "reduced", "T full", "T reduced", "ΔX %", "ΔE %"});
  for (const CandidateReport& candidate : report.candidates) {
    for (const OrbitRow& row : candidate.orbits) {
      if (row.modes != report.chosen) continue;
      std::vector<std::string> cells = {fmt::format("{:g}", row.speed), fmt::format("{}", row.modes), candidate.name};
      if (row.comparison) {
        const auto& c = *row.comparison;
        const double none = std::numeric_limits<double>::quiet_NaN();
        cells.insert(cells.end(),
                     {fmt::format("{}", c.full.period), fmt::format("{}", c.reduced.period), fixed(c.full.T, 5),
                      fixed(c.reduced.T, 5), fixed(c.same_period ? c.deviation.dX : none, 3),
                      fixed(c.same_period ? c.deviation.dE : none, 3)});
      } else {
        cells.push_back("none: " + row.failure.substr(0, 50));
      }
      table.add(cells);
    }
  }
  return table.str();
}

std::string sweep_text(const ValidationReport& report) {
  TextTable table({"motion", "full", "reduced"});
  const auto full = count_motions(report.sweep->full);
  const auto reduced = count_motions(report.sweep->reduced);
  const auto find = [](const std::vector<MotionCount>& counts, const std::string& motion) {
    for (const MotionCount& count : counts) {
      if (count.motion == motion) return fmt::format("{}", count.values);
    }
    return std::string("0");
  };
  for (const MotionCount& count : full) {
    table.add({count.motion, fmt::format("{}", count.values), find(reduced, count.motion)});
  }
  for (const MotionCount& count : reduced) {
    if (find(full, count.motion) == "0") table.add({count.motion, "0", fmt::format("{}", count.values)});
  }
  return table.str();
}

}  // namespace

Json to_json(const ValidationReport& report) {
  Json out = {{"speed", report.speed},
              {"chosen_modes", report.chosen},
              {"full", settled_json(report.full)},
              {"noise", distance_json(report.noise)}};
  if (report.lyapunov) {
    out["lyapunov_bits"] = report.lyapunov->bits;
    out["lyapunov_error_nats"] = report.lyapunov->error;
  }
  for (const CandidateReport& candidate : report.candidates) {
    Json shares = Json::array(), orbits = Json::array();
    for (const ShareRow& row : candidate.shares) shares.push_back(share_json(row));
    for (const OrbitRow& row : candidate.orbits) orbits.push_back(orbit_json(row));
    out["bases"][candidate.name] = {{"shares", shares}, {"orbits", orbits}};
  }
  if (report.sweep) {
    out["sweep"] = {{"full", motions_json(report.sweep->full)}, {"reduced", motions_json(report.sweep->reduced)}};
  }
  if (report.bifurcation) {
    const auto& b = *report.bifurcation;
    out["bifurcation"] = {{"values", b.values},
                          {"failed", b.failed},
                          {"same_motion", b.same_motion},
                          {"same_period", b.same_period},
                          {"periodic_full", b.periodic_full},
                          {"periodic_reduced", b.periodic_reduced},
                          {"mean_wasserstein", b.mean_wasserstein},
                          {"median_wasserstein", b.median_wasserstein},
                          {"mean_hausdorff", b.mean_hausdorff}};
  }
  if (report.cost) {
    const auto& c = *report.cost;
    out["cost"] = {{"duration", c.duration},
                   {"full_wall_s", c.full_wall},
                   {"full_cpu_s", c.full_cpu},
                   {"reduced_wall_s", c.reduced_wall},
                   {"reduced_cpu_s", c.reduced_cpu},
                   {"full_setup_wall_s", c.full_setup_wall},
                   {"projection_wall_s", c.projection_wall}};
  }
  return out;
}

std::string summary_text(const ValidationReport& report) {
  std::string out = fmt::format("Full model at speed {:g}: {}", report.speed, motion_text(report.full.period));
  if (report.lyapunov) out += fmt::format(", largest exponent {:.4f} bit per unit of time", report.lyapunov->bits);
  out += '\n';
  out += shares_text(report);
  bool any_orbit = false;
  for (const auto& candidate : report.candidates) any_orbit = any_orbit || !candidate.orbits.empty();
  if (any_orbit) out += fmt::format("\nPeriodic orbits, {} modes\n{}", report.chosen, orbits_text(report));
  if (report.sweep && report.bifurcation) {
    out += fmt::format("\nBelt-speed sweep, {} values, {} {}s\n{}", report.sweep->full.size(), report.chosen,
                       report.candidates.front().name, sweep_text(report));
    out += fmt::format("  same period at {:.1f} % of the values, median distance of slip states {:.3g}\n",
                       100.0 * report.bifurcation->same_period, report.bifurcation->median_wasserstein);
  }
  if (report.cost) {
    const auto& cost = *report.cost;
    out +=
        fmt::format("\nOne run of {:g} time units: full {:.3f} ms, reduced {:.3f} ms, {:.2f} times faster\n",
                    cost.duration, 1e3 * cost.full_wall, 1e3 * cost.reduced_wall, cost.full_wall / cost.reduced_wall);
  }
  return out;
}

}  // namespace slipmode::cli
