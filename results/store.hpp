#pragma once

#include <slipmode/results/file_kind.hpp>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace slipmode::results {

class MemoryStore;
struct Dataset;
class StoreTarget;
class StoreSource;

/// What a stored number means: written as the attributes `units` and `description` of its dataset.
/// Units are "1" for a pure number, "" for text and counts without a unit.
struct Meaning {
  std::string units;
  std::string description;
  /// Of the model: in a dimensionless scene its metres and newtons are pure numbers. A clock's seconds stay seconds.
  enum class Of : std::uint8_t { kModel, kClock } of = Of::kModel;
};

/// Throws unless a file can be made there: to be called before any work that would be lost.
/// @throws InvalidInput  when the folder is missing or not writable, or the path is a folder
void require_writable(const std::filesystem::path& file);

/// Writes one HDF5 result file, or what it would hold into memory. The content goes to a temporary in the same folder;
/// `commit` renames it into place, so that a reader sees the whole file or none. A writer destroyed without `commit`
/// leaves nothing behind.
///
///     StoreWriter store("out/run.h5", FileKind::kTrajectory);
///     store.write("trajectory/time", times, {"s", "sampling instants"});
///     store.write_columns("trajectory/q", q, {"m", "displacements, time x dof"});  // q is n x T
///     store.commit();
///
/// Names are paths ("group/sub/name"); groups are made when needed. Matrices are row-major as HDF5 has it: rows of the
/// dataset are rows of the matrix (`write`) or its columns (`write_columns`: our column-per-instant matrices become
/// time x quantity). Datasets above 64 KiB are chunked, and deflated where that saves a quarter. Use from one
/// thread at a time.
/// @throws InvalidInput  when the folder is missing or not writable, the disc is full, or a name is written twice; the
///                       message names file, dataset and remedy
class StoreWriter {
 public:
  /// @param kind         what the file holds, kept as its attributes `kind` and `description`
  /// @param unit_system  a scene's `units`, "SI" or "dimensionless": what the model's numbers are in
  StoreWriter(std::filesystem::path path, FileKind kind, const std::string& unit_system = "SI");
  /// Into a store that is still empty and outlives the writer.
  explicit StoreWriter(MemoryStore& store, const std::string& unit_system = "SI");
  ~StoreWriter();
  StoreWriter(StoreWriter&&) noexcept;
  StoreWriter& operator=(StoreWriter&&) noexcept;

  void write(const std::string& name, double value, const Meaning& meaning);
  void write(const std::string& name, std::int64_t value, const Meaning& meaning);
  void write(const std::string& name, const std::string& value, const Meaning& meaning);
  void write(const std::string& name, const Eigen::VectorXd& values, const Meaning& meaning);
  void write(const std::string& name, const std::vector<double>& values, const Meaning& meaning);
  void write(const std::string& name, const std::vector<std::int64_t>& values, const Meaning& meaning);
  void write(const std::string& name, const std::vector<std::string>& values, const Meaning& meaning);
  void write(const std::string& name, const Eigen::MatrixXd& values, const Meaning& meaning);
  /// Dataset of shape values.cols() x values.rows(): one row per column of `values`. No copy is made.
  void write_columns(const std::string& name, const Eigen::MatrixXd& values, const Meaning& meaning);
  /// A dataset of another store as it is, a group with its description.
  void write(const Dataset& dataset);
  /// Makes a group, if not there yet, and gives it a `description`.
  void describe_group(const std::string& name, const std::string& description);

  /// Flushes, syncs and renames. After it nothing more can be written.
  void commit();

  /// Where the file will be.
  [[nodiscard]] const std::filesystem::path& path() const;

 private:
  [[nodiscard]] Meaning stored(const Meaning& meaning) const;

  std::unique_ptr<StoreTarget> target_;
  bool dimensionless_;
};

/// One thing inside a file, as `slipmode info` shows it.
struct StoreEntry {
  enum class Kind : std::uint8_t { kGroup, kDouble, kInteger, kText, kOther } kind = Kind::kGroup;
  std::string name;                 ///< full path, without a leading slash
  std::vector<std::int64_t> shape;  ///< empty for scalars and groups
  Meaning meaning;
};

/// Reads one HDF5 file, ours or anybody's, or a MemoryStore. HDF5's own error printing is silenced; every failure is an
/// InvalidInput that names file, dataset and remedy: missing file, not HDF5, truncated, missing dataset, wrong type,
/// wrong shape. Use from one thread at a time.
class StoreReader {
 public:
  explicit StoreReader(std::filesystem::path path);
  /// Of a store in memory, under its own name.
  explicit StoreReader(std::shared_ptr<const MemoryStore> store);
  ~StoreReader();
  StoreReader(StoreReader&&) noexcept;
  StoreReader& operator=(StoreReader&&) noexcept;

  /// Any length or size is accepted where it is not given.
  static constexpr Eigen::Index kAny = -1;

  [[nodiscard]] double number(const std::string& name) const;
  [[nodiscard]] std::int64_t integer(const std::string& name) const;
  [[nodiscard]] std::string text(const std::string& name) const;
  [[nodiscard]] Eigen::VectorXd vector(const std::string& name, Eigen::Index size = kAny) const;
  [[nodiscard]] std::vector<std::int64_t> integers(const std::string& name, Eigen::Index size = kAny) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& name, Eigen::Index size = kAny) const;
  /// The dataset's rows as the matrix's rows.
  [[nodiscard]] Eigen::MatrixXd matrix(const std::string& name, Eigen::Index rows = kAny,
                                       Eigen::Index cols = kAny) const;
  /// The dataset's rows as the matrix's columns: the inverse of `write_columns`. `rows` and `cols` are the matrix's.
  [[nodiscard]] Eigen::MatrixXd columns(const std::string& name, Eigen::Index rows = kAny,
                                        Eigen::Index cols = kAny) const;

  /// Any dataset as it is: floating-point numbers and integers of every width as double and int64.
  [[nodiscard]] Dataset dataset(const std::string& name) const;

  /// A text attribute of the file itself; empty when it has none of that name.
  [[nodiscard]] std::string attribute(const std::string& key) const;
  /// True when a group or dataset of that name exists.
  [[nodiscard]] bool has(const std::string& name) const;
  /// Names directly inside a group ("" for the root), sorted.
  [[nodiscard]] std::vector<std::string> names(const std::string& group = "") const;
  /// Kind, shape, units and description of one thing.
  [[nodiscard]] StoreEntry entry(const std::string& name) const;
  /// Every group and dataset, depth first, sorted by name.
  [[nodiscard]] std::vector<StoreEntry> entries() const;

  [[nodiscard]] const std::filesystem::path& path() const;

  /// Throws InvalidInput "file: name: what; remedy". For readers of typed content that find it inconsistent.
  [[noreturn]] void fail(const std::string& name, const std::string& what) const;

 private:
  std::unique_ptr<StoreSource> source_;
};

}  // namespace slipmode::results
