#include "cli/diagnose_sweep.hpp"

#include <slipmode/studies/exponent_sweep.hpp>
#include <slipmode/studies/result_file.hpp>
#include "cli/json_values.hpp"
#include "cli/sweep_request.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace slipmode::cli {
namespace {

constexpr Eigen::Index kSweptExponents = 4;
/// Time measured at each value, of that of a single spectrum.
constexpr double kSweptShare = 0.25;

/// One model over the key.
struct SweptModel {
  std::string title, role;  ///< role: "full" or "reduced"
  studies::Family family;
};

std::vector<SweptModel> swept_models(const scene::Scene& scene, const std::string& key, const ModelRequest& request) {
  if (request.files.size() > 1)
    throw InvalidInput(fmt::format("--over: expected one file of MODELS at most beside the full model, found {}",
                                   request.files.size()));
  const studies::Family full(scene, {key});
  std::vector<SweptModel> models = {{.title = full.title(), .role = "full", .family = full}};
  // Of a POD, which gives POMs and LNMs, the kind that [reduction] names: it comes first.
  const studies::Subjects subjects = studies::subjects_of(scene, request.stores(), request.modes);
  if (subjects.bases.empty()) return models;
  const pod::NamedBasis& basis = subjects.bases.front();
  models.push_back({.title = fmt::format("reduced model, {}", basis.name),
                    .role = "reduced",
                    .family = studies::Family(scene, {key}, basis)});
  return models;
}

/// A line of the summary: at how many values the motion is chaotic, and hyperchaotic.
std::string exponent_summary(const std::string& title, const std::vector<results::ExponentPoint>& points,
                             const results::Units& units, Json& out_json) {
  std::size_t chaotic = 0, hyper = 0, failed = 0;
  double largest = -std::numeric_limits<double>::infinity();
  for (const results::ExponentPoint& point : points) {
    const auto& [nats, error, ended] = point.settled;
    if (nats.size() == 0) {
      ++failed;
      continue;
    }
    const auto positive = (nats.array() > 4.0 * error.array()).count();
    chaotic += positive > 0 ? 1 : 0;
    hyper += positive > 1 ? 1 : 0;
    largest = std::max(largest, nats[0]);
  }
  out_json = {{"model", title},        {"values", points.size()}, {"chaotic", chaotic},
              {"two_positive", hyper}, {"failed", failed},        {"largest_nats", json_number(largest)}};
  return fmt::format("{}: {} values, {} with a positive exponent, {} with two or more, {} failed; largest {:.4g} {}\n",
                     title, points.size(), chaotic, hyper, failed, largest / std::numbers::ln2, units.bit_rate());
}

}  // namespace

Report diagnose_over(const Session& session, const scene::Scene& scene, const DiagnoseRequest& request,
                     const ModelRequest& models) {
  if (request.output.empty()) throw InvalidInput("--over: expected a result file for the sweep; give one with -o");
  const studies::Over over = parse_over(models.over);
  studies::check_values(scene, over.key, over.values);
  const std::vector<SweptModel> swept = swept_models(scene, over.key, models);
  diagnostics::TangentOptions tangent =
      studies::tangent_options(scene, swept.front().family.own(), models.exponents, session.run_options());
  if (models.exponents.exponents == 0) tangent.exponents = kSweptExponents;
  if (!models.exponents.duration) tangent.duration *= kSweptShare;

  std::string identity;
  for (const std::string& file : models.files) identity += studies::identity_of(std::filesystem::path(file));
  studies::ExponentSweepOptions options{.tangent = tangent, .follow = models.follow};
  studies::ResultFile file(
      request.output, scene, results::FileKind::kExponentSweep,
      fmt::format("slipmode diagnose --over {}{} --exponents {} --transient {} --duration {} --renormalise {} {}",
                  studies::over_text(over), models.follow ? " --follow" : "", tangent.exponents, tangent.transient,
                  tangent.duration, tangent.interval, swept.back().title),
      identity, session.division(), studies::pieces(over.values, options));
  options.journal = file.journal();
  std::vector<studies::Family> families;
  families.reserve(swept.size());
  for (const SweptModel& model : swept) families.push_back(model.family);
  const std::vector<studies::ExponentSweep> sweeps =
      studies::exponent_sweeps(families, over.values, options, session.run_options());

  Report report;
  report.data = {{"verb", "diagnose"}, {"file", request.output}, {"key", over.key}};
  const results::Units units = results::Units::of(scene.units);
  file.finish([&](results::StoreWriter& writer) {
    for (std::size_t m = 0; m < swept.size(); ++m) {
      const auto& [title, role, family] = swept[m];
      if (!sweeps[m].diagram.empty())
        results::store_sweep(writer, "sweep/" + role, title, family.axis(), units, sweeps[m].diagram);
      results::store_exponent_sweep(writer, "exponents/" + role, title, family.axis(), units, sweeps[m].points);
    }
  });
  if (session.has_a_share()) return part_made(session, file.progress(), request.output, "values");
  for (std::size_t m = 0; m < swept.size(); ++m) {
    Json summary;
    report.text += exponent_summary(swept[m].title, sweeps[m].points, units, summary);
    report.data["models"].push_back(std::move(summary));
  }
  tell_resumed(session, file.resumed(), "values", report);
  report.text += fmt::format("Exponents: {}\n", request.output);
  return report;
}

}  // namespace slipmode::cli
