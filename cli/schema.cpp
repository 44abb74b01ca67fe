#include <slipmode/core/files.hpp>
#include <slipmode/scene/schema.hpp>
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <memory>

namespace slipmode::cli {
namespace {

struct SchemaArguments {
  std::string output;
};

Report run(const SchemaArguments& arguments) {
  const std::string& output = arguments.output;
  const std::string schema = scene::scene_schema();
  if (output.empty()) return {.data = {{"verb", "schema"}, {"schema", Json::parse(schema)}}, .text = schema};
  require_writable(output);
  write_renamed(output, schema);
  return {.data = {{"verb", "schema"}, {"file", output}},
          .text = fmt::format("Schema: {}\nFirst line of a scene, for editors: #:schema {}\n", output, output)};
}

}  // namespace

Verb add_schema(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("schema", "what a scene file can hold, as JSON Schema for editors and validators");
  const auto arguments = std::make_shared<SchemaArguments>();
  command->add_option("-o,--output", arguments->output, "schema file (JSON); default: standard output");
  command->footer(
      "An editor that knows Taplo ('Even Better TOML') explains and completes keys, and marks what is wrong, in a "
      "scene whose first line is '#:schema scene.schema.json'.\n"
      "Example:\n  slipmode schema -o scene.schema.json");
  return {.command = command, .run = [arguments](const Session&) { return run(*arguments); }, .reads_scene = false};
}

}  // namespace slipmode::cli
