#include <slipmode/results/info.hpp>
#include "cli/verbs.hpp"

namespace slipmode::cli {

Verb add_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "say what a result file holds");
  struct Arguments {
    std::string file;
    bool values = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "result file (HDF5)")->required();
  command->add_flag("--values", arguments->values,
                    "all values, as JSON: groups as objects, arrays as lists of rows, null for what is not finite");
  command->footer(
      "Example:\n  slipmode info out/chain10/pod.h5\n"
      "  slipmode info out/chain10/pod.h5 --values > pod.json");
  return {.command = command,
          .run =
              [arguments](const Session& session) {
                Report report;
                if (arguments->values) {
                  report.text = results::info(arguments->file, results::InfoFormat::kValues) + '\n';
                  if (session.json) report.data = Json::parse(report.text);
                } else if (session.json) {
                  report.data = Json::parse(results::info(arguments->file, results::InfoFormat::kJson));
                } else {
                  report.text = results::info(arguments->file);
                }
                return report;
              },
          .reads_scene = false};
}

}  // namespace slipmode::cli
