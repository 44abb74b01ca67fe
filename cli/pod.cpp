#include <slipmode/pod/pod.hpp>

#include <slipmode/studies/reduction.hpp>
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

/// Under a shaker modes have the mass metric, and sensors give modal functions.
void say_shaken(const results::ShakenModes& modes, const std::string& output, Report& out_report) {
  out_report.text += fmt::format("{}Modes: {}\n", text_of(modes), output);
  out_report.data.update(json_of(modes));
}

Report run(const Session&, const PodArguments& arguments) {
  require_writable(arguments.output);
  const auto modes = std::make_shared<const studies::MotionModes>(
      studies::motion_modes(results::StoreReader(arguments.input), arguments.modes));
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
