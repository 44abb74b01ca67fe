#include "cli/diagnose_sweep.hpp"

#include <slipmode/core/none.hpp>
#include <slipmode/diagnostics/validation/shared_starts.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/sweep_store.hpp>
#include "cli/json_values.hpp"
#include "cli/sweep_report.hpp"
#include "cli/sweep_request.hpp"
#include "cli/swept_model.hpp"
#include "cli/validation_setup.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>

namespace slipmode::cli {
namespace {

constexpr Eigen::Index kSweptExponents = 4;
/// Time measured at each value, of that of a single spectrum.
constexpr double kSweptShare = 0.25;

/// One model over the key.
struct SweptModel {
  std::string title, role;  ///< role: "full" or "reduced"
  diagnostics::Model model;
  dynamics::State start;
  std::vector<diagnostics::SweepPoint> points = {};  ///< of the bifurcation diagram; empty where there is none
};

/// Exponents at one value.
struct ExponentPoint {
  Eigen::VectorXd nats, error;
  std::string failure;
};

std::vector<SweptModel> swept_models(const scene::Scene& scene, const Over& over, const ModelRequest& request) {
  if (request.files.size() > 1)
    throw InvalidInput(fmt::format("--over: expected one file of MODELS at most beside the full model, found {}",
                                   request.files.size()));
  // Of a POD, which gives POMs and LNMs, the kind that [reduction] names: it comes first.
  DiagnoseSubjects subjects = diagnose_subjects(scene, request);
  if (subjects.candidates.size() > 1)
    subjects.candidates.erase(subjects.candidates.begin() + 1, subjects.candidates.end());
  std::vector<SweptModel> models = {{.title = fmt::format("full model, {} degrees of freedom", subjects.full.size()),
                                     .role = "full",
                                     .model = swept_model(scene, over.key),
                                     .start = subjects.start}};
  for (const diagnostics::VerdictCandidate& candidate : subjects.candidates) {
    models.push_back({.title = fmt::format("reduced model, {}", candidate.name),
                      .role = "reduced",
                      .model = swept_model(scene, over.key, candidate.basis),
                      .start = diagnostics::on_subspace(subjects.full.structure(), candidate.basis, subjects.start)});
    models.back().start.time = subjects.start.time;
  }
  return models;
}

/// The diagram of one model, its points kept under the model's number.
bool draw_diagram(const Session& session, const scene::Scene& scene, const Over& over, const ModelRequest& request,
                  results::Journal& journal, int number, SweptModel& model) {
  const diagnostics::SweepSink kept = results::journal_sink(journal);
  ProgressLine line(fmt::format("diagram {}", model.role), session.progress_mode());
  diagnostics::SweepOptions options{
      .mode = request.follow ? diagnostics::SweepMode::kFollow : diagnostics::SweepMode::kIndependent,
      .settle = sweep_settle_options(scene),
      .parallel = session.parallel(line),
      .sink = {.recall = [&](std::size_t index, int) { return kept.recall(index, number); },
               .store =
                   [&](const diagnostics::SweepPoint& point) {
                     diagnostics::SweepPoint own = point;
                     own.model = number;
                     kept.store(own);
                   }}};
  diagnostics::SweepResult result = diagnostics::sweep(model.model, over.values, model.start, options);
  model.points = std::move(result.points);
  return !result.interrupted;
}

results::JournalRecord exponent_record(const std::string& role, std::size_t index, const ExponentPoint& point) {
  std::vector<double> values(point.nats.begin(), point.nats.end());
  values.insert(values.end(), point.error.begin(), point.error.end());
  return {role, static_cast<std::int64_t>(index), values, point.failure};
}

ExponentPoint exponent_point(const results::JournalRecord& record) {
  const auto count = static_cast<Eigen::Index>(record.values.size() / 2);
  const Eigen::Map<const Eigen::VectorXd> values(record.values.data(), 2 * count);
  return {.nats = values.head(count), .error = values.tail(count), .failure = record.note};
}

ExponentPoint measure_at(const SweptModel& model, std::size_t index, double value,
                         diagnostics::TangentOptions options) {
  ExponentPoint out;
  dynamics::State start = model.start;
  if (!model.points.empty()) {
    const auto point = std::ranges::find(model.points, index, &diagnostics::SweepPoint::index);
    if (!point->ok()) return {.nats = {}, .error = {}, .failure = point->failure};
    start = point->settled.end;
    options.transient = 0.0;
  }
  try {
    const dynamics::HybridSystem system = model.model.system(value);
    const Eigen::Index all = 2 * system.size() + system.internal_size();
    options.exponents = std::min(options.exponents, all);
    const diagnostics::LyapunovSpectrum spectrum = diagnostics::lyapunov_spectrum(system, start, options);
    out = {.nats = spectrum.nats, .error = spectrum.error, .failure = spectrum.failure};
  } catch (const NumericalFailure& failure) {
    out.failure = fmt::format("at time {:g}: {}", failure.time, failure.what());
  }
  return out;
}

/// One row per exponent, one column per value.
Eigen::MatrixXd exponent_columns(const std::vector<ExponentPoint>& points, Eigen::VectorXd ExponentPoint::*part) {
  Eigen::Index rows = 0;
  for (const ExponentPoint& point : points) rows = std::max(rows, point.nats.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(rows, static_cast<Eigen::Index>(points.size()), kNone);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::VectorXd& values = points[i].*part;
    out.col(static_cast<Eigen::Index>(i)).head(values.size()) = values;
  }
  return out;
}

void store_exponents_over(results::StoreWriter& writer, const SweptModel& model, const Over& over,
                          const std::vector<ExponentPoint>& points, const results::SweepAxis& axis,
                          const results::Units& units) {
  const std::string group = fmt::format("exponents/{}", model.role);
  std::vector<std::string> failure;
  for (const ExponentPoint& point : points) failure.push_back(point.failure);
  writer.describe_group(group, "leading Lyapunov exponents over a key: " + model.title);
  writer.write(group + "/title", model.title, {"", "which model"});
  writer.write(group + "/key", axis.key, {"", "the scene's key that was swept"});
  writer.write(group + "/label", axis.label, {"", "name of the key for an axis"});
  results::save(writer, group + "/values",
                results::Table{"one row per value of the key",
                               {{"parameter", {axis.units, axis.key}, over.values},
                                {"failure", {"", "why the value failed or ended early; empty: it did not"}, failure}}});
  writer.write_columns(group + "/nats", exponent_columns(points, &ExponentPoint::nats),
                       {units.rate, "exponents, value x exponent"});
  writer.write_columns(group + "/error", exponent_columns(points, &ExponentPoint::error),
                       {units.rate, "standard errors, value x exponent"});
}

/// A line of the summary: at how many values the motion is chaotic, and hyperchaotic.
std::string exponent_summary(const SweptModel& model, const std::vector<ExponentPoint>& points, Json& json) {
  std::size_t chaotic = 0, hyper = 0, failed = 0;
  double largest = -std::numeric_limits<double>::infinity();
  for (const ExponentPoint& point : points) {
    if (point.nats.size() == 0) {
      ++failed;
      continue;
    }
    const auto positive = (point.nats.array() > 4.0 * point.error.array()).count();
    chaotic += positive > 0 ? 1 : 0;
    hyper += positive > 1 ? 1 : 0;
    largest = std::max(largest, point.nats[0]);
  }
  json = {{"model", model.title},  {"values", points.size()}, {"chaotic", chaotic},
          {"two_positive", hyper}, {"failed", failed},        {"largest_nats", json_number(largest)}};
  return fmt::format(
      "{}: {} values, {} with a positive exponent, {} with two or more, {} failed; largest {:.4f} bit per unit of "
      "time\n",
      model.title, points.size(), chaotic, hyper, failed, largest / std::numbers::ln2);
}

}  // namespace

Report diagnose_over(const Session& session, const scene::Scene& scene, const DiagnoseRequest& request,
                     const ModelRequest& models) {
  if (request.output.empty()) throw InvalidInput("--over: expected a result file for the sweep; give one with -o");
  const Over over = parse_over(models.over);
  check_values(scene, over);
  std::vector<SweptModel> swept = swept_models(scene, over, models);
  diagnostics::TangentOptions options = tangent_options(session, scene, scene::build_system(scene), models);
  if (models.exponents == 0) options.exponents = kSweptExponents;
  if (!models.duration) options.duration *= kSweptShare;

  const std::string task = fmt::format("slipmode diagnose --over {}{} --exponents {} --duration {} --renormalise {} {}",
                                       models.over, models.follow ? " --follow" : "", options.exponents,
                                       options.duration, options.interval, swept.back().title);
  std::string identity = fmt::format("{}\n{}\n{}", results::version(), task, scene::scene_to_toml(scene));
  for (const std::string& file : models.files) identity += fmt::format("\n{}", file_fingerprint(file));
  results::Journal journal(results::Journal::path_for(request.output), results::fingerprint(identity));
  const bool belt = scene::build_system(scene).drive().belt() != nullptr;
  for (std::size_t m = 0; belt && m < swept.size(); ++m)
    if (!draw_diagram(session, scene, over, models, journal, static_cast<int>(m), swept[m])) throw Interrupted();

  const std::size_t count = over.values.size();
  std::vector<std::vector<ExponentPoint>> points(swept.size(), std::vector<ExponentPoint>(count));
  std::vector<char> known(swept.size() * count, 0);
  for (const results::JournalRecord& record : journal.records()) {
    const auto model = std::ranges::find(swept, record.table.substr(record.table.find('-') + 1), &SweptModel::role);
    if (!record.table.starts_with("exponents-") || model == swept.end()) continue;
    const auto m = static_cast<std::size_t>(model - swept.begin()), i = static_cast<std::size_t>(record.index);
    points[m][i] = exponent_point(record);
    known[m * count + i] = 1;
  }
  {
    ProgressLine line("exponents", session.progress_mode());
    std::mutex keeping;
    rethrow_first(parallel_for(swept.size() * count, session.parallel(line), [&](std::size_t item) {
      const std::size_t m = item / count, i = item % count;
      if (known[item]) return;
      points[m][i] = measure_at(swept[m], i, over.values[i], options);
      const std::scoped_lock lock(keeping);
      journal.append(exponent_record(fmt::format("exponents-{}", swept[m].role), i, points[m][i]));
    }));
  }

  const results::Units units = results::Units::of(scene.units);
  const results::SweepAxis axis = results::sweep_axis(scene, over.key);
  Report report;
  report.data = {{"verb", "diagnose"}, {"file", request.output}, {"key", over.key}};
  results::StoreWriter writer(request.output, scene.units);
  results::save(writer, results::provenance_of(scene, task));
  for (std::size_t m = 0; m < swept.size(); ++m) {
    if (belt)
      results::store_sweep(writer, fmt::format("sweep/{}", swept[m].role), swept[m].title, axis, units,
                           swept[m].points);
    store_exponents_over(writer, swept[m], over, points[m], axis, units);
    Json summary;
    report.text += exponent_summary(swept[m], points[m], summary);
    report.data["models"].push_back(summary);
  }
  writer.commit();
  journal.remove();
  report.text += fmt::format("Exponents: {}\n", request.output);
  return report;
}

}  // namespace slipmode::cli
