#include <slipmode/studies/sweep.hpp>

#include <slipmode/diagnostics/validation/driven_compare.hpp>
#include <slipmode/results/driven_store.hpp>
#include <slipmode/results/reduced_file.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/scene/solver_options.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/result_file.hpp>
#include "cli/field_options.hpp"
#include "cli/sweep_report.hpp"
#include "cli/sweep_request.hpp"
#include "cli/times_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::cli {
namespace {

struct SweepRequest {
  std::string scene, over, output;
  std::string model = "full";
  studies::SweepOptions options;
};

template <class Point>
void say_motions(const std::vector<Point>& points, Report& out_report) {
  const MotionTable motions = motion_table(results::count_motions(points), points.size());
  out_report.data["motions"] = motions.json;
  out_report.text += motions.text.str();
}

void say_driven(const SweepRequest& request, const studies::Sweep& sweep, double cycles, Report& out_report) {
  const auto& points = sweep.up.empty() ? sweep.down : sweep.up;
  double audit = 0.0;
  for (const auto& point : points)
    if (point.ok()) audit = std::max(audit, std::abs(point.settled.audit_residual));
  out_report.data["largest_audit_residual"] = audit;
  out_report.text += fmt::format("largest energy residual {:.1e}\n", audit);
  say_motions(points, out_report);
  out_report.text += results::unsettled_note(points, cycles);
  const auto peaks = diagnostics::amplitude_peaks(points);
  out_report.data["peaks"] = Json::array();
  for (const auto& peak : peaks)
    out_report.data["peaks"].push_back({{"value", peak.parameter}, {"amplitude", peak.amplitude}});
  out_report.text += fmt::format("peaks of the amplitude at {}\n", results::peaks_text(peaks));
  if (!request.options.both) return;
  const double share = diagnostics::hysteresis(sweep.up, sweep.down);
  out_report.data["hysteresis"] = share;
  out_report.text += fmt::format("up and down differ at {:.1f} % of the values\n", 100.0 * share);
}

Report summary(const SweepRequest& request, const studies::Family& family, const studies::Sweep& sweep) {
  const std::size_t values = sweep.values.size();
  const std::string& key = family.keys().front();
  Report report;
  report.data = {
      {"verb", "sweep"}, {"file", request.output}, {"model", family.title()}, {"key", key}, {"values", values}};
  report.text = fmt::format("{}: {} values of {}\n", family.title(), values, key);
  Json failures;
  if (sweep.belt.empty()) {
    say_driven(request, sweep, scene::driven_options(family.scene()).cycles, report);
    failures = failures_of(sweep.up.empty() ? sweep.down : sweep.up);
  } else {
    say_motions(sweep.belt, report);
    report.text += results::undecided_note(sweep.belt, results::Units::of(family.scene().units));
    failures = failures_of(sweep.belt);
  }
  report.data["failures"] = failures;
  report.text += fmt::format("Sweep: {}\n", request.output);
  report_failures(report, failures, values);
  return report;
}

/// How far it got, of both passes where there are two.
Report interrupted(const Session& session, const SweepRequest& request, std::size_t values,
                   const studies::ResultFile& file) {
  const std::size_t all = values * (request.options.both ? 2 : 1), finished = file.finished();
  const std::string of = session.shard ? "" : fmt::format(" of {}", all);
  Report report = interrupted_at(request.output, fmt::format("with {}{} values done", finished, of));
  report.data["verb"] = "sweep";
  report.data["finished"] = finished;
  if (!session.shard) report.data["values"] = all;
  return report;
}

Report run(const Session& session, SweepRequest request) {
  require_writable(request.output);
  const studies::Over over = parse_over(request.over);
  const scene::Scene scene = scene::with_own_times(session.load(request.scene));
  studies::check(scene, request.options);
  const studies::RunOptions run_options = session.run_options();
  const auto basis = studies::model_basis(scene, request.model, run_options);
  const studies::Family family(scene, {over.key}, basis);
  studies::check_values(scene, over.key, over.values);
  studies::ResultFile file(request.output, scene, results::FileKind::kSweep,
                           studies::command_of(over, request.model, request.options),
                           basis ? studies::identity_of(basis->basis) : "full", session.division(),
                           studies::pieces(over.values, request.options));
  request.options.journal = file.journal();
  const studies::Sweep sweep = studies::sweep(family, over.values, request.options, run_options);
  if (sweep.interrupted) return interrupted(session, request, over.values.size(), file);
  file.finish([&](results::StoreWriter& writer) { studies::store(writer, family, sweep); });
  if (session.has_a_share()) return part_made(session, file.progress(), request.output, "values");
  Report report = summary(request, family, sweep);
  tell_without_slips(scene, report);
  tell_chosen_times(scene, {"validation.transient", "validation.block", "validation.sweep_limit"}, report);
  tell_resumed(session, file.resumed(), "values", report);
  return report;
}

}  // namespace

Verb add_sweep(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("sweep", "settled motion against one key of the scene, on a belt, under a shaker or a force");
  const auto arguments = std::make_shared<SweepRequest>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("--over", arguments->over, "key and range: KEY=FROM:TO:STEP")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  add_fields(*command, arguments->options);
  command->add_option("--model", arguments->model,
                      "full, or rom:FILE with a result of 'slipmode reduce'; under a shaker also BASIS:L, e.g. pomf:3, "
                      "lnm:10, lnm+static:4, mass-pom:3");
  command->footer(
      "Time simulated at each value: [validation] transient, block, sweep_limit; under a shaker or a force\n"
      "cycles. Unstable motions, and folds between them: 'slipmode orbit continue'.\n"
      "Example:\n  slipmode sweep datasets/chain10/scene.toml --over drive.speed=0.5:0.001:0.001 --follow "
      "-o sweep.h5\n"
      "  slipmode sweep datasets/beam_sweep/scene.toml --over drive.frequency=5:60:0.5 --model pomf:3 -o sweep.h5\n"
      "  slipmode sweep datasets/jenkins_chain/scene.toml --over drive.omega=0.1:0.6:0.005 -o sweep.h5");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
