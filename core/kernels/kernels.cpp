#include <slipmode/core/kernels/kernels.hpp>

#include <slipmode/core/errors.hpp>
#include "core/kernels/internal/processor.hpp"

#include <cstdlib>
#include <string>
#include <string_view>

namespace slipmode::kernels {

#ifdef SLIPMODE_KERNELS_X86
namespace avx512 {
extern const Kernels kSet;
}
namespace avx2 {
extern const Kernels kSet;
}
#endif
namespace generic {
extern const Kernels kSet;
}

namespace {

std::vector<const Kernels*> sets_of_this_processor() {
  std::vector<const Kernels*> sets;
#ifdef SLIPMODE_KERNELS_X86
  // Each is built for a whole level of x86-64: compilers use what else belongs to it.
  constexpr std::uint32_t kLevel3 = kSse42 | kPopcnt | kAvx2 | kFma | kBmi2;
  constexpr std::uint32_t kLevel4 = kLevel3 | kAvx512f | kAvx512dq | kAvx512bw | kAvx512vl;
  const std::uint32_t present = features_of_processor();
  if (missing(kLevel4, present) == nullptr) sets.push_back(&avx512::kSet);
  if (missing(kLevel3, present) == nullptr) sets.push_back(&avx2::kSet);
#endif
  sets.push_back(&generic::kSet);
  return sets;
}

const Kernels& choose() {
  const char* asked = std::getenv("SLIPMODE_KERNELS");
  if (asked == nullptr) return *available().front();
  std::string known;
  for (const Kernels* set : available()) {
    if (std::string_view(asked) == set->name) return *set;
    known += (known.empty() ? "" : ", ") + std::string(set->name);
  }
  throw InvalidInput("environment variable SLIPMODE_KERNELS is '" + std::string(asked) +
                     "'; on this processor it can be " + known + ", or unset for the first of these");
}

}  // namespace

const std::vector<const Kernels*>& available() {
  static const std::vector<const Kernels*> sets = sets_of_this_processor();
  return sets;
}

const Kernels& kernels() {
  static const Kernels& chosen = choose();
  return chosen;
}

}  // namespace slipmode::kernels
