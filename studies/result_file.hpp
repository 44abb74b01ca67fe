#pragma once

#include <slipmode/pod/basis.hpp>
#include <slipmode/results/crew.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/part.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// What of a study can be computed alone: the most shards it can be divided among.
struct Pieces {
  std::size_t count = 0;
  std::string what;  ///< "values", …; where there are few, also how there are more
};

/// Of values that follow each other. @param more  how there are more of them: "without --follow"
[[nodiscard]] Pieces chains(std::size_t count, const std::string& more);

/// How a study is divided among processes; by default not at all.
struct Division {
  /// This process computes only this share, and leaves a part. Count 0: as many as there are pieces.
  std::optional<results::Shard> shard;
  std::vector<results::Part> joined;  ///< this process computes nothing that the parts of others should hold
  std::vector<std::string> words;     ///< of the command line, for the head of a part
  /// This process is one of several that compute the study together; the result is rank 0's. Must outlive the study.
  const Ranks* ranks = nullptr;
};

/// What becomes of values that a study without a file had finished when it was stopped.
enum class Unfinished : std::uint8_t {
  kDropped,
  /// Kept in the user's cache ($XDG_CACHE_HOME, else ~/.cache) until the same study is asked again and ends; dropped
  /// where there is none, or another process computes the same study.
  kKept,
};

/// Values of a study, or whatever it counts.
struct FileProgress {
  std::size_t finished = 0;  ///< by now
  std::size_t resumed = 0;   ///< of them found finished: by an interrupted run, or in parts
};

/// A result in the making, for a file or for memory. Values that a long study finishes are kept in a journal beside its
/// file until that is whole; the same study, asked again after an interruption, goes on from there. A shard's file is a
/// part: its journal, complete. Joined parts stand in for the journal of a study whose values are all there. Of ranks
/// that compute together, the first has file and journal.
class ResultFile {
 public:
  /// @param path      empty: in memory only, with a journal as `unfinished` says
  /// @param command   what was asked, for provenance: with the scene, the version, kernels and `identity` it decides
  ///                  whether a journal found beside the file belongs to the same study
  /// @param identity  of what else decides values: the models of files, see identity_of
  /// @throws InvalidInput  as results::Journal; for more shards than pieces; for parts of another study, also where a
  ///                       part would be replaced
  ResultFile(std::filesystem::path path, scene::Scene scene, results::FileKind kind, std::string command,
             const std::string& identity = "", const Division& division = {}, const Pieces& pieces = {},
             Unfinished unfinished = Unfinished::kDropped);
  /// A journal in which nothing was kept is dropped.
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  /// Null without a file, but for values kept elsewhere.
  [[nodiscard]] results::Journal* journal() { return journal_ ? &*journal_ : nullptr; }
  /// Values that were found finished.
  [[nodiscard]] std::size_t resumed() const { return resumed_; }
  /// Values that are finished by now.
  [[nodiscard]] std::size_t finished() const { return journal_ ? journal_->records().size() - (shard_ ? 1 : 0) : 0; }
  [[nodiscard]] FileProgress progress() const { return {finished(), resumed_}; }

  /// There will be no result: the journal goes too.
  void drop();

  /// Provenance and what `write` adds: written under a temporary name, which is renamed, when there is a file, whose
  /// journal is then dropped. A shard's journal becomes the part instead.
  /// @param audit  for provenance
  /// @throws InvalidInput  when values are missing in the parts: says which, and what finishes them
  /// Does nothing on a rank other than 0.
  results::Content finish(std::function<void(results::StoreWriter&)> write,
                          const std::optional<dynamics::EnergyAudit>& audit = {});

 private:
  void keep_in_cache();
  void begin_part(const std::vector<std::string>& words);
  void join(const std::vector<results::Part>& parts);
  void require_all() const;

  std::filesystem::path path_;
  scene::Scene scene_;
  results::FileKind kind_;
  std::string command_, fingerprint_;
  std::optional<results::Shard> shard_;
  std::optional<results::Journal> journal_;
  std::optional<results::Crew> crew_;
  std::size_t resumed_ = 0;
  /// Of joined parts: what each lacks, and the command that finishes it.
  struct Lack {
    std::string path, command;
    std::vector<results::JournalRecord> values;
  };
  std::vector<Lack> lacks_;  ///< by shard
};

/// What decides a study's values, in short: version, kernels, scene, what was asked, and what else it was made from.
/// @param command, identity  as for ResultFile
[[nodiscard]] std::string fingerprint_of(const scene::Scene& scene, const std::string& command,
                                         const std::string& identity = "");

/// Short name of a basis to the last bit.
[[nodiscard]] std::string identity_of(const pod::Basis& basis);

}  // namespace slipmode::studies
