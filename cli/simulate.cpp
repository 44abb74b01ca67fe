#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/ensemble.hpp>
#include <slipmode/studies/simulation.hpp>
#include "cli/text_table.hpp"
#include "cli/times_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct SimulateArguments {
  std::string scene, output, model = "full";
  bool single = false;
};

Report run_trajectory(const Session& session, const SimulateArguments& arguments, const scene::Scene& scene) {
  const studies::Family model(scene, {}, studies::model_basis(scene, arguments.model, session.run_options()));
  const auto run = std::make_shared<const studies::Simulation>(studies::simulate(model, session.run_options()));
  studies::content_of(scene, run, arguments.model).save(arguments.output);
  const dynamics::Trajectory& trajectory = run->trajectory;

  const auto& statistics = trajectory.statistics;
  std::vector<double> stick_fraction;
  for (const double time : statistics.stick_time) stick_fraction.push_back(time / scene.time.duration);
  Report report;
  report.data = {{"verb", "simulate"},
                 {"file", arguments.output},
                 {"kind", "trajectory"},
                 {"samples", trajectory.times.size()},
                 {"events", trajectory.events.size()},
                 {"steps", statistics.steps},
                 {"certified", statistics.certified},
                 {"stick_fraction", stick_fraction},
                 {"audit_residual", trajectory.audit.residual()}};
  if (run->failure) {
    report.exit_code = kNumericalFailure;
    report.text = fmt::format("{}\nThe part before it is kept in {}.", describe(*run->failure), arguments.output);
    report.data["message"] = describe(*run->failure);
    report.data["time"] = run->failure->time;
    report.data["incomplete"] = true;
    return report;
  }
  report.text = fmt::format("{}: {} samples, {} events, {}, energy residual {:.2g}\nTrajectory: {}\n", scene.name(),
                            trajectory.times.size(), trajectory.events.size(), certificate(statistics),
                            trajectory.audit.residual(), arguments.output);
  tell_chosen_times(scene, {"time"}, report);
  return report;
}

/// Members that have all failed are nothing to go on from.
diagnostics::EnsembleRun ensemble_for(studies::ResultFile& file, const scene::Scene& scene,
                                      const studies::RunOptions& run) {
  try {
    return studies::ensemble(scene, run, file.journal());
  } catch (const NumericalFailure&) {
    file.drop();
    throw;
  }
}

Report run_ensemble(const Session& session, const SimulateArguments& arguments, const scene::Scene& scene) {
  studies::ResultFile file(arguments.output, scene, results::FileKind::kEnsemble, studies::kEnsembleCommand, "",
                           session.division(), studies::ensemble_pieces(scene));
  const diagnostics::EnsembleRun run = ensemble_for(file, scene, session.run_options());
  file.finish([&](results::StoreWriter& writer) { results::store_ensemble(writer, scene, run); },
              studies::audit_of(run));
  if (session.has_a_share()) return part_made(session, file.progress(), arguments.output, "members");

  Report report;
  const dynamics::FlowStatistics total = run.total();
  Json failures = Json::array();
  for (const auto& member : run.members) {
    if (!member.failure.empty()) failures.push_back(member.failure);
  }
  report.data = {{"verb", "simulate"},
                 {"file", arguments.output},
                 {"kind", "ensemble"},
                 {"members", run.members.size()},
                 {"snapshots", run.ensemble.snapshots.cols()},
                 {"steps", total.steps},
                 {"certified", total.certified},
                 {"audit_residual", run.worst_audit()},
                 {"failures", failures}};
  report.text = fmt::format("{}: {} runs, {} snapshots, {}, largest energy residual {:.2g}\nEnsemble: {}\n",
                            scene.name(), run.members.size(), run.ensemble.snapshots.cols(), certificate(total),
                            run.worst_audit(), arguments.output);
  tell_resumed(session, file.resumed(), "members", report);
  tell_alike_runs(scene, report);
  tell_chosen_times(scene, {"time"}, report);
  if (!failures.empty()) {
    report.exit_code = kNumericalFailure;
    report.text = fmt::format("{} of {} runs failed; the others are kept in {}\n  first: {}\n", failures.size(),
                              run.members.size(), arguments.output, failures.front().get<std::string>());
  }
  return report;
}

}  // namespace

Verb add_simulate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("simulate", "one trajectory, or the scene's ensemble");
  const auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_flag("--single", arguments->single, "one trajectory from [initial], even if the scene has [ensemble]");
  command->add_option("--model", arguments->model,
                      "of one trajectory: full, or rom:FILE with a result of 'slipmode reduce'; under a shaker also "
                      "BASIS:L, e.g. pomf:3");
  command->footer(
      "Example:\n  slipmode simulate datasets/chain10/scene.toml -o ensemble.h5\n"
      "  slipmode simulate datasets/chain10/scene.toml --single --set time.duration=500.0 "
      "--set time.transient=0.0 -o run.h5\n"
      "  slipmode simulate datasets/chain10/scene.toml --single --model rom:rom6.h5 -o reduced.h5");
  const auto run = [arguments](const Session& session) {
    require_writable(arguments->output);
    const scene::Scene scene = session.load(arguments->scene);
    const bool ensemble = !arguments->single && has_section(scene, "ensemble");
    if (ensemble && arguments->model != "full")
      throw InvalidInput(fmt::format("--model {}: of one trajectory; add --single", arguments->model));
    if (!ensemble && session.is_divided())
      throw InvalidInput(session.divided_by() + ": runs of an ensemble are divided; one trajectory is one piece");
    return ensemble ? run_ensemble(session, *arguments, scene) : run_trajectory(session, *arguments, scene);
  };
  return {.command = command, .run = run, .divides = true};
}

}  // namespace slipmode::cli
