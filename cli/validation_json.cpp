#include <slipmode/results/sweep_store.hpp>
#include "cli/exponents_report.hpp"
#include "cli/json_values.hpp"
#include "cli/validation_report.hpp"

namespace slipmode::cli {
namespace {

using diagnostics::CandidateReport;
using diagnostics::OrbitRow;
using diagnostics::ShareRow;
using diagnostics::ValidationReport;

Json settled_json(const diagnostics::Settled& settled, const std::optional<diagnostics::LyapunovExponent>& exponent) {
  return {{"motion", diagnostics::attractor_word(settled, exponent)},
          {"period", settled.period.period},
          {"T", settled.period.T},
          {"stick_fraction", settled.stick_fraction},
          {"slip_rate", settled.slip_rate},
          {"mean_energy", settled.mean_energy},
          {"audit_residual", settled.audit_residual}};
}

Json distance_json(const diagnostics::AttractorDistance& distance) {
  return merged(fields_json(distance),
                Json{{"stick_fraction", distance.stick_fraction}, {"slip_rate", distance.slip_rate}});
}

Json share_json(const ShareRow& row) {
  Json out = {{"modes", row.modes}, {"energy", row.energy}};
  if (!row.failure.empty()) {
    out["failure"] = row.failure;
    return out;
  }
  out["horizon"] = fields_json(row.horizon);
  out["start_error"] = row.start_error;
  if (row.attractor) {
    out["attractor"] = settled_json(*row.attractor, row.lyapunov);
    out["distance"] = distance_json(row.distance);
  }
  if (row.lyapunov) {
    out["lyapunov_bits"] = row.lyapunov->bits;
    out["lyapunov_error_nats"] = row.lyapunov->error;
  }
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
    if (comparison.same_period) out["deviation"] = fields_json(comparison.deviation);
  }
  return out;
}

Json motions_json(const std::vector<diagnostics::SweepPoint>& points) {
  Json out = Json::object();
  for (const results::MotionCount& count : results::count_motions(points)) out[count.motion] = count.values;
  return out;
}

}  // namespace

Json to_json(const ValidationReport& report) {
  Json out = {{"speed", report.speed},
              {"chosen_modes", report.chosen},
              {"full", settled_json(report.full, report.lyapunov)},
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
  if (report.bifurcation) out["bifurcation"] = fields_json(*report.bifurcation);
  if (report.verdict) {
    out["verdict"] = verdict_json(*report.verdict);
    out["exponents"] = exponents_json(results::exponents_of(*report.verdict));
  }
  if (report.cost) out["cost"] = fields_json(*report.cost);
  return out;
}

}  // namespace slipmode::cli
