#include <slipmode/diagnostics/attractors/sweep.hpp>

#include <slipmode/results/journal.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/reduced_file.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/own_times.hpp>
#include "cli/shaken_model.hpp"
#include "cli/steps.hpp"
#include "cli/sweep_report.hpp"
#include "cli/sweep_request.hpp"
#include "cli/swept_model.hpp"
#include "cli/validation_setup.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipmode::cli {
namespace {

/// The model swept, where it starts, and what identifies it for resuming.
struct Subject {
  diagnostics::Model model;
  dynamics::State start;
  std::string title, identity;
};

Subject full_subject(const scene::Scene& scene, const std::string& key) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  return {.model = swept_model(scene, key),
          .start = scene::initial_state(scene, system),
          .title = fmt::format("full model, {} degrees of freedom", system.size()),
          .identity = "full"};
}

Subject reduced_subject(const scene::Scene& scene, const std::string& key, const std::string& file) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  const pod::Basis basis = results::reduced_basis(file, system.size());
  return {.model = swept_model(scene, key, basis),
          .start = rom::restrict_state(system.structure(), basis, scene::initial_state(scene, system)),
          .title = fmt::format("reduced model, {} modes", basis.modes()),
          .identity = "rom " + file_fingerprint(file)};
}

Subject subject(const scene::Scene& scene, const std::string& key, const std::string& model) {
  if (model == "full") return full_subject(scene, key);
  if (const auto file = results::reduced_file(model)) return reduced_subject(scene, key, *file);
  throw InvalidInput(fmt::format("--model {}: expected full, or rom:FILE with a result of 'slipmode reduce'", model));
}

Report summary(const SweepRequest& request, const Subject& swept, const Over& over,
               const std::vector<diagnostics::SweepPoint>& points) {
  Report report;
  const MotionTable motions = motion_table(results::count_motions(points), points.size());
  const Json failures = failures_of(points);
  report.data = {{"verb", "sweep"},         {"file", request.output},  {"model", swept.title}, {"key", over.key},
                 {"values", points.size()}, {"motions", motions.json}, {"failures", failures}};
  report.text = fmt::format("{}: {} values of {}\n{}{}Sweep: {}\n", swept.title, points.size(), over.key,
                            motions.text.str(), results::undecided_note(points), request.output);
  report_failures(report, failures, points.size());
  return report;
}

Report run(const Session& session, const SweepRequest& request) {
  require_writable(request.output);
  const Over over = parse_over(request.over);
  const scene::Scene scene = scene::with_own_times(session.load(request.scene));
  refuse_force(scene, "sweep");
  if (is_shaken(scene)) return run_shaken_sweep(session, request, over, scene);
  require_belt_request(request);
  const Subject swept = subject(scene, over.key, request.model);
  check_values(scene, over);

  const std::string manner = request.follow ? fmt::format(" --follow --segments {}", request.segments) : "";
  const std::string task = fmt::format("slipmode sweep --over {} --model {}{}", request.over, swept.title, manner);
  const std::string identity = results::fingerprint(
      fmt::format("{}\n{}\n{}\n{}", results::version(), task, swept.identity, scene::scene_to_toml(scene)));
  results::Journal journal(results::Journal::path_for(request.output), identity);
  const std::size_t resumed = journal.records().size();
  ProgressLine line("sweep", session.progress_mode());
  const diagnostics::SweepResult result = diagnostics::sweep(
      swept.model, over.values, swept.start,
      {.mode = request.follow ? diagnostics::SweepMode::kFollow : diagnostics::SweepMode::kIndependent,
       .segments = request.segments,
       .settle = sweep_settle_options(scene),
       .parallel = session.parallel(line),
       .sink = results::journal_sink(journal)});
  if (result.interrupted) return interrupted_sweep(request, over, result.points.size());

  results::StoreWriter writer(request.output, scene.units);
  results::save(writer, results::provenance_of(scene, task));
  results::store_sweep(writer, swept.model.basis ? "sweep/reduced" : "sweep/full", swept.title,
                       results::sweep_axis(scene, over.key), results::Units::of(scene.units), result.points);
  writer.commit();
  journal.remove();
  Report report = summary(request, swept, over, result.points);
  report.data["resumed"] = resumed;
  if (resumed > 0) report.text += fmt::format("{} values were taken over from an interrupted run\n", resumed);
  return report;
}

}  // namespace

Verb add_sweep(CLI::App& app) {
  CLI::App* command = app.add_subcommand("sweep", "settled motion against one key of the scene");
  const auto arguments = std::make_shared<SweepRequest>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("--over", arguments->over, "key and range: KEY=FROM:TO:STEP")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_flag("--follow", arguments->follow, "start each value where the one before it ended");
  command->add_option("--segments", arguments->segments, "with --follow: number of chains side by side")
      ->check(CLI::PositiveNumber);
  command->add_option("--model", arguments->model,
                      "full, or rom:FILE with a result of 'slipmode reduce'; under a shaker also BASIS:L, e.g. pomf:3, "
                      "lnm:10, lnm+static:4, mass-pom:3");
  command->add_flag("--reverse", arguments->reverse, "shaker: from the last value to the first");
  command->add_flag("--both", arguments->both, "shaker, with --follow: up and down, to show hysteresis");
  command
      ->add_option("--lyapunov", arguments->exponent_cycles,
                   "shaker: measure the largest Lyapunov exponent over so many cycles more")
      ->check(CLI::NonNegativeNumber);
  command->footer(
      "Time simulated at each value: [validation] transient, block, sweep_limit; under a shaker cycles.\n"
      "Example:\n  slipmode sweep datasets/chain10/scene.toml --over drive.speed=0.5:0.001:0.001 --follow "
      "-o sweep.h5\n"
      "  slipmode sweep datasets/beam_sweep/scene.toml --over drive.frequency=5:60:0.5 --model pomf:3 -o sweep.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
