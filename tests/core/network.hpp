#pragma once

#include <slipmode/core/ranks.hpp>

#include <atomic>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::tests {

/// Queues between ranks that are threads of one process.
class Network {
 public:
  explicit Network(int count) : queues_(static_cast<std::size_t>(count)) {}

  [[nodiscard]] Ranks rank(int own) {
    const auto at = [this](int rank) -> std::deque<Parcel>& { return queues_[static_cast<std::size_t>(rank)]; };
    return {.own = own,
            .count = static_cast<int>(queues_.size()),
            .send =
                [this, own, at](int to, std::string bytes) {
                  const std::scoped_lock lock(mutex_);
                  at(to).push_back({own, std::move(bytes)});
                },
            .receive = [this, own, at]() -> std::optional<Parcel> {
              const std::scoped_lock lock(mutex_);
              if (at(own).empty()) return std::nullopt;
              Parcel first = std::move(at(own).front());
              at(own).pop_front();
              return first;
            },
            .leave = [this] { ++left; },
            .abort = [this](int code) { aborted = code; }};
  }

  std::atomic<int> left = 0, aborted = 0;

 private:
  std::mutex mutex_;
  std::vector<std::deque<Parcel>> queues_;
};

}  // namespace slipmode::tests
