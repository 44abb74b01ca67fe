#pragma once

#include <cstdint>

/// What a processor can do, as far as builds differ by it. The whole library but the kernels is compiled for one level
/// (SLIPMODE_ARCH); on a processor below it a program says so when it starts, instead of ending at its first
/// instruction from beyond.
namespace slipmode::kernels {

enum Feature : std::uint32_t {
  kSse42 = 1u << 0,
  kPopcnt = 1u << 1,
  kAvx2 = 1u << 2,
  kFma = 1u << 3,
  kBmi2 = 1u << 4,
  kAvx512f = 1u << 5,
  kAvx512dq = 1u << 6,
  kAvx512bw = 1u << 7,
  kAvx512vl = 1u << 8,
};

/// What this build needs.
extern const std::uint32_t kBuiltFor;
/// What this processor has.
[[nodiscard]] std::uint32_t features_of_processor();
/// The first feature that is needed and missing, as a word; null when there is none.
[[nodiscard]] const char* missing(std::uint32_t needed, std::uint32_t present);

}  // namespace slipmode::kernels
