#pragma once

#include <slipmode/results/journal.hpp>
#include <slipmode/scene/scene.hpp>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::results {

/// One of several processes that share a study: the pieces number − 1, number − 1 + count, …: neighbours, which cost
/// alike, are spread over all of them. Number 0 has none.
struct Shard {
  std::size_t number = 1, count = 1;

  [[nodiscard]] bool has(std::size_t piece) const { return piece % count == number - 1; }
};

/// "3/7" and back. @throws InvalidInput  for another text, or a number that is not among 1 … count
[[nodiscard]] Shard parse_shard(const std::string& text);
[[nodiscard]] std::string to_string(const Shard& shard);

/// What a part says of itself: enough to make it, and to finish the study from all of them.
struct PartHead {
  Shard shard;
  std::string version;             ///< of slipmode
  std::string rounding;            ///< kernels of one kind give the same bytes
  std::string command;             ///< what decides values, as provenance has it
  std::vector<std::string> words;  ///< of the command line but output, shard and what changes no value
  scene::SceneSource scene;
};

/// A shard's finished values: its journal, under a name of its own once all are there.
struct Part {
  std::filesystem::path path;
  std::string fingerprint;  ///< of the study
  PartHead head;
  std::vector<JournalRecord> records;  ///< without the head
};

/// What this process's kernels are: "fused" or "generic".
[[nodiscard]] std::string rounding();

/// The journal's fingerprint of a shard, and the head as its first record.
[[nodiscard]] std::string shard_fingerprint(const std::string& fingerprint, const Shard& shard);
[[nodiscard]] JournalRecord to_record(const PartHead& head);

/// Reads a part, or the journal of one that is unfinished.
/// @throws InvalidInput  when there is neither, it is damaged, or it is no part
[[nodiscard]] Part read_part(const std::filesystem::path& path);

/// @throws InvalidInput  when parts are missing, given twice, of another study, version or rounding than this process;
///                       says which, and what to do
void check_parts(const std::vector<Part>& parts);

/// A word as a POSIX shell takes it for one.
[[nodiscard]] std::string shell_word(const std::string& word);

/// The command line that makes a part, or goes on with it.
[[nodiscard]] std::string command_line(const Part& part);

}  // namespace slipmode::results
