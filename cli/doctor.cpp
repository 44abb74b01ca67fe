#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/report/report.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/store.hpp>
#include "cli/features.hpp"
#include "cli/verbs.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <cstdlib>
#include <filesystem>
#include <functional>

namespace slipmode::cli {
namespace {

/// Something slipmode may lack on this machine.
struct Check {
  std::string name, serves;
  bool needed = false;            ///< without it `slipmode run` fails
  std::function<void()> require;  ///< throws, saying what is missing and what brings it
};

/// @param code  Python in one line, without quotes of one stroke; nothing is imported from the current folder
bool python_runs(const std::string& code) {
  const std::string command = fmt::format("python3 -c 'import sys; del sys.path[0]; {}' >/dev/null 2>&1", code);
  return std::system(command.c_str()) == 0;  // NOLINT(bugprone-command-processor): none of its words is the user's
}

void require_python() {
  if (python_runs(fmt::format("import slipmode; assert slipmode.__version__ == \"{}\"", results::version()))) return;
  throw InvalidInput(
      fmt::format("the python3 in PATH finds no slipmode {}; for /usr/bin/python3: apt-get install python3-slipmode; "
                  "after a build: PYTHONPATH=build/release/python",
                  results::version()));
}

Check python_module(const std::string& name, const std::string& serves) {
  return {name, serves, false, [name] {
            if (python_runs(fmt::format("import importlib.util as u; sys.exit(u.find_spec(\"{}\") is None)", name)))
              return;
            throw InvalidInput(fmt::format(
                "the python3 in PATH finds no {0}; for /usr/bin/python3: apt-get install python3-{0}", name));
          }};
}

void require_mpi() {
  void* library = dlopen("slipmode_mpi.so", RTLD_LAZY);  // found by the executable's run path, as under mpirun
  if (library == nullptr)
    throw InvalidInput(
        "no MPI, or none this build was made for; apt-get install openmpi-bin; a build: libopenmpi-dev too");
  dlclose(library);
  if (std::system("command -v mpirun >/dev/null") == 0) return;  // NOLINT(bugprone-command-processor)
  throw InvalidInput("mpirun is not in PATH; apt-get install openmpi-bin");
}

void require_datasets() {
  if (std::filesystem::is_directory(dataset_folder())) return;
  throw InvalidInput(fmt::format("no {}; 'cmake --install' and the package slipmode bring it; a checkout has datasets/",
                                 dataset_folder()));
}

std::vector<Check> checks(const std::string& folder) {
  return {
      {"folder", "results", true,
       [folder] { results::require_writable(std::filesystem::path(folder) / "slipmode.h5"); }},
      {"gnuplot", "figures: run, plot, --figures", true, figures::require_gnuplot},
      {"report", "one interactive page: report, run", false, report::require_available},
      {"datasets", "the scenes that examples and tutorials name", false, require_datasets},
      {"mpi", "studies on several machines: mpirun", false, require_mpi},
      {"python", "import slipmode", false, require_python},
      python_module("matplotlib", "in Python: figures"),
      python_module("xarray", "in Python: to_xarray()"),
      python_module("tqdm", "in Python: progress"),
  };
}

/// What is wrong; empty when nothing is.
std::string problem_of(const Check& check) {
  try {
    check.require();
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

Report run(const std::string& folder) {
  Report report;
  report.data = {{"verb", "doctor"}, {"folder", folder}, {"features", Json::object()}, {"checks", Json::array()}};
  for (const Feature& feature : features()) report.data["features"][feature.name] = feature.value;
  std::string missing, lines;
  for (const Check& check : checks(folder)) {
    const std::string problem = problem_of(check);
    const bool ok = problem.empty();
    report.data["checks"].push_back(
        {{"name", check.name}, {"for", check.serves}, {"needed", check.needed}, {"ok", ok}, {"problem", problem}});
    lines += fmt::format("  {:<8} {:<11} {}\n",
                         ok             ? "ok"
                         : check.needed ? "MISSING"
                                        : "without",
                         check.name, check.serves);
    // A line for what is wrong, one for each remedy: a command stays whole.
    if (!ok) lines += fmt::format("           {}\n", CLI::detail::find_and_replace(problem, "; ", ";\n           "));
    if (!ok && check.needed) missing += (missing.empty() ? "" : ", ") + check.name;
  }
  report.exit_code = missing.empty() ? kDone : kBadInput;
  report.text = missing.empty() ? "nothing that is needed is missing\n" : fmt::format("missing: {}\n", missing);
  report.text += lines;
  if (!missing.empty()) report.data["message"] = "missing: " + missing;
  return report;
}

}  // namespace

Verb add_doctor(CLI::App& app) {
  CLI::App* command = app.add_subcommand("doctor", "what is missing on this machine, for what, and what brings it");
  const auto folder = std::make_shared<std::string>(".");
  command->add_option("DIR", *folder, "folder that results are to go to")->capture_default_str();
  command->footer(
      "Exit code 0 when nothing that is needed is missing, else 2. 'slipmode --version' says what was built in.\n"
      "Example:\n  slipmode doctor");
  return {.command = command, .run = [folder](const Session&) { return run(*folder); }, .reads_scene = false};
}

}  // namespace slipmode::cli
