#include "bench/kernel_cases.hpp"

#include "bench/clock.hpp"
#include "bench/machine.hpp"

#include <fmt/format.h>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace slipmode::bench {
namespace {

#if defined(__x86_64__)

/// Sums that do not wait for each other: enough to fill two units of four or five cycles each, and fit in 16 registers.
constexpr int kSums = 12;

// The same loop for each width; the compiler may use a width only within a function that says so.

__attribute__((target("avx2,fma"))) double four_lanes(long rounds) {
  __m256d sums[kSums];
  for (int k = 0; k < kSums; ++k) sums[k] = _mm256_set1_pd(k);  // or the compiler keeps one for all
  const __m256d factor = _mm256_set1_pd(0.5), term = _mm256_set1_pd(1.0);
  for (long r = 0; r < rounds; ++r) {
    for (__m256d& sum : sums) sum = _mm256_fmadd_pd(sum, factor, term);
  }
  __m256d all = sums[0];
  for (int k = 1; k < kSums; ++k) all = _mm256_add_pd(all, sums[k]);
  return _mm256_cvtsd_f64(all);
}

__attribute__((target("avx512f"))) double eight_lanes(long rounds) {
  __m512d sums[kSums];
  for (int k = 0; k < kSums; ++k) sums[k] = _mm512_set1_pd(k);
  const __m512d factor = _mm512_set1_pd(0.5), term = _mm512_set1_pd(1.0);
  for (long r = 0; r < rounds; ++r) {
    for (__m512d& sum : sums) sum = _mm512_fmadd_pd(sum, factor, term);
  }
  __m512d all = sums[0];
  for (int k = 1; k < kSums; ++k) all = _mm512_add_pd(all, sums[k]);
  return _mm512_cvtsd_f64(all);
}

struct Width {
  int lanes;
  double (*loop)(long rounds);
};

std::vector<Width> widths() {
  std::vector<Width> all;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) all.push_back({4, four_lanes});
  if (__builtin_cpu_supports("avx512f")) all.push_back({8, eight_lanes});
  return all;
}

#endif

}  // namespace

Row measure_kernels(bool quick) {
  Row out;
#if defined(__x86_64__)
  const long rounds = quick ? 2'000'000 : 20'000'000;
  for (const Width& width : widths()) {
    std::vector<double> rates;
    volatile double result = width.loop(rounds / 10);  // clock and vector units up to speed
    for (int k = 0; k < 5; ++k) {
      const double seconds = thread_seconds_of([&] { result = width.loop(rounds); });
      rates.push_back(static_cast<double>(rounds) * kSums * width.lanes / seconds);
    }
    const double rate = median(rates);
    out.lines.push_back(fmt::format("peak: {:.1f} fused multiply-adds of doubles per ns, {} at a time{}", 1e-9 * rate,
                                    width.lanes, width.lanes == kernel_lanes() ? ", as the library's kernels" : ""));
    out.figures.emplace_back(fmt::format("fma_per_ns_{}_lanes", width.lanes), 1e-9 * rate);
    out.timed.push_back({.name = fmt::format("1e9 FMA {} at a time", width.lanes), .ms = 1e12 / rate});
  }
#endif
  return out;
}

}  // namespace slipmode::bench
