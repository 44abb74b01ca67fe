#pragma once

#include <slipmode/core/ranks.hpp>

#include <atomic>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::tests {

/// Queues between ranks that are threads of one process. Parcels of one sender arrive in order, those of several in
/// any, as under MPI.
class Network {
 public:
  explicit Network(int count) : count_(static_cast<std::size_t>(count)), queues_(count_ * count_) {}

  [[nodiscard]] Ranks rank(int own) {
    return {.own = own,
            .count = static_cast<int>(count_),
            .send =
                [this, own](int to, std::string bytes) {
                  const std::scoped_lock lock(mutex_);
                  queue(static_cast<std::size_t>(own), to).push_back({own, std::move(bytes)});
                },
            .receive = [this, own]() -> std::optional<Parcel> {
              const std::scoped_lock lock(mutex_);
              const std::size_t begin = random_();
              for (std::size_t k = 0; k < count_; ++k) {
                std::deque<Parcel>& arrived = queue((begin + k) % count_, own);
                if (arrived.empty()) continue;
                Parcel first = std::move(arrived.front());
                arrived.pop_front();
                return first;
              }
              return std::nullopt;
            },
            .leave = [this] { ++left; },
            .abort = [this](int code) { aborted = code; }};
  }

  std::atomic<int> left = 0, aborted = 0;

 private:
  std::deque<Parcel>& queue(std::size_t from, int to) { return queues_[from * count_ + static_cast<std::size_t>(to)]; }

  std::mutex mutex_;
  std::minstd_rand random_;
  std::size_t count_;
  std::vector<std::deque<Parcel>> queues_;  ///< by sender, then by receiver
};

}  // namespace slipmode::tests
