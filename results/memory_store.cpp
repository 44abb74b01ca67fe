#include <slipmode/results/memory_store.hpp>

#include <slipmode/core/errors.hpp>
#include "results/internal/store_ends.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <utility>

namespace slipmode::results {
namespace {

using Kind = StoreEntry::Kind;

template <class T>
std::shared_ptr<const T> copied(const T* values, std::size_t count) {
  const std::shared_ptr<T[]> copy(new T[count]);
  std::copy_n(values, count, copy.get());
  return {copy, copy.get()};
}

class MemoryTarget final : public StoreTarget {
 public:
  explicit MemoryTarget(MemoryStore& store) : StoreTarget(store.name()), store_(store) {}

  void write(const std::string& name, const Shape& shape, const double* values, const Meaning& meaning) override {
    store_.add({Kind::kDouble, name, shape, meaning}, values);
  }
  void write(const std::string& name, const Shape& shape, const std::int64_t* values, const Meaning& meaning) override {
    Dataset dataset{{Kind::kInteger, name, shape, meaning}};
    dataset.integers = copied(values, dataset.count());
    store_.add(std::move(dataset));
  }
  void write(const std::string& name, const Shape& shape, std::span<const std::string> values,
             const Meaning& meaning) override {
    Dataset dataset{{Kind::kText, name, shape, meaning}};
    dataset.texts.assign(values.begin(), values.end());
    store_.add(std::move(dataset));
  }
  void describe_group(const std::string& name, const std::string& description) override {
    store_.add({{Kind::kGroup, name, {}, {"", description}}});
  }
  void commit() override {}

 private:
  MemoryStore& store_;
};

class MemorySource final : public StoreSource {
 public:
  explicit MemorySource(std::shared_ptr<const MemoryStore> store)
      : StoreSource(store->name()), store_(std::move(store)) {}

  [[nodiscard]] bool has(const std::string& name) const override {
    return store_->find(name) != nullptr || !names(name).empty();
  }

  [[nodiscard]] std::vector<std::string> names(const std::string& group) const override {
    const std::string before = group.empty() ? "" : group + "/";
    std::vector<std::string> found;
    for (const Dataset& dataset : store_->datasets()) {
      if (!dataset.name.starts_with(before)) continue;
      found.push_back(dataset.name.substr(before.size(), dataset.name.find('/', before.size()) - before.size()));
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  [[nodiscard]] std::string attribute(const std::string& key) const override {
    return key == "kind" ? store_->kind() : std::string();
  }

  [[nodiscard]] StoreEntry entry(const std::string& name) const override {
    const StoreEntry* const found = store_->find(name);
    return found != nullptr ? *found : StoreEntry{Kind::kGroup, name, {}, {}};
  }

  Opened open(const std::string& name) override {
    opened_ = store_->find(name);
    if (opened_ == nullptr || opened_->kind == Kind::kGroup) fail(name, "is a group; expected a dataset");
    return {opened_->kind, opened_->shape};
  }

  void read(double* out_values) const override {
    if (opened_->kind == Kind::kDouble) {
      std::copy_n(opened_->numbers.get(), opened_->count(), out_values);
    } else {
      std::copy_n(opened_->integers.get(), opened_->count(), out_values);
    }
  }
  void read(std::int64_t* out_values) const override {
    std::copy_n(opened_->integers.get(), opened_->count(), out_values);
  }
  [[nodiscard]] std::vector<std::string> texts() const override { return opened_->texts; }

 private:
  std::shared_ptr<const MemoryStore> store_;
  const Dataset* opened_ = nullptr;
};

}  // namespace

std::unique_ptr<StoreTarget> memory_target(MemoryStore& store) { return std::make_unique<MemoryTarget>(store); }
std::unique_ptr<StoreSource> memory_source(std::shared_ptr<const MemoryStore> store) {
  return std::make_unique<MemorySource>(std::move(store));
}

std::size_t Dataset::count() const {
  std::size_t all = 1;
  for (const std::int64_t extent : shape) all *= static_cast<std::size_t>(extent);
  return all;
}

MemoryStore::MemoryStore(const Content& content)
    : kind_(words_of(content.kind).word), name_(kind_), borrowed_(content.shared) {
  StoreWriter writer(*this, content.unit_system);
  content.write(writer);
}

MemoryStore::MemoryStore(const StoreReader& file) : name_(file.path().string()) {
  const auto kind = kind_of(file);
  kind_ = kind ? words_of(*kind).word : "";
  for (const StoreEntry& entry : file.entries()) {
    if (entry.kind != Kind::kOther) add(file.dataset(entry.name));
  }
}

void MemoryStore::add(Dataset dataset) {
  if (!index_.emplace(dataset.name, datasets_.size()).second)
    throw InvalidInput(fmt::format("{}: {}: written twice", name_, dataset.name));
  datasets_.push_back(std::move(dataset));
}

void MemoryStore::add(StoreEntry what, const double* values) {
  Dataset dataset{std::move(what)};
  const auto holds = [&](const Content::Memory& memory) {
    const double* const end = memory.numbers.data() + memory.numbers.size();
    return std::less_equal<>()(memory.numbers.data(), values) && std::less_equal<>()(values + dataset.count(), end);
  };
  const auto found = std::ranges::find_if(borrowed_, holds);
  dataset.numbers = found == borrowed_.end() || dataset.count() == 0
                        ? copied(values, dataset.count())
                        : std::shared_ptr<const double>(found->owner, values);
  add(std::move(dataset));
}

const Dataset* MemoryStore::find(const std::string& name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &datasets_[found->second];
}

void MemoryStore::save(const std::filesystem::path& path) const {
  const auto kind = std::ranges::find(kFileKinds, kind_, &FileKindWords::word);
  if (kind == kFileKinds.end())
    throw InvalidInput(fmt::format("{}: does not say what it holds; copy the file instead", name_));
  StoreWriter writer(path, static_cast<FileKind>(kind - kFileKinds.begin()));
  for (const Dataset& dataset : datasets_) writer.write(dataset);
  writer.commit();
}

void Content::save(const std::filesystem::path& path) const {
  StoreWriter writer(path, kind, unit_system);
  write(writer);
  writer.commit();
}

}  // namespace slipmode::results
