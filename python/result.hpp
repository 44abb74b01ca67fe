#pragma once

#include <slipmode/results/memory_store.hpp>

#include <memory>
#include <mutex>
#include <utility>

namespace slipmode::python {

/// A result in memory.
class Result {
 public:
  /// Laid out at once: that may run the model again, and so belongs inside the study's call.
  explicit Result(const results::Content& content) : Result(std::make_shared<const results::MemoryStore>(content)) {}
  explicit Result(std::shared_ptr<const results::MemoryStore> store) { kept_->store = std::move(store); }

  /// Laid out when it is first looked at: of what only has to be described, which a short run's caller may never read.
  [[nodiscard]] static Result unread(results::Content content) {
    Result own;
    own.kept_->content = std::move(content);
    return own;
  }

  /// Safe to be called by several threads.
  [[nodiscard]] const std::shared_ptr<const results::MemoryStore>& store() const {
    std::call_once(kept_->looked_at, [&own = *kept_] {
      if (!own.store) own.store = std::make_shared<const results::MemoryStore>(own.content);
      own.content = {};
    });
    return kept_->store;
  }
  [[nodiscard]] results::StoreReader reader() const { return results::StoreReader(store()); }

 private:
  Result() = default;

  struct Kept {
    std::once_flag looked_at;
    results::Content content;  ///< until then
    std::shared_ptr<const results::MemoryStore> store;
  };
  std::shared_ptr<Kept> kept_ = std::make_shared<Kept>();
};

}  // namespace slipmode::python
