#include <slipmode/core/files.hpp>
#include <slipmode/report/report.hpp>
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <filesystem>

namespace slipmode::cli {
namespace {

struct ReportArguments {
  std::vector<std::string> inputs;
  std::string output = "report.html";
};

/// A page must not replace what it is made from.
void require_other(const std::string& output, const std::vector<std::string>& inputs) {
  if (std::filesystem::path(output).extension() == ".h5" || is_among(output, inputs))
    throw InvalidInput(fmt::format("-o {}: would replace a result; expected another name, e.g. report.html", output));
}

Report run(const Session& session, const ReportArguments& arguments) {
  report::require_available();
  require_other(arguments.output, arguments.inputs);
  require_writable(arguments.output);
  const std::string page = report::page({arguments.inputs.begin(), arguments.inputs.end()}, session.run_options());
  write_renamed(arguments.output, page);
  Report out;
  out.text = fmt::format("{}: {:.2f} MB, opens in any browser, needs no network\n", arguments.output,
                         1e-6 * static_cast<double>(page.size()));
  out.data = {{"verb", "report"}, {"file", arguments.output}, {"bytes", page.size()}};
  return out;
}

}  // namespace

Verb add_report(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("report", "results as one interactive HTML page: what was found, every figure and table");
  const auto arguments = std::make_shared<ReportArguments>();
  command->add_option("INPUT", arguments->inputs, "folders of results and result files (HDF5)")->required();
  command->add_option("-o,--output", arguments->output, "page (HTML)")->capture_default_str();
  command->footer("Example:\n  slipmode report out/chain10 -o report.html");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .reads_scene = false};
}

}  // namespace slipmode::cli
