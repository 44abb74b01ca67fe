#include <slipmode/results/series_store.hpp>

#include <slipmode/results/provenance.hpp>
#include <slipmode/results/table.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::results {
namespace {

std::vector<double> whole_numbers(Eigen::Index first, Eigen::Index count) {
  return values_of(
      Eigen::VectorXd::LinSpaced(count, static_cast<double>(first), static_cast<double>(first + count - 1)));
}

template <typename Pick>
std::vector<std::string> texts_of(const std::vector<diagnostics::Finding>& findings, const Pick& pick) {
  std::vector<std::string> out;
  for (const diagnostics::Finding& finding : findings) out.push_back(pick(finding));
  return out;
}

template <typename Pick>
std::vector<double> numbers_of(const std::vector<diagnostics::Finding>& findings, const Pick& pick) {
  std::vector<double> out;
  for (const diagnostics::Finding& finding : findings) out.push_back(pick(finding));
  return out;
}

void save_findings(StoreWriter& store, const std::vector<diagnostics::Finding>& findings) {
  save(store, diagnosis_path("findings"),
       {"every number; error NaN: exact or not known; unit per row",
        joined({{{"key", {"", "short name"}, texts_of(findings, [](const diagnostics::Finding& f) { return f.key; })}},
                columns_of(findings)})});
}

void save_record(StoreWriter& store, const diagnostics::SeriesStudy& study, const SeriesInput& input) {
  const diagnostics::Series& series = study.series;
  store.describe_group(diagnosis_path("series"), "the record as examined");
  store.write(diagnosis_path("series/values"), series.values, {series.unit, "samples"});
  store.write(diagnosis_path("series/start"), input.start, {series.time_unit, "instant of the first sample"});
  store.write(diagnosis_path("series/interval"), series.interval, {series.time_unit, "between samples"});
  store.write(diagnosis_path("series/name"), series.name, {"", "where it was read"});
  store.write(diagnosis_path("series/what"), input.what, {"", "what it is"});
  store.write(diagnosis_path("embedding/delay"), std::int64_t{study.delay.samples}, {"", "delay used [samples]"});
  store.write(diagnosis_path("embedding/dimension"), std::int64_t{study.dimension.value}, {"", "dimension used"});
  store.write(diagnosis_path("embedding/window"), std::int64_t{study.window}, {"", "Theiler window used [samples]"});
}

/// "equal_width_20", as a column of the table.
std::string information_column(const diagnostics::InformationOptions& options) {
  switch (options.estimator) {
    case diagnostics::InformationEstimator::kEqualWidth:
      return fmt::format("equal_width_{}", options.bins);
    case diagnostics::InformationEstimator::kEquiprobable:
      return fmt::format("equal_numbers_{}", options.bins);
    case diagnostics::InformationEstimator::kNearest:
      break;
  }
  return "no_bins";
}

void save_information(StoreWriter& store, const diagnostics::SeriesStudy& study) {
  if (study.information.empty()) return;
  Table table{"average mutual information of s(n) and s(n + lag), one column per estimator",
              {{"lag", {"", "samples"}, whole_numbers(0, study.information.front().bits.size())}}};
  for (const diagnostics::MutualInformation& curve : study.information) {
    table.columns.push_back({information_column(curve.settings),
                             {"bit", fmt::format("±{:.2g} between the halves; first minimum at {} (-1: none)",
                                                 curve.error, curve.first_minimum)},
                             values_of(curve.bits)});
  }
  save(store, diagnosis_path("information"), table);
}

void save_neighbours(StoreWriter& store, const diagnostics::SeriesStudy& study) {
  if (!study.false_neighbours || !study.cao) return;
  const diagnostics::FalseNeighbours& found = *study.false_neighbours;
  save(store, diagnosis_path("neighbours"),
       {"false nearest neighbours (Kennel) and Cao's averages against the dimension",
        {{"dimension", {"", "of the embedding"}, whole_numbers(1, found.share.size())},
         {"share", {"1", "share of false neighbours by either criterion"}, values_of(found.share)},
         {"error", {"1", "half the difference between the halves"}, values_of(found.error)},
         {"by_ratio",
          {"1", fmt::format("next coordinate above {:g} distances", found.settings.ratio)},
          values_of(found.by_ratio)},
         {"by_size",
          {"1", fmt::format("then farther than {:g} deviations", found.settings.size)},
          values_of(found.by_size)},
         {"E1", {"1", "Cao's E1"}, values_of(study.cao->E1)},
         {"E1_error", {"1", "from halves"}, values_of(study.cao->E1_error)},
         {"E2", {"1", "Cao's E2"}, values_of(study.cao->E2)},
         {"E2_error", {"1", "from halves"}, values_of(study.cao->E2_error)}}});
}

void save_fit(StoreWriter& store, const std::string& group, const diagnostics::LinearFit& fit,
              const std::string& unit) {
  store.write(group + "/fit/begin", std::int64_t{fit.begin}, {"", "first point of the line, from 0"});
  store.write(group + "/fit/end", std::int64_t{fit.end}, {"", "one past its last"});
  store.write(group + "/fit/slope", fit.slope, {unit, "of the line"});
  store.write(group + "/fit/intercept", fit.intercept, {"1", "of the line"});
}

void save_divergence(StoreWriter& store, const std::string& name, const diagnostics::Divergence& found,
                     const diagnostics::Series& series) {
  save(store, diagnosis_path(name),
       {fmt::format("mean logarithm of the distance of neighbours, {}", name),
        {{"time", {series.time_unit, "since they were near"}, values_of(found.time)},
         {"mean_log", {"1", "natural logarithm"}, values_of(found.mean_log)}}});
  save_fit(store, diagnosis_path(name), found.region, "nat/" + series.time_unit);
}

void save_correlation(StoreWriter& store, const diagnostics::SeriesStudy& study) {
  const diagnostics::CorrelationDimension& found = *study.correlation;
  save(store, diagnosis_path("correlation"),
       {"correlation sum",
        {{"radius", {study.series.unit, "maximum norm"}, values_of(found.radius)},
         {"C", {"1", "share of pairs within it"}, values_of(found.C)},
         {"local_slope", {"1", "d ln C / d ln r"}, values_of(found.local_slope)}}});
  save_fit(store, diagnosis_path("correlation"), found.plateau, "1");
}

void save_recurrence(StoreWriter& store, const diagnostics::SeriesStudy& study) {
  const diagnostics::Recurrence& plot = *study.recurrence;
  store.describe_group(diagnosis_path("recurrence"), "pairs of points i < j of the plot that are near each other");
  const auto row = [&](Eigen::Index k) {
    return std::vector<std::int64_t>(plot.pairs.row(k).begin(), plot.pairs.row(k).end());
  };
  store.write(diagnosis_path("recurrence/i"), row(0), {"", "earlier point"});
  store.write(diagnosis_path("recurrence/j"), row(1), {"", "later point"});
  store.write(diagnosis_path("recurrence/points"), std::int64_t{plot.points}, {"", "points of the plot"});
  store.write(diagnosis_path("recurrence/interval"), plot.interval,
              {study.series.time_unit, "between points of the plot"});
  store.write(diagnosis_path("recurrence/radius"), plot.settings.radius, {study.series.unit, "largest distance"});
}

void save_curves(StoreWriter& store, const diagnostics::SeriesStudy& study) {
  const diagnostics::Series& series = study.series;
  if (study.autocorrelation) {
    save(store, diagnosis_path("autocorrelation"),
         {"autocorrelation",
          {{"lag", {"", "samples"}, whole_numbers(0, study.autocorrelation->size())},
           {"value", {"1", "autocorrelation"}, values_of(*study.autocorrelation)}}});
  }
  save_information(store, study);
  save_neighbours(store, study);
  if (study.divergence) {
    const bool path_based = study.divergence->settings.method == diagnostics::DivergenceMethod::kTransverse;
    save_divergence(store, path_based ? "across_the_flow" : "rosenstein", *study.divergence, series);
  }
  if (study.kantz) save_divergence(store, "kantz", *study.kantz, series);
  if (study.jacobians) {
    save(store, diagnosis_path("exponents"),
         {"exponents by fitted Jacobians, descending",
          {{"exponent", {"nat/" + series.time_unit, "exponent"}, values_of(study.jacobians->exponents)},
           {"error", {"nat/" + series.time_unit, "standard error"}, values_of(study.jacobians->error)}}});
  }
  if (study.correlation) save_correlation(store, study);
  if (study.spectrum) {
    save(store, diagnosis_path("spectrum"),
         {"averaged amplitude spectrum (Welch)",
          {{"frequency", {"1/" + series.time_unit, "frequency"}, values_of(study.spectrum->frequency_hz)},
           {"amplitude", {series.unit, "of the sine"}, values_of(study.spectrum->amplitude)}}});
  }
  if (study.section) {
    store.write(diagnosis_path("section/time"), study.section->time,
                {series.time_unit, "of each point, from the first sample"});
    store.write_columns(diagnosis_path("section/points"), study.section->points,
                        {series.unit, "delay coordinates, point by point"});
    const bool strobe = study.section->settings.cut == diagnostics::Cut::kStrobe;
    store.write(diagnosis_path("section/cut"), std::string(strobe ? "strobe" : "upward"),
                {"", "where the record was cut"});
  }
  if (study.recurrence) save_recurrence(store, study);
  if (study.surrogates) {
    store.write(diagnosis_path("surrogates/error"), study.surrogates->error,
                {"1", "forecast error of the record [deviations]"});
    store.write(diagnosis_path("surrogates/of_surrogates"), study.surrogates->of_surrogates,
                {"1", "the same of each surrogate"});
  }
}

void save(StoreWriter& store, const diagnostics::SeriesStudy& study, const SeriesInput& input,
          const std::vector<diagnostics::Finding>& findings) {
  store.describe_group(kDiagnosisGroup, fmt::format("what {} is", study.series.name));
  store.write(diagnosis_path("made_by"), fmt::format("slipmode diagnose {} ({})", version(), git_commit()),
              {"", "program and commit"});
  if (study.verdict) {
    store.write(diagnosis_path("verdict"), std::string(diagnostics::to_string(study.verdict->motion)),
                {"", "what the motion is"});
    store.write(diagnosis_path("reason"), study.verdict->reason, {"", "on what grounds"});
  }
  save_record(store, study, input);
  save_findings(store, findings);
  save_curves(store, study);
  std::vector<std::string> tools, reasons;
  for (const diagnostics::ToolFailure& failure : study.failures) {
    tools.emplace_back(diagnostics::to_string(failure.tool));
    reasons.push_back(failure.reason);
  }
  save(store, diagnosis_path("not_run"),
       {"tools that gave nothing", {{"tool", {"", "tool"}, tools}, {"reason", {"", "why"}, reasons}}});
}

}  // namespace

Content content_of(std::shared_ptr<const diagnostics::SeriesStudy> study, SeriesInput input, bool bits) {
  return {.kind = FileKind::kSeries,
          .unit_system = "SI",
          .write = [study = std::move(study), input = std::move(input), bits](StoreWriter& store) {
            save(store, *study, input, diagnostics::findings_of(*study, bits));
          }};
}

}  // namespace slipmode::results
