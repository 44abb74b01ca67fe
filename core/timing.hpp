#pragma once

#include <slipmode/core/median.hpp>

#include <chrono>
#include <ctime>
#include <utility>
#include <vector>

namespace slipmode {

/// Clock and processor time of a piece of work [s].
struct Times {
  double wall = 0.0;
  double cpu = 0.0;
};

/// Processor time of the calling thread so far [s]: what other threads do meanwhile does not count.
[[nodiscard]] inline double thread_cpu() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// What one call of `work` takes, which runs in the calling thread.
template <class Work>
[[nodiscard]] Times timed(const Work& work) {
  const auto wall = std::chrono::steady_clock::now();
  const double cpu = thread_cpu();
  work();
  return {.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(),
          .cpu = thread_cpu() - cpu};
}

/// The median of each of the two.
[[nodiscard]] inline Times median_times(const std::vector<Times>& times) {
  std::vector<double> wall;
  std::vector<double> cpu;
  for (const Times& t : times) {
    wall.push_back(t.wall);
    cpu.push_back(t.cpu);
  }
  return {.wall = median(std::move(wall)), .cpu = median(std::move(cpu))};
}

}  // namespace slipmode
