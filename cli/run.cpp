#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/report/report.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/pipeline.hpp>
#include "cli/pipeline_report.hpp"
#include "cli/times_report.hpp"
#include "cli/verbs.hpp"
#include "cli/work_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>

namespace slipmode::cli {
namespace {

struct RunArguments {
  std::string scene, output;
  bool open = false;
};

/// Starts the desktop's own program on a file, without waiting for it. @return why it could not; empty when it was
std::string open_on_desktop(const std::string& file) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return "no display here";
  const std::array<std::string, 2> words = {"xdg-open", file};
  std::array<char*, 3> arguments = {const_cast<char*>(words[0].c_str()), const_cast<char*>(words[1].c_str()), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_WRONLY, 0);
  }
  pid_t id = 0;
  const int failure = posix_spawnp(&id, arguments[0], &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  return failure == 0 ? "" : "no xdg-open in PATH; apt-get install xdg-utils";
}

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
void add_page(const WorkFolder& folder, const std::vector<std::string>& names, const RunArguments& arguments,
              const studies::RunOptions& options, Report& out_report) {
  if (!report::is_available()) return;
  try {
    std::vector<std::filesystem::path> files;
    files.reserve(names.size());
    for (const std::string& name : names) files.push_back(folder.target() / name);
    const std::string page = arguments.output + "/report.html";
    const auto begin = std::chrono::steady_clock::now();
    write_text(folder.target() / "report.html", report::page(files, options));
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const std::string failure = arguments.open ? open_on_desktop(page) : "";
    if (!failure.empty()) out_report.text += fmt::format("Not opened: {}\n", failure);
    out_report.text += fmt::format("To look at it all, in a browser: {} (made in {:.2g} s)\n", page, wall);
    out_report.data["report"] = page;
  } catch (const Interrupted&) {
    out_report.text +=
        fmt::format("No report.html: interrupted; 'slipmode report {} -o FILE' makes it\n", arguments.output);
  } catch (const std::exception& failure) {
    out_report.text += fmt::format("No report.html: {}\n", failure.what());
  }
}

Report run(const Session& session, const RunArguments& arguments) {
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  figures::require_gnuplot();
  if (arguments.open) report::require_available();
  WorkFolder folder(arguments.output);
  std::filesystem::remove(folder.path() / "INCOMPLETE.txt");
  try {
    const studies::PipelineResult result = studies::pipeline(scene, folder.path(), session.run_options());
    Report out{.data = to_json(result, scene), .text = summary_text(result, scene)};
    const std::vector<std::string> both = {"time", "validation"};
    const bool compares = has_section(scene, "validation");
    tell_alike_runs(scene, out);
    if (compares) tell_without_slips(scene, out);
    tell_chosen_times(scene, compares ? both : std::vector{both.front()}, out);
    out.data["folder"] = arguments.output;
    write_text(folder.path() / "summary.json", out.data.dump(2) + "\n");
    write_text(folder.path() / "summary.txt", out.text);
    folder.finish();
    out.text += fmt::format("Results and figures (*.svg, *.png): {}\n", arguments.output);
    add_page(folder, result.files, arguments, session.run_options(), out);
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
  command->add_flag("--open", arguments->open, "show report.html in the desktop's browser when all is done");
  command->footer("Example:\n  slipmode run datasets/chain10/scene.toml -o out/chain10");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
