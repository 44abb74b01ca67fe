#pragma once

#include <slipmode/results/memory_store.hpp>

#include <memory>
#include <optional>
#include <string>

namespace slipmode::python {

/// A result in memory. What a study gave is laid out when it is first asked for; Python's lock guards that.
class Result {
 public:
  explicit Result(results::Content content) : content_(std::move(content)) {}
  explicit Result(std::shared_ptr<const results::MemoryStore> store) : store_(std::move(store)) {}

  [[nodiscard]] const std::shared_ptr<const results::MemoryStore>& store() {
    if (!store_) {
      store_ = std::make_shared<const results::MemoryStore>(*content_);
      content_.reset();
    }
    return store_;
  }
  /// The word of its kind; without laying it out.
  [[nodiscard]] std::string kind() const { return content_ ? results::words_of(content_->kind).word : store_->kind(); }
  [[nodiscard]] results::StoreReader reader() { return results::StoreReader(store()); }

 private:
  std::optional<results::Content> content_;
  std::shared_ptr<const results::MemoryStore> store_;
};

}  // namespace slipmode::python
