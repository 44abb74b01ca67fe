#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::results {

/// One finished piece of a long computation: for a sweep, everything about one parameter value.
struct JournalRecord {
  std::string table;           ///< which of several results it belongs to ("full", "rom"); no spaces
  std::int64_t index = 0;      ///< its place there
  std::vector<double> values;  ///< any number of values; NaN and infinities survive
  std::string note;            ///< free text, for example why the value could not be computed
};

/// A side file beside an unfinished result that survives `kill -9`: an interrupted sweep loses at most the value being
/// computed.
///
/// HDF5 files can be spoilt by a kill in mid-write, so rows are collected here first: one text line per record with a
/// CRC-32 in front, appended by a single write(2). When all are there, the caller writes the HDF5 file (atomically) and
/// then calls `remove`. On opening, records that are whole are taken over and a torn last line is cut off. The first
/// line holds a fingerprint of the task, so that records of another task are never mixed in. A lock keeps a second
/// process out. After a power cut the rows of the last second may be lost (data are synced once a second).
///
///     Journal journal(Journal::path_for("out/sweep.h5"), fingerprint(task_text));
///     for (index not in journal.records()) journal.append({"full", index, values, ""});
///     ... write and commit out/sweep.h5 from journal.records() ...
///     journal.remove();
///
/// Use from one thread at a time.
class Journal {
 public:
  /// Opens or creates.
  /// @param fingerprint  of everything that decides the records: scene, overrides, sweep; no spaces
  /// @throws InvalidInput  when the folder is not writable, the file is not a journal, it belongs to another task (the
  ///                       message says to remove it or choose another output), or another process has it open
  Journal(std::filesystem::path path, const std::string& fingerprint);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Records found on opening and appended since, in the order they were written.
  [[nodiscard]] const std::vector<JournalRecord>& records() const { return records_; }
  /// True when records were found on opening.
  [[nodiscard]] bool resumed() const { return resumed_; }

  /// @throws InvalidInput  when the disc is full
  void append(JournalRecord record);

  /// Deletes the file: the result is safe elsewhere.
  void remove();

  /// "out/sweep.h5" → "out/sweep.h5.journal".
  [[nodiscard]] static std::filesystem::path path_for(const std::filesystem::path& result);

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::vector<JournalRecord> records_;
  bool resumed_ = false;
  double last_sync_ = 0.0;
};

/// A short name of a text (FNV-1a, 64 bit, hexadecimal).
[[nodiscard]] std::string fingerprint(const std::string& text);

}  // namespace slipmode::results
