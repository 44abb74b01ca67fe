// Compiled for the plainest processor: it runs before anything else does.

#include "core/kernels/internal/processor.hpp"

#include <unistd.h>
#include <cstring>

namespace slipmode::kernels {
namespace {

struct Name {
  Feature feature;
  const char* word;
};
constexpr Name kNames[] = {
    {kSse42, "SSE4.2"},      {kPopcnt, "POPCNT"},    {kAvx2, "AVX2"},          {kFma, "FMA"},
    {kBmi2, "BMI2"},         {kAvx512f, "AVX-512F"}, {kAvx512dq, "AVX-512DQ"}, {kAvx512bw, "AVX-512BW"},
    {kAvx512vl, "AVX-512VL"}};

void say(const char* text) {
  // To a closed standard error nothing can be said.
  if (write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
}

/// Bad input, of a kind: the program was given the wrong processor.
constexpr int kExitBadInput = 2;

/// Before the constructors of the program's own objects, which may hold instructions from beyond.
[[gnu::constructor(101)]] void check_processor() {
  const char* word = missing(kBuiltFor, features_of_processor());
  if (word == nullptr) return;
  say("slipmode: this program was built for processors with ");
  say(word);
  say(", which this one has not; expected a build with -DSLIPMODE_ARCH=x86-64-v2, or x86-64 for the oldest\n");
  _exit(kExitBadInput);
}

}  // namespace

std::uint32_t features_of_processor() {
  std::uint32_t features = 0;
#ifdef SLIPMODE_KERNELS_X86
  __builtin_cpu_init();
  if (__builtin_cpu_supports("sse4.2")) features |= kSse42;
  if (__builtin_cpu_supports("popcnt")) features |= kPopcnt;
  if (__builtin_cpu_supports("avx2")) features |= kAvx2;
  if (__builtin_cpu_supports("fma")) features |= kFma;
  if (__builtin_cpu_supports("bmi2")) features |= kBmi2;
  if (__builtin_cpu_supports("avx512f")) features |= kAvx512f;
  if (__builtin_cpu_supports("avx512dq")) features |= kAvx512dq;
  if (__builtin_cpu_supports("avx512bw")) features |= kAvx512bw;
  if (__builtin_cpu_supports("avx512vl")) features |= kAvx512vl;
#endif
  return features;
}

const char* missing(std::uint32_t needed, std::uint32_t present) {
  for (const Name& name : kNames)
    if ((needed & name.feature) != 0 && (present & name.feature) == 0) return name.word;
  return nullptr;
}

}  // namespace slipmode::kernels
