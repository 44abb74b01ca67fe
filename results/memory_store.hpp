#pragma once

#include <slipmode/results/file_kind.hpp>
#include <slipmode/results/store.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace slipmode::results {

/// A dataset with its values, or a group with its description. Of the three arrays the one of its kind is set; numbers
/// are row-major and keep alive what owns them.
struct Dataset : StoreEntry {
  std::shared_ptr<const double> numbers = {};
  std::shared_ptr<const std::int64_t> integers = {};
  std::vector<std::string> texts = {};

  /// Number of values; 1 of a scalar.
  [[nodiscard]] std::size_t count() const;
};

/// What a study gives to be kept, in a file or in memory.
struct Content {
  /// Numbers of a result that lives as long as its owner.
  struct Memory {
    std::shared_ptr<const void> owner;
    std::span<const double> numbers;
  };

  FileKind kind;
  std::string unit_system;                  ///< a scene's `units`
  std::function<void(StoreWriter&)> write;  ///< provenance included
  std::vector<Memory> shared = {};          ///< what a MemoryStore need not copy

  /// @throws InvalidInput  as StoreWriter
  void save(const std::filesystem::path& path) const;
};

/// What a result file holds, in memory: the same names, shapes, units and descriptions, in the order they were written.
/// Once filled it is not changed, so several threads may read it.
class MemoryStore {
 public:
  explicit MemoryStore(const Content& content);
  /// All of a file that has numbers or text. @throws InvalidInput  as StoreReader
  explicit MemoryStore(const StoreReader& file);

  /// @throws InvalidInput  if there is one of that name
  void add(Dataset dataset);
  /// The same with values to be copied or, where they lie in memory that is shared, shared.
  void add(StoreEntry what, const double* values);

  /// As messages call it: its kind, or the file it was read from.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The word of its kind, empty of other programs' files.
  [[nodiscard]] const std::string& kind() const { return kind_; }
  /// Groups that were described are among them.
  [[nodiscard]] const std::vector<Dataset>& datasets() const { return datasets_; }
  /// Null when it is neither a dataset nor a group with a description.
  [[nodiscard]] const Dataset* find(const std::string& name) const;

  /// The file that a StoreWriter would have made instead. @throws InvalidInput  as StoreWriter, and for a file of
  /// another program
  void save(const std::filesystem::path& path) const;

 private:
  std::string kind_, name_;
  std::vector<Content::Memory> borrowed_;
  std::vector<Dataset> datasets_;
  std::map<std::string, std::size_t> index_;
};

}  // namespace slipmode::results
