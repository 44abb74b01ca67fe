#pragma once

#include <string>

namespace slipmode::bench {

/// What figures were measured on and with.
struct Machine {
  std::string processor;  ///< as the system names it
  int threads = 0;        ///< it runs at once
  std::string vectors;    ///< widths it has
  std::string kernels;    ///< the set the library uses: avx512, avx2 or generic
  std::string compiler, flags, arch;
  std::string commit;  ///< with "-dirty" where files differed from it
  std::string date;    ///< UTC
};

[[nodiscard]] Machine this_machine();

/// Three lines.
[[nodiscard]] std::string description(const Machine& machine);

/// Doubles in one vector of the library's kernels.
[[nodiscard]] int kernel_lanes();

/// What is asked of these kernels, as a share of what the project asks of vectors of eight doubles.
[[nodiscard]] inline double wanted_share() { return kernel_lanes() < 8 ? 0.6 : 1.0; }

/// Whether other work disturbed a measurement.
struct Quietness {
  double load = 0.0;    ///< average number of running processes over the minute before it ended, this one included
  double others = 0.0;  ///< processors that other processes, or other guests of the same host, kept busy meanwhile
  double share = 0.0;   ///< CPU time over time on the clock of a loop before and after, the smaller
  double drift = 0.0;   ///< CPU time of the loop after over that before, less 1: heat, clock, a shared core

  [[nodiscard]] bool quiet() const { return others <= 0.1 && share >= 0.97 && drift <= 0.05 && drift >= -0.05; }
  /// "quiet" or "not quiet: load 3.1 ..."
  [[nodiscard]] std::string text() const;
};

/// Watches one stretch of work after the other.
class Watch {
 public:
  Watch() : last_(now()) {}
  /// How quiet it was since the last call, or since the beginning.
  [[nodiscard]] Quietness lap();

 private:
  struct Reading {
    double wall, own, all;       ///< [s]: on the clock; CPU of this process; CPU of the whole machine
    double loop_wall, loop_cpu;  ///< of the same arithmetic each time
  };
  [[nodiscard]] static Reading now();

  Reading last_;
};

}  // namespace slipmode::bench
