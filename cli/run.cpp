#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/report/report.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/pipeline.hpp>
#include "cli/pipeline_report.hpp"
#include "cli/verbs.hpp"
#include "cli/work_folder.hpp"

#include <fmt/format.h>
#include <fstream>

namespace slipmode::cli {
namespace {

struct RunArguments {
  std::string scene, output;
};

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out) throw InvalidInput(fmt::format("cannot write '{}': is the disc full?", path.string()));
}

/// Finished parts stay beside the target, marked by a file that says why there is no more.
Report incomplete(const WorkFolder& folder, const NumericalFailure& failure) {
  write_text(folder.path() / "INCOMPLETE.txt", describe(failure) + "\n");
  Report report;
  report.exit_code = kNumericalFailure;
  report.text = fmt::format("{}\nFinished parts are kept in {}", describe(failure), folder.path().string());
  report.data = {
      {"verb", "run"}, {"message", describe(failure)}, {"time", failure.time}, {"incomplete", folder.path().string()}};
  return report;
}

Report interrupted(const WorkFolder& folder) {
  Report report;
  report.exit_code = kInterrupted;
  report.text = fmt::format("interrupted; finished parts are kept in {}\nThe same command goes on from there.",
                            folder.path().string());
  report.data = {{"verb", "run"}, {"message", report.text}, {"incomplete", folder.path().string()}};
  return report;
}

/// The page beside the results, where this build has one. What keeps it from being made does them no harm.
std::string add_page(const std::filesystem::path& folder, const std::vector<std::string>& names,
                     const std::string& output, const studies::RunOptions& options) {
  if (!report::is_available()) return "";
  try {
    std::vector<std::filesystem::path> files;
    files.reserve(names.size());
    for (const std::string& name : names) files.push_back(folder / name);
    write_text(folder / "report.html", report::page(files, options));
    return fmt::format("To look at it all, in a browser: {}/report.html\n", output);
  } catch (const Interrupted&) {
    return fmt::format("No report.html: interrupted; 'slipmode report {} -o FILE' makes it\n", output);
  } catch (const std::exception& failure) {
    return fmt::format("No report.html: {}\n", failure.what());
  }
}

Report run(const Session& session, const RunArguments& arguments) {
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  figures::require_gnuplot();
  WorkFolder folder(arguments.output);
  std::filesystem::remove(folder.path() / "INCOMPLETE.txt");
  try {
    const studies::PipelineResult result = studies::pipeline(scene, folder.path(), session.run_options());
    Report out{.data = to_json(result, scene), .text = summary_text(result, scene)};
    out.data["folder"] = arguments.output;
    write_text(folder.path() / "summary.json", out.data.dump(2) + "\n");
    write_text(folder.path() / "summary.txt", out.text);
    folder.finish();
    out.text += fmt::format("Results and figures (*.svg, *.png): {}\n", arguments.output);
    out.text += add_page(folder.target(), result.files, arguments.output, session.run_options());
    return out;
  } catch (const NumericalFailure& failure) {
    folder.keep();
    return incomplete(folder, failure);
  } catch (const Interrupted&) {
    folder.keep();
    return interrupted(folder);
  } catch (const InvalidInput&) {
    throw;
  } catch (const std::exception&) {
    folder.keep();  // a defect of ours must not cost the user what was computed
    throw;
  }
}

}  // namespace

Verb add_run(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("run", "the whole pipeline: figures, tables and data of what a scene asks for");
  const auto arguments = std::make_shared<RunArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "folder for results; made if missing")->required();
  command->footer("Example:\n  slipmode run datasets/chain10/scene.toml -o out/chain10");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
