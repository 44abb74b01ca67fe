#include "cli/diagnose_sweep.hpp"

#include <slipmode/studies/exponent_sweep.hpp>
#include <slipmode/studies/result_file.hpp>
#include "cli/json_values.hpp"
#include "cli/sweep_request.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <numbers>

namespace slipmode::cli {
namespace {

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
    const auto positive = (nats.array() > diagnostics::kErrorsOfPositive * error.array()).count();
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
  const std::vector<studies::SweptModel> swept = studies::swept_models(scene, over, models.stores(), models.modes);
  studies::ExponentSweepOptions options =
      studies::exponent_sweep_options(scene, swept, models.exponents, models.follow, session.run_options());
  studies::ResultFile file(request.output, scene, results::FileKind::kExponentSweep,
                           studies::command_of(over, swept, options), studies::identity_of(swept), session.division(),
                           studies::pieces(over.values, options));
  options.journal = file.journal();
  const std::vector<studies::ExponentSweep> sweeps =
      studies::exponent_sweeps(swept, over.values, options, session.run_options());
  file.finish([&](results::StoreWriter& writer) { studies::store(writer, swept, sweeps); });
  if (session.has_a_share()) return part_made(session, file.progress(), request.output, "values");
  Report report;
  report.data = {{"verb", "diagnose"}, {"key", over.key}};
  const results::Units units = results::Units::of(scene.units);
  for (std::size_t m = 0; m < swept.size(); ++m) {
    Json summary;
    report.text += exponent_summary(swept[m].title, sweeps[m].points, units, summary);
    report.data["models"].push_back(std::move(summary));
  }
  tell_resumed(session, file.resumed(), "values", report);
  tell_file("Exponents", request.output, report);
  return report;
}

}  // namespace slipmode::cli
