#include "bench/machine.hpp"

#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/results/provenance.hpp>
#include "bench/clock.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <thread>

namespace slipmode::bench {
namespace {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string vector_widths() {
  std::string names = "2 doubles";
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) names += ", 4 (AVX2)";
  if (__builtin_cpu_supports("avx512f")) names += ", 8 (AVX-512)";
#endif
  return names;
}

/// CPU time of the whole machine since it started, time that other guests took included [s].
double machine_seconds() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0.0, nice = 0.0, system = 0.0, idle = 0.0, wait = 0.0, irq = 0.0, soft_irq = 0.0, steal = 0.0;
  file >> name >> user >> nice >> system >> idle >> wait >> irq >> soft_irq >> steal;
  return (user + nice + system + irq + soft_irq + steal) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// A chain of operations that each wait for the one before: takes the same number of clock cycles every time.
void calibration_loop() {
  volatile double start = 1.0;
  double x = start;
  for (int i = 0; i < 20'000'000; ++i) x = 0.5 * x + 1.0;
  start = x;
}

}  // namespace

int kernel_lanes() {
  const std::string_view name = kernels::kernels().name;
  return name == "avx512" ? 8 : name == "avx2" ? 4 : 2;
}

Machine this_machine() {
  const std::string arch = SLIPMODE_BENCH_ARCH;
  return {.processor = processor_name(),
          .threads = static_cast<int>(std::thread::hardware_concurrency()),
          .vectors = vector_widths(),
          .kernels = kernels::kernels().name,
          .compiler = results::compiler(),
          .flags = SLIPMODE_BENCH_FLAGS,
          .arch = arch.empty() ? "compiler's default" : arch,
          .commit = results::git_commit(),
          .date = fmt::format("{:%Y-%m-%d %H:%M}", fmt::gmtime(std::time(nullptr)))};
}

std::string description(const Machine& m) {
  return fmt::format("{}, {} threads; vectors: {}; kernels: {}\n{}; {}; SLIPMODE_ARCH {}\ncommit {}; {} UTC",
                     m.processor, m.threads, m.vectors, m.kernels, m.compiler, m.flags, m.arch, m.commit, m.date);
}

std::string Quietness::text() const {
  if (quiet()) return "quiet";
  return fmt::format(
      "not quiet: load {:.1f}; others took {:.2f} processors; a loop before and after {:.0f} % of the clock; {:+.1f} %",
      load, others, 100.0 * share, 100.0 * drift);
}

Watch::Reading Watch::now() {
  Reading reading{};
  const double wall = wall_seconds(), cpu = thread_seconds();
  calibration_loop();
  reading.loop_wall = wall_seconds() - wall;
  reading.loop_cpu = thread_seconds() - cpu;
  reading.wall = wall_seconds();
  reading.own = process_seconds();
  reading.all = machine_seconds();
  return reading;
}

Quietness Watch::lap() {
  const Reading before = last_;
  last_ = now();
  const double wall = last_.wall - before.wall;
  Quietness out;
  double load = 0.0;
  if (getloadavg(&load, 1) == 1) out.load = load;
  out.others = std::max(0.0, (last_.all - before.all) - (last_.own - before.own)) / wall;
  out.share = std::min(before.loop_cpu / before.loop_wall, last_.loop_cpu / last_.loop_wall);
  out.drift = last_.loop_cpu / before.loop_cpu - 1.0;
  return out;
}

}  // namespace slipmode::bench
