#pragma once

#include <slipmode/core/describe.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/core/progress.hpp>
#include <slipmode/core/ranks.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::cli {

/// JSON that keeps the order in which a verb says things.
using Json = nlohmann::ordered_json;

enum ExitCode : int {
  kDone = 0,
  kInternalError = 1,  ///< a defect of the program or of the machine, not of the input
  kBadInput = 2,
  kNumericalFailure = 3,
  kInterrupted = 130,
};

/// The options every verb has, and the flag that Ctrl-C sets.
struct Session {
  bool json = false;   ///< one JSON object on standard output, everything else on standard error
  bool quiet = false;  ///< no progress, no summary
  int threads = 0;     ///< 0: as many as the machine runs at once
  std::optional<std::uint64_t> seed = {};
  std::vector<std::string> overrides = {};  ///< --set, in order
  const StopFlag* stop = nullptr;
  std::string shard_text = {};  ///< --shard I/N as given
  std::optional<results::Shard> shard = {};
  std::string slurm = {};                  ///< --slurm: folder for scripts instead of computing; empty: none
  std::optional<std::size_t> shards = {};  ///< --shards, with --slurm
  std::vector<results::Part> joined = {};  ///< what `slipmode merge` joins: they hold the scene, and values
  std::vector<std::string> words = {};     ///< of the command line, as a part keeps them
  const Ranks* ranks = nullptr;            ///< processes that mpirun started together; null: this one is on its own

  /// True but on ranks other than 0, which neither print nor write.
  [[nodiscard]] bool speaks() const { return ranks == nullptr || ranks->own == 0; }
  /// True when this process computes a share of the values, and others make the result.
  [[nodiscard]] bool has_a_share() const { return shard || !speaks(); }

  /// Whether several processes compute the study, and what says so.
  [[nodiscard]] bool is_divided() const { return shard || ranks != nullptr; }
  [[nodiscard]] std::string divided_by() const { return shard ? "--shard" : "mpirun"; }
  /// For studies, with progress on standard error.
  [[nodiscard]] studies::RunOptions run_options() const;
  [[nodiscard]] ProgressMode progress_mode() const {
    return quiet || !speaks() ? ProgressMode::kQuiet : ProgressMode::kAutomatic;
  }
  /// How a study's values are divided among processes.
  [[nodiscard]] studies::Division division() const;
  /// Reads a scene, or the one of joined parts, with --set and --seed applied (--seed is an override of ensemble.seed,
  /// so provenance holds it).
  [[nodiscard]] scene::Scene load(const std::filesystem::path& path) const;
  /// @throws InvalidInput  when there is a --set, for a verb that reads no scene
  void refuse_overrides(const std::string& verb, const std::string& why) const;
};

/// What a verb has to say: the same content as text and as JSON, and how it ended.
struct Report {
  Json data = Json::object();
  std::string text;
  int exit_code = kDone;
};

using results::require_writable;

/// True when a result would replace one of the files, or folders, it is made from.
[[nodiscard]] bool is_among(const std::string& output, const std::vector<std::string>& inputs);

/// Says where a result is, if it is in a file. @param what  "Map", "Orbit"
void tell_file(const std::string& what, const std::string& file, Report& out_report);
/// Says what an interrupted run, or the parts, had finished. @param what  is counted: "values", "rows"
void tell_resumed(const Session& session, std::size_t resumed, const std::string& what, Report& out_report);

/// What to say when a share of the values is done: of a rank nothing. @param what  is counted: "values", "rows"
[[nodiscard]] Report part_made(const Session& session, const studies::FileProgress& done, const std::string& output,
                               const std::string& what);

/// In how many of a run's steps it is proved that no event was passed.
[[nodiscard]] std::string certificate(const dynamics::FlowStatistics& statistics);

}  // namespace slipmode::cli
