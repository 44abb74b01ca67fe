#include <slipmode/results/info.hpp>
#include "cli/verbs.hpp"

namespace slipmode::cli {

Verb add_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "say what a result file holds");
  const auto file = std::make_shared<std::string>();
  command->add_option("FILE", *file, "result file (HDF5)")->required();
  command->footer("Example:\n  slipmode info out/chain10/pod.h5");
  return {command, [file](const Session& session) {
            Report report;
            if (session.json) {
              report.data = Json::parse(results::info(*file, results::InfoFormat::kJson));
            } else {
              report.text = results::info(*file);
            }
            return report;
          }};
}

}  // namespace slipmode::cli
