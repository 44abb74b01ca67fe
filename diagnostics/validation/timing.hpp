#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

/// Inside of cost.hpp and driven_validation.hpp, not for use elsewhere.
namespace slipmode::diagnostics::detail {

/// Clock and processor time of a piece of work [s].
struct Times {
  double wall = 0.0;
  double cpu = 0.0;
};

/// CPU time of the calling thread: other threads of a parallel validation do not count.
inline double thread_cpu() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Work>
Times timed(const Work& work) {
  const auto wall = std::chrono::steady_clock::now();
  const double cpu = thread_cpu();
  work();
  return {.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(),
          .cpu = thread_cpu() - cpu};
}

/// The upper one of two middle values. @param values  not empty
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

inline Times median(const std::vector<Times>& times) {
  std::vector<double> wall;
  std::vector<double> cpu;
  for (const Times& t : times) {
    wall.push_back(t.wall);
    cpu.push_back(t.cpu);
  }
  return {.wall = median(std::move(wall)), .cpu = median(std::move(cpu))};
}

}  // namespace slipmode::diagnostics::detail
