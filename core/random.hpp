#pragma once

#include <cstdint>
#include <random>

namespace slipmode {

/// SplitMix64's output function: a bijection of 64-bit integers that scatters neighbouring values.
/// Source: Steele, Lea, Flood, OOPSLA 2014.
[[nodiscard]] std::uint64_t splitmix64(std::uint64_t x);

/// Random numbers that are the same on every platform: std::mt19937_64 (fixed by the standard) with mappings to
/// doubles of its own, since the standard leaves those of std::uniform_real_distribution and the like open.
class Random {
 public:
  /// Seeds mt19937_64 with `seed` as it stands.
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// A stream of its own for task `index`: seeded with splitmix64(splitmix64(seed) + index), so a task's numbers
  /// depend neither on the thread that runs it nor on how many tasks there are.
  [[nodiscard]] static Random stream(std::uint64_t seed, std::uint64_t index);

  /// Uniform in [0, 1): the upper 53 bits of one draw times 2⁻⁵³.
  [[nodiscard]] double uniform();
  /// Uniform in [low, high): low + (high − low)·uniform().
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal by Box and Muller: sqrt(−2 ln(1 − u₁)) cos(2π u₂), two draws per value, no value kept back.
  [[nodiscard]] double normal();

 private:
  std::mt19937_64 engine_;
};

}  // namespace slipmode
