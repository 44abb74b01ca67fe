#pragma once

#include <slipmode/results/memory_store.hpp>

#include <memory>
#include <utility>

namespace slipmode::python {

/// A result in memory. Laying out what a study gave may run the model again: to be done inside its call.
class Result {
 public:
  explicit Result(const results::Content& content) : store_(std::make_shared<const results::MemoryStore>(content)) {}
  explicit Result(std::shared_ptr<const results::MemoryStore> store) : store_(std::move(store)) {}

  [[nodiscard]] const std::shared_ptr<const results::MemoryStore>& store() const { return store_; }
  [[nodiscard]] results::StoreReader reader() const { return results::StoreReader(store_); }

 private:
  std::shared_ptr<const results::MemoryStore> store_;
};

}  // namespace slipmode::python
