#include "cli/validation_report.hpp"

#include <slipmode/results/driven_store.hpp>
#include <slipmode/scene/driven.hpp>
#include "cli/json_values.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::cli {
namespace {

using diagnostics::DrivenCandidateReport;
using diagnostics::DrivenRow;
using diagnostics::DrivenValidationReport;

Json peaks_json(const std::vector<diagnostics::AmplitudePeak>& peaks) {
  Json out = Json::array();
  for (const auto& peak : peaks) out.push_back({{"frequency", peak.parameter}, {"amplitude", peak.amplitude}});
  return out;
}

Json agreement_json(const diagnostics::DrivenAgreement& agreement) {
  return merged({{"values", agreement.values}, {"failed", agreement.failed}}, fields_json(agreement));
}

Json row_json(const DrivenRow& row) {
  if (!row.failure.empty()) return {{"modes", row.modes}, {"failure", row.failure}};
  Json out = merged({{"modes", row.modes}}, agreement_json(row.agreement));
  out["trusted_share"] = row.trusted_share;
  out["band"] = {row.band.first, row.band.second};
  out["peaks"] = peaks_json(row.peaks);
  out["cost"] = fields_json(row.cost);
  return out;
}

std::string candidate_text(const DrivenCandidateReport& candidate, const DrivenValidationReport& report,
                           const std::string& unit) {
  TextTable table({"L", "distance", "median", "Hausdorff", "same label [%]", "same period [%]", "trusted [%]",
                   "trusted band" + unit, "time [ms]", "full/reduced"});
  const auto percent = [](double share) { return fixed(100.0 * share, 1); };
  for (const DrivenRow& row : candidate.rows) {
    if (!row.failure.empty()) {
      table.add({fmt::format("{}", row.modes), "failed"});
      continue;
    }
    const auto& a = row.agreement;
    const bool timed = row.cost.wall > 0.0;
    table.add({fmt::format("{}", row.modes), fmt::format("{:.3g}", a.mean_wasserstein),
               fmt::format("{:.3g}", a.median_wasserstein), fmt::format("{:.3g}", a.mean_hausdorff),
               percent(a.same_label), percent(a.same_period), percent(row.trusted_share),
               std::isnan(row.band.first) ? "none" : fmt::format("{:g} to {:g}", row.band.first, row.band.second),
               timed ? significant(1e3 * row.cost.wall, 3) : "–",
               timed ? fixed(report.cost.wall / row.cost.wall, 1) : "–"});
  }
  std::string out = fmt::format("{}: {}\n{}", candidate.name,
                                candidate.trusted_from > 0 ? fmt::format("trusted from L = {}", candidate.trusted_from)
                                                           : std::string("not trusted at any L tried"),
                                table.str());
  for (const DrivenRow& row : candidate.rows) {
    if (!row.failure.empty()) out += fmt::format("  L = {}: {}\n", row.modes, row.failure);
  }
  return out;
}

}  // namespace

Json to_json(const DrivenValidationReport& report) {
  Json out = {{"noise", agreement_json(report.noise)},
              {"peaks", peaks_json(report.peaks)},
              {"cost", fields_json(report.cost)},
              {"sweeps_wall_s", report.sweeps_wall}};
  out["bases"] = Json::array();
  for (const DrivenCandidateReport& candidate : report.candidates) {
    Json rows = Json::array();
    for (const DrivenRow& row : candidate.rows) rows.push_back(row_json(row));
    out["bases"].push_back({{"basis", candidate.name}, {"trusted_from", candidate.trusted_from}, {"rows", rows}});
  }
  return out;
}

std::string summary_text(const DrivenValidationReport& report, const scene::Scene& scene) {
  std::string out = fmt::format("Full against reduced at {} {}: {} at the sections of {:g} cycles of {:g}\n",
                                report.full.size(), report.full.size() == 1 ? "frequency" : "frequencies",
                                reading_name(scene), scene.driven.kept, scene.driven.cycles);
  for (const results::MotionCount& count : results::count_motions(report.full))
    out += fmt::format("  {:5} {}\n", count.values, count.motion);
  out += results::unsettled_note(report.full, scene.driven.cycles);
  out += fmt::format(
      "  distances: Wasserstein-1 of section points over the full model's root mean square, mean over frequencies\n"
      "  two full sweeps from different starts: {:.3g} (median {:.3g}), same label {} %, same period {} %\n"
      "  trusted: a distance up to 0.1, or twice that of the two full sweeps\n"
      "  peaks of the full model at {}\n",
      report.noise.mean_wasserstein, report.noise.median_wasserstein, fixed(100.0 * report.noise.same_label, 1),
      fixed(100.0 * report.noise.same_period, 1), results::peaks_text(report.peaks));
  if (report.cost.wall > 0.0) {
    out += fmt::format("  time of {:g} cycles at {} = {:g}, full model: {:.3g} ms\n", scene.driven.cost_cycles,
                       drive_key(scene), scene::drive_parameter(scene), 1e3 * report.cost.wall);
  }
  const std::string unit = results::sweep_axis(scene, drive_key(scene)).units;
  for (const DrivenCandidateReport& candidate : report.candidates)
    out += '\n' + candidate_text(candidate, report, unit == "1" ? "" : fmt::format(" [{}]", unit));
  return out;
}

}  // namespace slipmode::cli
