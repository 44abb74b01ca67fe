#include "cli/shaken_validation.hpp"
#include "cli/validation_report.hpp"

#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/table.hpp>
#include "cli/shaken_model.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::cli {
namespace {

using diagnostics::DrivenCandidateReport;
using diagnostics::DrivenRow;
using diagnostics::DrivenValidationReport;

/// Names the models compared to the last bit, so that a journal of other models is never taken over.
std::string identity(const scene::Scene& scene, const std::vector<diagnostics::DrivenCandidate>& candidates) {
  std::string text = fmt::format("{} validate\n{}", results::version(), scene::scene_to_toml(scene));
  for (const auto& candidate : candidates) {
    const Eigen::MatrixXd& vectors = candidate.basis.vectors;
    text += candidate.name;
    text.append(reinterpret_cast<const char*>(vectors.data()),
                static_cast<std::size_t>(vectors.size()) * sizeof(double));
  }
  return results::fingerprint(text);
}

diagnostics::DrivenValidationOptions options_of(const scene::Scene& scene) {
  const auto& spec = scene.shaken;
  diagnostics::DrivenValidationOptions options;
  options.values = spec.frequencies ? spec.frequencies->values() : std::vector{scene::drive_parameter(scene)};
  options.modes.assign(spec.modes.begin(), spec.modes.end());
  options.mode = spec.follow == scene::ShakenValidationSpec::Follow::kNone ? diagnostics::SweepMode::kIndependent
                                                                           : diagnostics::SweepMode::kFollow;
  options.driven = driven_options(scene);
  options.cost_parameter = scene::drive_parameter(scene);
  options.cost_cycles = spec.cost_cycles;
  options.cost_repeats = spec.cost_repeats;
  return options;
}

/// A group's name of a basis: letters only.
std::string group_name(const DrivenCandidateReport& candidate, const DrivenRow& row) {
  std::string name = candidate.name;
  std::replace(name.begin(), name.end(), '+', '_');
  return fmt::format("{}/models/{}_{:02}", kShakenValidationGroup, name, row.modes);
}

results::Table agreement_table(const DrivenValidationReport& report) {
  std::vector<std::string> basis, failure;
  std::vector<double> modes, mean, median, hausdorff, label, period, trusted, from, to, wall, cpu, setup;
  for (const DrivenCandidateReport& candidate : report.candidates) {
    for (const DrivenRow& row : candidate.rows) {
      basis.push_back(candidate.name);
      modes.push_back(static_cast<double>(row.modes));
      mean.push_back(row.agreement.mean_wasserstein);
      median.push_back(row.agreement.median_wasserstein);
      hausdorff.push_back(row.agreement.mean_hausdorff);
      label.push_back(row.agreement.same_label);
      period.push_back(row.agreement.same_period);
      trusted.push_back(row.trusted_share);
      from.push_back(row.band.first);
      to.push_back(row.band.second);
      wall.push_back(row.cost.wall);
      cpu.push_back(row.cost.cpu);
      setup.push_back(row.cost.setup);
      failure.push_back(row.failure);
    }
  }
  return {"reduced models against the full one; distances in units of the full model's root mean square",
          {{"basis", {"", "what the vectors are"}, basis},
           {"modes", {"", "number of modes L"}, modes},
           {"mean_distance", {"1", "Wasserstein-1 distance of section points, mean over values"}, mean},
           {"median_distance", {"1", "the same, median"}, median},
           {"mean_hausdorff", {"1", "Hausdorff distance of section points, mean over values"}, hausdorff},
           {"same_label", {"1", "share of values with the same label"}, label},
           {"same_period", {"1", "share of values with the same period"}, period},
           {"trusted_share", {"1", "share of values where the distance is within what is trusted"}, trusted},
           {"band_from", {"Hz", "longest run of trusted values: first"}, from},
           {"band_to", {"Hz", "longest run of trusted values: last"}, to},
           {"wall", {"s", "median clock time of a timed run", results::Meaning::Of::kClock}, wall},
           {"cpu", {"s", "median processor time of a timed run", results::Meaning::Of::kClock}, cpu},
           {"setup", {"s", "projection and modal data", results::Meaning::Of::kClock}, setup},
           {"failure", {"", "why there is no such model; empty: there is"}, failure}}};
}

void store(results::StoreWriter& writer, const DrivenValidationReport& report, const scene::Scene& scene) {
  const results::Units units = results::Units::of(scene.units);
  const results::DrivenAxes axes{results::sweep_axis(scene, "drive.frequency"), reading_name(scene),
                                 reading_unit(scene)};
  const std::string group = kShakenValidationGroup;
  results::save(writer, group + "/agreement", agreement_table(report));
  writer.write(group + "/noise", report.noise.mean_wasserstein,
               {"1", "mean distance between two full sweeps from different starts"});
  writer.write(group + "/noise_at", report.noise.wasserstein, {"1", "the same at each value"});
  writer.write(group + "/full_wall", report.cost.wall,
               {"s", "median clock time of a timed run of the full model", results::Meaning::Of::kClock});
  writer.write(group + "/full_cpu", report.cost.cpu, {"s", "its processor time", results::Meaning::Of::kClock});
  results::store_driven(writer, group + "/full", "full model", axes, units, report.full,
                        results::SectionDetail::kReading);
  results::store_driven(writer, group + "/again", "full model from another start", axes, units, report.again,
                        results::SectionDetail::kReading);
  for (const DrivenCandidateReport& candidate : report.candidates) {
    for (const DrivenRow& row : candidate.rows) {
      if (!row.failure.empty()) continue;
      const std::string name = group_name(candidate, row);
      results::store_driven(writer, name, fmt::format("{}, L = {}", candidate.name, row.modes), axes, units, row.points,
                            results::SectionDetail::kReading);
      writer.write(name + "/distance", row.agreement.wasserstein, {"1", "distance to the full model at each value"});
    }
  }
}

Json peaks_json(const std::vector<diagnostics::AmplitudePeak>& peaks) {
  Json out = Json::array();
  for (const auto& peak : peaks) out.push_back({{"frequency", peak.parameter}, {"amplitude", peak.amplitude}});
  return out;
}

Json agreement_json(const diagnostics::DrivenAgreement& agreement) {
  return {{"values", agreement.values},
          {"failed", agreement.failed},
          {"mean_distance", agreement.mean_wasserstein},
          {"median_distance", agreement.median_wasserstein},
          {"mean_hausdorff", agreement.mean_hausdorff},
          {"same_label", agreement.same_label},
          {"same_period", agreement.same_period}};
}

Json row_json(const DrivenRow& row) {
  if (!row.failure.empty()) return {{"modes", row.modes}, {"failure", row.failure}};
  Json out = {{"modes", row.modes}};
  out.update(agreement_json(row.agreement));
  out["trusted_share"] = row.trusted_share;
  out["band"] = {row.band.first, row.band.second};
  out["peaks"] = peaks_json(row.peaks);
  out["cost"] = {{"wall_s", row.cost.wall}, {"cpu_s", row.cost.cpu}, {"setup_s", row.cost.setup}};
  return out;
}

std::string candidate_text(const DrivenCandidateReport& candidate, const DrivenValidationReport& report) {
  TextTable table({"L", "distance", "median", "Hausdorff", "same label [%]", "same period [%]", "trusted [%]",
                   "trusted band [Hz]", "time [ms]", "full/reduced"});
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
               timed ? fixed(1e3 * row.cost.wall, 1) : "–", timed ? fixed(report.cost.wall / row.cost.wall, 1) : "–"});
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

