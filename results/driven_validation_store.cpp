#include <slipmode/results/driven_validation_store.hpp>

#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/scene/driven.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <string>
#include <vector>

namespace slipmode::results {
namespace {

using diagnostics::DrivenCandidateReport;
using diagnostics::DrivenRow;
using diagnostics::DrivenValidationReport;

/// A group's name of a basis: letters only.
std::string group_name(const DrivenCandidateReport& candidate, const DrivenRow& row) {
  std::string name = candidate.name;
  std::replace(name.begin(), name.end(), '+', '_');
  return fmt::format("{}/models/{}_{:02}", kDrivenValidationGroup, name, row.modes);
}

/// @param unit  of the drive's frequency
Table agreement_table(const DrivenValidationReport& report, const std::string& unit) {
  std::vector<std::string> basis, failure;
  std::vector<double> modes, trusted, from, to;
  std::vector<const DrivenRow*> rows;
  for (const DrivenCandidateReport& candidate : report.candidates) {
    for (const DrivenRow& row : candidate.rows) {
      rows.push_back(&row);
      basis.push_back(candidate.name);
      modes.push_back(static_cast<double>(row.modes));
      trusted.push_back(row.trusted_share);
      from.push_back(row.band.first);
      to.push_back(row.band.second);
      failure.push_back(row.failure);
    }
  }
  return {"reduced models against the full one; distances in units of the full model's root mean square",
          joined({{{"basis", {"", "what the vectors are"}, basis}, {"modes", {"", "number of modes L"}, modes}},
                  columns_of(rows, &DrivenRow::agreement),
                  {{"trusted_share", {"1", "share of values where the distance is within what is trusted"}, trusted},
                   {"band_from", {unit, "longest run of trusted values: first"}, from},
                   {"band_to", {unit, "longest run of trusted values: last"}, to}},
                  columns_of(rows, &DrivenRow::cost),
                  {{"failure", {"", "why there is no such model; empty: there is"}, failure}}})};
}

}  // namespace

void store_driven_validation(StoreWriter& writer, const DrivenValidationReport& report, const scene::Scene& scene) {
  const Units units = Units::of(scene.units);
  const DrivenAxes axes{sweep_axis(scene, drive_key(scene)), reading_name(scene), reading_unit(scene)};
  const std::string group = kDrivenValidationGroup;
  save(writer, group + "/agreement", agreement_table(report, axes.swept.units));
  writer.write(group + "/noise", report.noise.mean_wasserstein,
               {"1", "mean distance between two full sweeps from different starts"});
  writer.write(group + "/noise_at", report.noise.wasserstein, {"1", "the same at each value"});
  writer.write(group + "/full_wall", report.cost.wall,
               {"s", "median clock time of a timed run of the full model", Meaning::Of::kClock});
  writer.write(group + "/full_cpu", report.cost.cpu, {"s", "its processor time", Meaning::Of::kClock});
  store_driven(writer, group + "/full", "full model", axes, units, report.full, SectionDetail::kReading);
  store_driven(writer, group + "/again", "full model from another start", axes, units, report.again,
               SectionDetail::kReading);
  for (const DrivenCandidateReport& candidate : report.candidates) {
    for (const DrivenRow& row : candidate.rows) {
      if (!row.failure.empty()) continue;
      const std::string name = group_name(candidate, row);
      store_driven(writer, name, fmt::format("{}, L = {}", candidate.name, row.modes), axes, units, row.points,
                   SectionDetail::kReading);
      writer.write(name + "/distance", row.agreement.wasserstein, {"1", "distance to the full model at each value"});
    }
  }
}

}  // namespace slipmode::results
