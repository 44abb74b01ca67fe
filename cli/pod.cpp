#include <slipmode/pod/pod.hpp>

#include <slipmode/results/ensemble_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/scene/shaken.hpp>
#include <slipmode/studies/bases.hpp>
#include "cli/modes_report.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct PodArguments {
  std::string input, output;
  Eigen::Index modes = 0;
};

/// The decomposition knows numbers only: a refusal is told with the file and the option it belongs to.
pod::PodResult decompose(const pod::Ensemble& ensemble, const PodArguments& arguments) {
  try {
    return pod::pod(ensemble, {.choice = {.modes = arguments.modes, .energy = 1.0}});
  } catch (const InvalidInput& refusal) {
    throw InvalidInput(fmt::format("{}: --modes {}: {}", arguments.input, arguments.modes, refusal.what()));
  }
}

/// Under a shaker modes have the mass metric, and sensors give modal functions.
Report run_shaken(const PodArguments& arguments, const scene::Scene& scene, const pod::Ensemble& ensemble,
                  results::Provenance provenance) {
  if (arguments.modes > 0) {
    throw InvalidInput("--modes: under a shaker all modes are kept, 'slipmode reduce --modes' takes as many as wanted");
  }
  const results::ShakenModes modes = studies::shaken_modes(scene, scene::build_system(scene).structure(), ensemble);
  provenance.command = "slipmode pod";
  results::StoreWriter writer(arguments.output, results::FileKind::kPod, scene.units);
  results::save(writer, provenance);
  results::save(writer, modes);
  writer.commit();
  Report report;
  report.text = fmt::format("{} snapshots of {} degrees of freedom\n{}Modes: {}\n", ensemble.snapshots.cols(),
                            ensemble.snapshots.rows(), text_of(modes), arguments.output);
  report.data = {{"verb", "pod"},
                 {"file", arguments.output},
                 {"snapshots", ensemble.snapshots.cols()},
                 {"degrees_of_freedom", ensemble.snapshots.rows()}};
  report.data.update(json_of(modes));
  return report;
}

Report run(const Session& session, const PodArguments& arguments) {
  require_writable(arguments.output);
  const results::StoreReader store(arguments.input);
  results::Provenance provenance = results::load_provenance(store);
  const pod::Ensemble ensemble = results::load_snapshots(store);
  session.check_interrupt();
  const scene::Scene scene = results::load_scene_of(store);
  if (is_shaken(scene)) return run_shaken(arguments, scene, ensemble, std::move(provenance));
  const pod::PodResult result = decompose(ensemble, arguments);

  provenance.command = "slipmode pod";
  results::StoreWriter writer(arguments.output, results::FileKind::kPod, scene.units);
  results::save(writer, provenance);
  results::save(writer, results::kPodGroup, result);
  writer.commit();

  const Eigen::VectorXd sum = pod::cumulative(result.shares);
  TextTable table({"mode", "energy share [%]", "cumulative [%]"});
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(result.shares.size(), 20); ++i) {
    table.add({fmt::format("{}", i + 1), fmt::format("{:.4f}", 100.0 * result.shares[i]),
               fmt::format("{:.4f}", 100.0 * sum[i])});
  }
  Report report;
  report.text = fmt::format("{} snapshots of {} degrees of freedom, rank {}\n{}Modes: {}\n", ensemble.snapshots.cols(),
                            ensemble.snapshots.rows(), result.rank, table.str(), arguments.output);
  report.data = {{"verb", "pod"},
                 {"file", arguments.output},
                 {"snapshots", ensemble.snapshots.cols()},
                 {"degrees_of_freedom", ensemble.snapshots.rows()},
                 {"rank", result.rank},
                 {"modes", result.basis.modes()},
                 {"shares", std::vector<double>(result.shares.begin(), result.shares.end())}};
  return report;
}

}  // namespace

Verb add_pod(CLI::App& app) {
  CLI::App* command = app.add_subcommand("pod", "proper orthogonal modes of an ensemble or a trajectory");
  const auto arguments = std::make_shared<PodArguments>();
  command->add_option("FILE", arguments->input, "result of 'slipmode simulate'")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--modes", arguments->modes, "number of modes to keep; 0: all that the data hold")
      ->check(CLI::NonNegativeNumber);
  command->footer("Example:\n  slipmode pod ensemble.h5 -o pod.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
