#include <slipmode/results/part.hpp>
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct MergeArguments {
  std::vector<std::string> parts;
  std::string output;
};

Report run(const Session& session, const MergeArguments& arguments) {
  require_writable(arguments.output);
  session.refuse_overrides("merge", "the parts hold their scene; give it with --shard");
  if (session.seed)
    throw InvalidInput("merge: --seed has no use here, the parts hold their scene; give it with --shard");
  std::vector<results::Part> parts;
  for (const std::string& path : arguments.parts) parts.push_back(results::read_part(path));
  if (is_among(arguments.output, arguments.parts))
    throw InvalidInput(fmt::format("-o {}: is one of the parts; give the result another name", arguments.output));
  results::check_parts(parts);
  // The parts' own verb, with their values: the same code writes the result as in one process.
  const std::vector<std::string> words = parts.front().head.words;
  Report report = replay(words, arguments.output,
                         {.quiet = session.quiet, .threads = session.threads, .stop = session.stop, .joined = parts});
  if (report.exit_code == kInterrupted) {
    report.text = "interrupted; the parts are as they were, and the same command begins again";
    report.data["message"] = report.text;
  }
  return report;
}

}  // namespace

Verb add_merge(CLI::App& app) {
  CLI::App* command = app.add_subcommand("merge", "join the parts that shards of a study left");
  const auto arguments = std::make_shared<MergeArguments>();
  command->add_option("PART", arguments->parts, "what '--shard I/N -o PART' left, all N, in any order")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->footer(
      "The result has the same bytes as that of one process. The parts hold scene and command.\n"
      "Example:\n  slipmode sweep datasets/chain10/scene.toml --over drive.speed=0.5:0.01:0.01 --shard 1/2 -o 1.part\n"
      "  slipmode sweep datasets/chain10/scene.toml --over drive.speed=0.5:0.01:0.01 --shard 2/2 -o 2.part\n"
      "  slipmode merge 1.part 2.part -o sweep.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
