// Compiled as the library is, and data alone: it may be read on any processor.

#include "core/kernels/internal/processor.hpp"

namespace slipmode::kernels {

const std::uint32_t kBuiltFor = 0
#ifdef __SSE4_2__
                                | kSse42
#endif
#ifdef __POPCNT__
                                | kPopcnt
#endif
#ifdef __AVX2__
                                | kAvx2
#endif
#ifdef __FMA__
                                | kFma
#endif
#ifdef __BMI2__
                                | kBmi2
#endif
#ifdef __AVX512F__
                                | kAvx512f
#endif
#ifdef __AVX512DQ__
                                | kAvx512dq
#endif
#ifdef __AVX512BW__
                                | kAvx512bw
#endif
#ifdef __AVX512VL__
                                | kAvx512vl
#endif
    ;

}  // namespace slipmode::kernels
