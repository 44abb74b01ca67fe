#pragma once

#include <slipmode/core/sharing.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slipmode::results {

/// One finished piece of a long computation: for a sweep, everything about one parameter value.
struct JournalRecord {
  std::string table;           ///< which of several results it belongs to ("full", "rom"); no spaces
  std::int64_t index = 0;      ///< its place there
  std::vector<double> values;  ///< any number of values; NaN and infinities survive
  std::string note;            ///< free text, for example why the value could not be computed
};

/// A record as a line that ends in '\n' and holds a checksum, and back from a line without its end; nothing if it is
/// torn or altered. Numbers keep their bits.
[[nodiscard]] std::string to_line(const JournalRecord& record);
[[nodiscard]] std::optional<JournalRecord> from_line(std::string_view line);

/// What a file of records holds.
struct JournalText {
  std::string fingerprint;
  std::vector<JournalRecord> records;  ///< up to the first that is torn or altered
  std::size_t whole = 0;               ///< bytes up to there
  bool damaged = false;                ///< there is such a one
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
/// Records may be appended and taken over from several threads; all else from one, when none does.
class Journal {
 public:
  /// Opens or creates.
  /// @param fingerprint  of everything that decides the records: scene, overrides, sweep; no spaces
  /// @throws InvalidInput  when the folder is not writable, the file is not a journal, it belongs to another task (the
  ///                       message says to remove it or choose another output), or another process has it open
  Journal(std::filesystem::path path, const std::string& fingerprint);
  /// Records in memory alone, of a task whose parts were computed elsewhere.
  explicit Journal(std::vector<JournalRecord> records) : records_(std::move(records)) {}
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Records found on opening and appended since, in the order they were written.
  [[nodiscard]] const std::vector<JournalRecord>& records() const { return records_; }
  /// True when records were found on opening.
  [[nodiscard]] bool resumed() const { return resumed_; }

  /// Keeps what this process found. @throws InvalidInput  when the disc is full
  void append(JournalRecord record);
  /// Keeps what another process found, a line of to_line.
  /// @throws InvalidInput        as append
  /// @throws std::runtime_error  when the line is torn or altered
  void take_over(std::string_view line);

  /// Deletes the file: the result is safe elsewhere.
  void remove();

  /// Moves the records to a file of their own under `path`, whole or not at all, in an order that does not depend on
  /// which finished first.
  /// @throws InvalidInput  when it cannot be written
  void publish(const std::filesystem::path& path);

  /// Decides which values this process leaves to others: asked with the number of the piece that can be computed alone
  /// and a record of what names the value. Empty: none.
  using Leave = std::function<bool(std::size_t piece, const JournalRecord& value)>;
  void set_leave(Leave leave) { leave_ = std::move(leave); }
  [[nodiscard]] bool leaves(std::size_t piece, const JournalRecord& value) const {
    return leave_ && leave_(piece, value);
  }

  /// How the study is shared with processes that run beside this one, and who is told of each record appended.
  void share(Sharing sharing, std::function<void(const JournalRecord&)> appended) {
    sharing_ = std::move(sharing);
    appended_ = std::move(appended);
  }
  [[nodiscard]] const Sharing& sharing() const { return sharing_; }
  /// True when other processes compute values of the same study: each is needed, none may be computed twice.
  [[nodiscard]] bool is_of_several() const { return leave_ || sharing_.begin; }

  /// Records of any journal, for reading; one that is being written may end in a torn line.
  /// @throws InvalidInput  when it cannot be opened or is not a journal
  [[nodiscard]] static JournalText read(const std::filesystem::path& path);

  /// "out/sweep.h5" → "out/sweep.h5.journal".
  [[nodiscard]] static std::filesystem::path path_for(const std::filesystem::path& result);

 private:
  void keep(JournalRecord record, std::string_view line);

  std::filesystem::path path_;  ///< empty: in memory
  std::string fingerprint_;
  int descriptor_ = -1;
  std::vector<JournalRecord> records_;
  bool resumed_ = false;
  double last_sync_ = 0.0;
  Leave leave_;
  Sharing sharing_;
  std::function<void(const JournalRecord&)> appended_;
  std::mutex keeping_;
};

/// A short name of a text (FNV-1a, 64 bit, hexadecimal).
[[nodiscard]] std::string fingerprint(const std::string& text);

}  // namespace slipmode::results
