#include <slipmode/core/errors.hpp>
#include <slipmode/core/ranks.hpp>
#include <slipmode/core/terminal.hpp>
#include "cli/features.hpp"
#include "cli/folded_tables.hpp"
#include "cli/help_layout.hpp"
#include "cli/interrupt.hpp"
#include "cli/launched.hpp"
#include "cli/slurm.hpp"
#include "cli/verbs.hpp"

#include <malloc.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <new>
#include <string_view>

namespace slipmode::cli {
namespace {

void print_line(std::FILE* stream, const std::string& text) {
  if (text.empty()) return;
  std::fputs(text.c_str(), stream);
  if (text.back() != '\n') std::fputc('\n', stream);
}

std::string status_of(int exit_code) {
  if (exit_code == kDone) return "done";
  return exit_code == kInterrupted ? "interrupted" : "failed";
}

/// How this process ends, and why where it does not end well.
struct End {
  int code = kDone;
  std::string message = {};
};

/// Ends the program with a message: on standard error for people, as the one JSON object for programs.
End fail(const Session& session, ExitCode code, const std::string& message, const Json& details = Json::object()) {
  if (!session.speaks()) return {code, message};
  print_line(stderr, "slipmode: " + message);
  if (session.json) {
    Json object = {{"status", status_of(code)}, {"exit_code", static_cast<int>(code)}, {"message", message}};
    object.update(details);
    print_line(stdout, object.dump(2, ' ', false, Json::error_handler_t::replace));
  }
  return {code, message};
}

End fail_numerically(const Session& session, const NumericalFailure& failure) {
  const std::vector<double> state(failure.state.begin(), failure.state.end());
  return fail(session, kNumericalFailure, describe(failure),
              {{"time", failure.time}, {"residual", failure.residual}, {"state", state}});
}

/// A text for people, in the columns of their terminal; elsewhere as it is.
std::string shown(const std::string& text) {
  if (isatty(STDOUT_FILENO) != 1) return text;
  const std::size_t columns = terminal_columns(STDOUT_FILENO);
  return wrapped_lines(folded_tables(text, columns), columns);
}

/// The text of a verb that did not end well goes to standard error, whatever was asked for.
End report(const Session& session, const Report& result) {
  if (!session.speaks()) return {result.exit_code, result.text};
  if (session.json) {
    Json object = {{"status", status_of(result.exit_code)}, {"exit_code", result.exit_code}};
    object.update(result.data);
    if (result.exit_code != kDone && !object.contains("message")) object["message"] = result.text;
    print_line(stdout, object.dump(2, ' ', false, Json::error_handler_t::replace));
  }
  if (result.exit_code != kDone) {
    print_line(stderr, "slipmode: " + result.text);
  } else if (!session.json && !session.quiet) {
    print_line(stdout, shown(result.text));
  }
  return {result.exit_code, result.text};
}

/// Of a verb whose result has to have a name.
std::string output_of(const Verb& verb, const std::string& option) {
  const CLI::Option* output = verb.command->get_option("--output");
  if (output->count() == 0)
    throw InvalidInput(fmt::format("{}: expected a name for the result; give one with -o", option));
  return output->as<std::string>();
}

/// What ranks compute together is what shards divide, and some more.
void check_ranks(const Session& session, const Verb& verb) {
  const std::string name = verb.command->get_name();
  if (!verb.divides && !verb.takes_ranks) {
    throw InvalidInput(
        fmt::format("{}: is computed by one process; start it without mpirun, which is for simulate of an ensemble, "
                    "pod of a scene, validate, sweep, orbit map, orbit basins, diagnose --over, trade and advise",
                    name));
  }
  if (session.shard || !session.slurm.empty()) {
    throw InvalidInput(fmt::format("{}: {} divides the study, and so does mpirun; expected one of them", name,
                                   session.shard ? "--shard" : "--slurm"));
  }
  (void)output_of(verb, "mpirun");
}

End run_verb(Session& session, const Verb& verb) {
  try {
    if (!session.shard_text.empty()) {
      session.shard = results::parse_shard(session.shard_text);
      (void)output_of(verb, "--shard");
    }
    if (session.shards && session.slurm.empty())
      throw InvalidInput(
          fmt::format("--shards {}: goes with --slurm; one of them is --shard I/{}", *session.shards, *session.shards));
    if (session.ranks != nullptr) check_ranks(session, verb);
    if (session.slurm.empty()) return report(session, verb.run(session));
    return report(session, write_slurm(session, output_of(verb, "--slurm")));
  } catch (const InvalidInput& error) {
    return fail(session, kBadInput, error.what());
  } catch (const NumericalFailure& error) {
    return fail_numerically(session, error);
  } catch (const Interrupted& error) {
    return fail(session, kInterrupted, error.what());
  } catch (const std::bad_alloc&) {
    return fail(session, kBadInput, "not enough memory; ask for a smaller structure, fewer samples or fewer members");
  } catch (const std::exception& error) {
    return fail(session, kInternalError, error.what());
  }
}

/// Names of the verbs right under `parent`.
std::string names_of(const CLI::App& parent) {
  std::string names;
  for (const CLI::App* verb : parent.get_subcommands({})) names += (names.empty() ? "" : ", ") + verb->get_name();
  return names;
}

/// What is wrong when words of the command line name no verb; empty when they do.
std::string unknown_verb(const CLI::App& app, int argc, char** argv) {
  const CLI::App* parent = &app;
  std::string said;
  for (int i = 1; i < argc && argv[i][0] != '-' && !parent->get_subcommands({}).empty(); ++i) {
    const auto verbs = parent->get_subcommands({});
    const auto found =
        std::ranges::find(verbs, std::string(argv[i]), [](const CLI::App* verb) { return verb->get_name(); });
    said += (said.empty() ? "" : " ") + std::string(argv[i]);
    if (found == verbs.end()) return fmt::format("{}: no such verb; valid: {}", said, names_of(*parent));
    parent = *found;
  }
  return "";
}

End run_main(int argc, char** argv, const Ranks* ranks, const StopFlag& stop) {
  Session session;
  session.ranks = ranks;
  session.stop = &stop;
  CLI::App app{
      "structures with friction contacts, their proper orthogonal modes, and reduced models that are checked against "
      "the "
      "full one",
      "slipmode"};
  app.formatter(std::make_shared<HelpLayout>());
  app.set_version_flag("--version", version_text);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 2 bad input, 3 numerical failure, 130 interrupted (the same command goes on).\n"
      "Example:\n  slipmode run datasets/chain10/scene.toml -o out/chain10\n"
      "Help on a verb: slipmode VERB --help");
  const std::vector<Verb> verbs = add_verbs(app, session);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return {session.speaks() ? app.exit(error) : kDone};
    for (int i = 1; i < argc; ++i) session.json = session.json || std::string_view(argv[i]) == "--json";
    const std::string unknown = unknown_verb(app, argc, argv);
    if (!unknown.empty()) return fail(session, kBadInput, unknown);
    return fail(session, kBadInput, fmt::format("{}\nRun 'slipmode --help' or 'slipmode VERB --help'.", error.what()));
  }
  for (const Verb& verb : verbs) {
    if (!verb.command->parsed()) continue;
    session.words = words_of(*verb.command);
    if (ranks != nullptr && session.threads == 0) session.threads = threads_of(*ranks);
    return run_verb(session, verb);
  }
  return {kBadInput};
}

/// As one process, or as one of the ranks that a launcher started.
int run_launched(int argc, char** argv) {
  const StopFlag& stop = watch_for_interrupt();  // before the ranks meet, which takes a while
  const Launch launch = launch_in_environment();
  std::optional<Ranks> ranks;
  try {
    ranks = join_ranks(launch);
  } catch (const InvalidInput&) {
    if (launch.own == 0) throw;
    return kDone;  // rank 0 says it
  }
  const End end = run_main(argc, argv, ranks ? &*ranks : nullptr, stop);
  std::fflush(nullptr);  // ranks may end abruptly
  return ranks ? end_ranks(*ranks, end.code, end.message) : end.code;
}

/// Records of one value go when it is done, and the next takes as much: given back to the system in between, their
/// pages cost a sixth of a sweep.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

}  // namespace

}  // namespace slipmode::cli

int main(int argc, char** argv) {
  slipmode::cli::keep_freed_memory();
  try {
    return slipmode::cli::run_launched(argc, argv);
  } catch (const slipmode::InvalidInput& error) {  // in the environment: --version reads it
    std::fprintf(stderr, "slipmode: %s\n", error.what());
    return slipmode::cli::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slipmode: %s\n", error.what());
    return slipmode::cli::kInternalError;
  }
}
