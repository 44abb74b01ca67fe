#include <slipmode/pod/pod.hpp>

#include <slipmode/studies/ensemble_modes.hpp>
#include "cli/field_options.hpp"
#include "cli/modes_report.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <filesystem>
#include <memory>

namespace slipmode::cli {
namespace {

struct PodArguments {
  std::string input, output;
  Eigen::Index modes = 0;
};

/// Under a shaker modes have the mass metric, and sensors give modal functions.
void say_shaken(const results::ShakenModes& modes, const std::string& output, Report& out_report) {
  out_report.text += fmt::format("{}Modes: {}\n", text_of(modes), output);
  out_report.data.update(json_of(modes));
}

/// The modes of a file's motion, or of a scene's ensemble.
studies::EnsembleModes modes_of(const Session& session, const PodArguments& arguments) {
  if (std::filesystem::path(arguments.input).extension() == ".toml") {
    return studies::ensemble_modes(session.load(arguments.input), arguments.modes, session.run_options(),
                                   session.ranks);
  }
  if (session.ranks != nullptr) {
    throw InvalidInput(
        fmt::format("{}: a result's snapshots are read by one process; start it without mpirun, or give the scene "
                    "(.toml), whose ensemble the ranks simulate",
                    arguments.input));
  }
  session.refuse_overrides(arguments.input, "it holds its motion; give the scene (.toml) with it");
  return {.found = studies::motion_modes(results::StoreReader(arguments.input), arguments.modes)};
}

/// Of an ensemble that was simulated for its modes.
void say_failures(const studies::EnsembleModes& modes, const std::string& output, Report& out_report) {
  if (modes.failures.empty()) return;
  out_report.exit_code = kNumericalFailure;
  out_report.data["failures"] = modes.failures;
  out_report.text = fmt::format("{} of {} runs failed; the modes of the others are kept in {}\n  first: {}\n",
                                modes.failures.size(), modes.members, output, modes.failures.front());
}

Report run(const Session& session, const PodArguments& arguments) {
  require_writable(arguments.output);
  const auto found = std::make_shared<const studies::EnsembleModes>(modes_of(session, arguments));
  if (!session.speaks()) return {};
  const std::shared_ptr<const studies::MotionModes> modes(found, &found->found);
  studies::content_of(modes).save(arguments.output);
  Report report;
  report.text = fmt::format("{} snapshots of {} degrees of freedom", modes->snapshots, modes->dofs);
  report.data = {{"verb", "pod"},
                 {"file", arguments.output},
                 {"snapshots", modes->snapshots},
                 {"degrees_of_freedom", modes->dofs}};
  if (modes->shaken) {
    report.text += '\n';
    say_shaken(*modes->shaken, arguments.output, report);
    say_failures(*found, arguments.output, report);
    return report;
  }
  const pod::PodResult& result = *modes->pod;
  const Eigen::VectorXd sum = pod::cumulative(result.shares);
  TextTable table({"mode", "energy share [%]", "cumulative [%]"});
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(result.shares.size(), 20); ++i) {
    table.add({fmt::format("{}", i + 1), fmt::format("{:.4f}", 100.0 * result.shares[i]),
               fmt::format("{:.4f}", 100.0 * sum[i])});
  }
  report.text += fmt::format(", rank {}\n{}Modes: {}\n", result.rank, table.str(), arguments.output);
  report.data["rank"] = result.rank;
  report.data["modes"] = result.basis.modes();
  report.data["shares"] = std::vector<double>(result.shares.begin(), result.shares.end());
  say_failures(*found, arguments.output, report);
  return report;
}

}  // namespace

Verb add_pod(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "pod", "proper orthogonal modes of an ensemble, a trajectory, or the ensemble that a scene asks for");
  const auto arguments = std::make_shared<PodArguments>();
  command
      ->add_option("INPUT", arguments->input,
                   "result of 'slipmode simulate', or a scene (.toml): its ensemble, simulated and not kept, under "
                   "mpirun by all ranks")
      ->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--modes", arguments->modes, "number of modes to keep; 0: all that the data hold")
      ->check(within(kFromZero, true));
  command->footer(
      "Example:\n  slipmode pod ensemble.h5 -o pod.h5\n"
      "  mpirun -n 4 slipmode pod datasets/chain10/scene.toml -o pod.h5");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .takes_ranks = true};
}

}  // namespace slipmode::cli
