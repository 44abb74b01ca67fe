#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>

namespace slipmode::dynamics {

/// The longest step of 24 binary digits up to a length. Its halves have no more, so times that are sums of steps are
/// exact until 2⁵³⁻²⁴ of the last level's: with any length clock and motion part by the rounding of the time at each
/// step, always to one side, and by their number, as the square of the time, in all.
[[nodiscard]] inline double first_step(double longest) {
  constexpr int kDigits = 24;
  int exponent = 0;
  const double mantissa = std::frexp(longest, &exponent);
  return std::isfinite(longest) ? std::ldexp(std::floor(std::ldexp(mantissa, kDigits)), exponent - kDigits) : longest;
}

/// One table per level, built when first asked for and kept; safe to share between threads.
template <class T, int levels>
class LazyLevels {
 public:
  LazyLevels() = default;
  LazyLevels(const LazyLevels&) = delete;
  LazyLevels& operator=(const LazyLevels&) = delete;
  ~LazyLevels() {
    for (auto& slot : slots_) delete slot.load();
  }

  /// @param make  make(T&) fills a new table; called at most once per level
  template <class Make>
  [[nodiscard]] const T& get(int level, Make make) const {
    auto& slot = slots_[static_cast<std::size_t>(level)];
    if (const T* table = slot.load(std::memory_order_acquire)) return *table;
    const std::lock_guard lock(building_);
    if (const T* table = slot.load(std::memory_order_acquire)) return *table;
    auto table = std::make_unique<T>();
    make(*table);
    slot.store(table.get(), std::memory_order_release);
    return *table.release();
  }

 private:
  mutable std::mutex building_;
  mutable std::array<std::atomic<const T*>, levels> slots_{};
};

}  // namespace slipmode::dynamics
