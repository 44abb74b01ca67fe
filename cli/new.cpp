#include <slipmode/core/files.hpp>
#include <slipmode/scene/new_scene.hpp>
#include "cli/features.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <filesystem>
#include <memory>

namespace slipmode::cli {
namespace {

struct NewArguments {
  std::string kind, output;
};

/// Where the schema of scenes is installed, editors are told.
std::string editor_line() {
  const std::filesystem::path schema = std::filesystem::path(dataset_folder()).parent_path() / "scene.schema.json";
  return std::filesystem::exists(schema) ? fmt::format("#:schema file://{}\n", schema.string()) : "";
}

Report run(const NewArguments& arguments) {
  const std::string& output = arguments.output;
  const std::string text = editor_line() + scene::new_scene(arguments.kind, output.empty() ? "scene.toml" : output);
  Report report{.data = {{"verb", "new"}, {"kind", arguments.kind}}, .text = text};
  if (output.empty()) {
    report.data["scene"] = text;
    return report;
  }
  if (std::filesystem::exists(output)) {
    throw InvalidInput(fmt::format("-o {}: is there already; choose another name, or remove it first", output));
  }
  require_writable(output);
  write_renamed(output, text);
  report.data["file"] = output;
  report.text = fmt::format("Scene: {}\nTo see what it does: slipmode run {} -o out\n", output, output);
  return report;
}

}  // namespace

Verb add_new(CLI::App& app) {
  CLI::App* command = app.add_subcommand("new", "a small scene to start from, with what each key means");
  const auto arguments = std::make_shared<NewArguments>();
  command->add_option("KIND", arguments->kind, fmt::format("{}", fmt::join(scene::new_scene_kinds(), ", ")))
      ->required();
  command->add_option("-o,--output", arguments->output, "scene file (TOML), not there yet; default: standard output");
  command->footer(
      "Example:\n  slipmode new chain -o scene.toml\n"
      "  slipmode run scene.toml -o out");
  return {.command = command, .run = [arguments](const Session&) { return run(*arguments); }, .reads_scene = false};
}

}  // namespace slipmode::cli
