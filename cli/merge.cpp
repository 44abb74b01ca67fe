#include <slipmode/results/part.hpp>
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

struct MergeArguments {
  std::vector<std::string> parts;
  std::string output;
};

/// The parts' own verb, from their values alone: the same code writes the result as in one process.
Report replay(const Session& session, std::vector<results::Part> parts, const std::string& output) {
  std::vector<std::string> words = parts.front().head.words;
  words.insert(words.end(), {"--output", output});
  std::ranges::reverse(words);  // as CLI::App takes them
  Session own;
  CLI::App app;
  const std::vector<Verb> verbs = add_verbs(app, own);
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw InvalidInput(
        fmt::format("{}: its command cannot be read ({}); compute it anew", parts.front().path.string(), error.what()));
  }
  own.threads = session.threads;
  own.quiet = session.quiet;
  own.stop = session.stop;
  own.joined = std::move(parts);
  const auto verb = std::ranges::find_if(verbs, [](const Verb& one) { return one.command->parsed(); });
  return verb->run(own);
}

Report run(const Session& session, const MergeArguments& arguments) {
  require_writable(arguments.output);
  if (!session.overrides.empty() || session.seed) {
    throw InvalidInput("merge: --set and --seed have no use here, the parts hold their scene; give them with --shard");
  }
  std::vector<results::Part> parts;
  for (const std::string& path : arguments.parts) parts.push_back(results::read_part(path));
  results::check_parts(parts);
  Report report = replay(session, std::move(parts), arguments.output);
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