DrivenValidationReport validate_shaken_into(const Session& session, const scene::Scene& scene,
                                            const std::vector<diagnostics::DrivenCandidate>& candidates,
                                            const std::filesystem::path& file) {
  const diagnostics::DrivenCase full = shaken_case(scene);
  results::Journal journal(results::Journal::path_for(file), identity(scene, candidates));
  DrivenValidationReport report;
  {
    ProgressLine line("validate", session.progress_mode());
    auto options = options_of(scene);
    options.parallel = session.parallel(line);
    options.sink = results::driven_journal_sink(journal);
    report = diagnostics::validate_driven(full, drive_over_frequency(scene), candidates,
                                          scene::initial_state(scene, full.system), second_start(scene, full.system),
                                          options);
  }
  if (report.interrupted) throw Interrupted();
  results::StoreWriter writer(file, scene.units);
  results::save(writer, results::provenance_of(scene, "slipmode validate"));
  store(writer, report, scene);
  writer.commit();
  journal.remove();
  return report;
}

Json to_json(const DrivenValidationReport& report) {
  Json out = {{"noise", agreement_json(report.noise)},
              {"peaks", peaks_json(report.peaks)},
              {"cost", {{"wall_s", report.cost.wall}, {"cpu_s", report.cost.cpu}, {"setup_s", report.cost.setup}}},
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
                                reading_name(scene), scene.shaken.kept, scene.shaken.cycles);
  for (const results::MotionCount& count : results::count_motions(report.full))
    out += fmt::format("  {:5} {}\n", count.values, count.motion);
  out += fmt::format(
      "  distances: Wasserstein-1 of section points over the full model's root mean square, mean over frequencies\n"
      "  two full sweeps from different starts: {:.3g} (median {:.3g}), same label {:.1f} %, same period {:.1f} %\n"
      "  trusted: a distance up to 0.1, or twice that of the two full sweeps\n"
      "  peaks of the full model at {}\n",
      report.noise.mean_wasserstein, report.noise.median_wasserstein, 100.0 * report.noise.same_label,
      100.0 * report.noise.same_period, results::peaks_text(report.peaks));
  if (report.cost.wall > 0.0) {
    out += fmt::format("  time of {:g} cycles at {:g} Hz, full model: {:.1f} ms\n", scene.shaken.cost_cycles,
                       scene::drive_parameter(scene), 1e3 * report.cost.wall);
  }
  for (const DrivenCandidateReport& candidate : report.candidates) out += '\n' + candidate_text(candidate, report);
  return out;
}

}  // namespace slipmode::cli
