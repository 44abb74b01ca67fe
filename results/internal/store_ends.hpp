#pragma once

#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/store.hpp>

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace slipmode::results {

/// Where a StoreWriter's datasets go. An empty shape is a scalar; numbers are row-major.
class StoreTarget {
 public:
  using Shape = std::vector<std::int64_t>;

  explicit StoreTarget(std::filesystem::path path) : path_(std::move(path)) {}
  virtual ~StoreTarget() = default;
  StoreTarget(const StoreTarget&) = delete;
  StoreTarget& operator=(const StoreTarget&) = delete;

  virtual void write(const std::string& name, const Shape& shape, const double* values, const Meaning& meaning) = 0;
  virtual void write(const std::string& name, const Shape& shape, const std::int64_t* values,
                     const Meaning& meaning) = 0;
  virtual void write(const std::string& name, const Shape& shape, std::span<const std::string> values,
                     const Meaning& meaning) = 0;
  virtual void describe_group(const std::string& name, const std::string& description) = 0;
  virtual void commit() = 0;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Throws InvalidInput "file: name: what".
  [[noreturn]] void fail(const std::string& name, const std::string& what) const;

 private:
  std::filesystem::path path_;
};

/// Where a StoreReader's datasets come from.
class StoreSource {
 public:
  /// Kind and shape of a dataset.
  struct Opened {
    StoreEntry::Kind kind = StoreEntry::Kind::kOther;
    std::vector<std::int64_t> shape;
  };

  explicit StoreSource(std::filesystem::path path) : path_(std::move(path)) {}
  virtual ~StoreSource() = default;
  StoreSource(const StoreSource&) = delete;
  StoreSource& operator=(const StoreSource&) = delete;

  [[nodiscard]] virtual bool has(const std::string& name) const = 0;
  [[nodiscard]] virtual std::vector<std::string> names(const std::string& group) const = 0;
  [[nodiscard]] virtual std::string attribute(const std::string& key) const = 0;
  [[nodiscard]] virtual StoreEntry entry(const std::string& name) const = 0;
  /// Makes a dataset that is there the one that `read` and `texts` are about. @throws InvalidInput  if it is none
  virtual Opened open(const std::string& name) = 0;
  virtual void read(double* out_values) const = 0;
  virtual void read(std::int64_t* out_values) const = 0;
  [[nodiscard]] virtual std::vector<std::string> texts() const = 0;

  /// The same with a kind and shape that must be found. Integers count as numbers.
  std::vector<std::int64_t> open_as(const std::string& name, StoreEntry::Kind wanted, const char* what,
                                    std::initializer_list<Eigen::Index> shape);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& name, const std::string& what) const;

 private:
  /// @throws InvalidInput  with what is there instead
  Opened open_present(const std::string& name);

  std::filesystem::path path_;
};

[[nodiscard]] std::unique_ptr<StoreTarget> memory_target(MemoryStore& store);
[[nodiscard]] std::unique_ptr<StoreSource> memory_source(std::shared_ptr<const MemoryStore> store);

}  // namespace slipmode::results
