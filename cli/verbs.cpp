#include "cli/verbs.hpp"
#include "cli/field_options.hpp"

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

namespace slipmode::cli {
namespace {

void add_common_options(const Verb& verb, Session& session) {
  CLI::App& command = *verb.command;
  command.add_flag("--json", session.json,
                   "print one JSON object on standard output, everything else on standard error");
  if (verb.reads_scene) {
    command
        .add_option("--set", session.overrides, "override a scene's key: KEY=VALUE, e.g. drive.speed=0.25 (repeatable)")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
  }
  command
      .add_option("--threads", session.threads,
                  "threads to use, of each rank under mpirun; 0: as many as the machine runs at once")
      ->check(CLI::Range(0, 4096));
  command.add_option("--seed", session.seed, "seed of the random initial states (overrides ensemble.seed)");
  command.add_flag("--quiet", session.quiet, "no progress, no summary");
  if (!verb.divides) return;
  command.add_option("--shard", session.shard_text,
                     "compute a share of the values, I/N with I = 1 ... N; -o names the part, and 'merge' joins all");
  command.add_option("--slurm", session.slurm,
                     "compute nothing: measure one piece, and write scripts for shards under Slurm to this folder");
  command.add_option("--shards", session.shards, "with --slurm: how many; default: each takes ten minutes or more")
      ->check(within(kCount, true));
}

}  // namespace

std::vector<Verb> add_verbs(CLI::App& app, Session& session) {
  std::vector<Verb> verbs = {add_new(app),    add_run(app),   add_modes(app),    add_simulate(app), add_pod(app),
                             add_reduce(app), add_sweep(app), add_validate(app), add_plot(app),     add_info(app)};
  verbs.push_back(add_diagnose(app));
  verbs.push_back(add_trade(app));
  verbs.push_back(add_advise(app));
  verbs.push_back(add_merge(app));
  verbs.push_back(add_report(app));
  verbs.push_back(add_schema(app));
  verbs.push_back(add_doctor(app));
  verbs.push_back(add_manual(app));
  verbs.push_back(add_selftest(app));
  std::ranges::move(add_orbit(app), std::back_inserter(verbs));
  for (const Verb& verb : verbs) add_common_options(verb, session);
  return verbs;
}

std::vector<std::string> words_of(const CLI::App& command) {
  constexpr std::array<std::string_view, 8> kLeftOut = {"--help",  "--json",   "--threads", "--quiet",
                                                        "--shard", "--shards", "--slurm",   "--output"};
  std::vector<std::string> words, options;
  for (const CLI::App* app = &command; app->get_parent() != nullptr; app = app->get_parent())
    words.insert(words.begin(), app->get_name());
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    const std::string name = "--" + (option->get_lnames().empty() ? "" : option->get_lnames().front());
    if (option->get_positional()) {
      std::ranges::copy(option->results(), std::back_inserter(words));
    } else if (std::ranges::find(kLeftOut, name) != kLeftOut.end()) {
      continue;
    } else if (option->get_items_expected_max() == 0) {
      options.push_back(name);
    } else {
      for (const std::string& value : option->results()) options.push_back(fmt::format("{}={}", name, value));
    }
  }
  std::ranges::move(options, std::back_inserter(words));
  return words;
}

Report replay(std::vector<std::string> words, const std::string& output, Session session) {
  words.insert(words.end(), {"--output", output});
  std::ranges::reverse(words);  // as CLI::App takes them
  CLI::App app;
  const std::vector<Verb> verbs = add_verbs(app, session);
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw InvalidInput(fmt::format("the command of a part cannot be read: {}", error.what()));
  }
  const auto verb = std::ranges::find_if(verbs, [](const Verb& one) { return one.divides && one.command->parsed(); });
  if (verb == verbs.end()) throw InvalidInput("the command of a part cannot be read: it is none that is divided");
  return verb->run(session);
}

}  // namespace slipmode::cli
