#pragma once

#include "cli/session.hpp"

#include <CLI/CLI.hpp>
#include <functional>
#include <vector>

namespace slipmode::cli {

/// A verb ready to run once the command line has been parsed.
struct Verb {
  CLI::App* command = nullptr;
  std::function<Report(const Session&)> run;
  bool divides = false;      ///< takes --shard: its values can be computed by several processes, ranks among them
  bool takes_ranks = false;  ///< takes no shards, and yet can be computed by ranks
  bool reads_scene = true;   ///< takes --set
};

// Each adds one sub-command with its arguments, help and example; one file per verb.
[[nodiscard]] Verb add_new(CLI::App& app);
[[nodiscard]] Verb add_run(CLI::App& app);
[[nodiscard]] Verb add_modes(CLI::App& app);
[[nodiscard]] Verb add_simulate(CLI::App& app);
[[nodiscard]] Verb add_pod(CLI::App& app);
[[nodiscard]] Verb add_reduce(CLI::App& app);
[[nodiscard]] Verb add_validate(CLI::App& app);
[[nodiscard]] Verb add_sweep(CLI::App& app);
[[nodiscard]] Verb add_plot(CLI::App& app);
[[nodiscard]] Verb add_info(CLI::App& app);
[[nodiscard]] Verb add_report(CLI::App& app);
[[nodiscard]] Verb add_selftest(CLI::App& app);
[[nodiscard]] Verb add_diagnose(CLI::App& app);
[[nodiscard]] Verb add_trade(CLI::App& app);
[[nodiscard]] Verb add_advise(CLI::App& app);
[[nodiscard]] Verb add_merge(CLI::App& app);
[[nodiscard]] Verb add_doctor(CLI::App& app);
[[nodiscard]] Verb add_schema(CLI::App& app);
[[nodiscard]] Verb add_manual(CLI::App& app);

/// All verbs with the options common to them, which go to `session`.
[[nodiscard]] std::vector<Verb> add_verbs(CLI::App& app, Session& session);

/// A parsed verb and those of its arguments and options that say what is computed, and runs it again with another
/// output. @param session  with what no word says
[[nodiscard]] std::vector<std::string> words_of(const CLI::App& command);
[[nodiscard]] Report replay(std::vector<std::string> words, const std::string& output, Session session);

/// `slipmode orbit` and its own verbs, each by its full name.
[[nodiscard]] std::vector<Verb> add_orbit(CLI::App& app);
[[nodiscard]] Verb add_orbit_find(CLI::App& orbit);
[[nodiscard]] Verb add_orbit_continue(CLI::App& orbit);
[[nodiscard]] Verb add_orbit_map(CLI::App& orbit);
[[nodiscard]] Verb add_orbit_basins(CLI::App& orbit);
[[nodiscard]] Verb add_orbit_skeleton(CLI::App& orbit);
[[nodiscard]] Verb add_orbit_returns(CLI::App& orbit);
[[nodiscard]] Verb add_orbit_spectrum(CLI::App& orbit);

}  // namespace slipmode::cli
