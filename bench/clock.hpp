#pragma once

#include <slipmode/core/median.hpp>

#include <chrono>
#include <ctime>
#include <vector>

namespace slipmode::bench {

/// CPU time of the calling thread [s]: other work on the machine does not count.
[[nodiscard]] inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// CPU time of the whole process, all threads [s].
[[nodiscard]] inline double process_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Time on the clock [s], for work on several threads.
[[nodiscard]] inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds of this thread's CPU that one call takes.
template <class Work>
[[nodiscard]] double thread_seconds_of(const Work& work) {
  const double begin = thread_seconds();
  work();
  return thread_seconds() - begin;
}

/// Median CPU time of a call [s].
template <class Work>
[[nodiscard]] double median_seconds(int repeats, const Work& work) {
  std::vector<double> times;
  for (int k = 0; k < repeats; ++k) times.push_back(thread_seconds_of(work));
  return median(times);
}

}  // namespace slipmode::bench
