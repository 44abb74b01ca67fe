#include "dynamics/kernels/kernels.hpp"

#include "core/errors.hpp"

#include <cstdlib>
#include <string>
#include <string_view>

namespace slipmode::dynamics::kernels {

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
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    sets.push_back(&avx512::kSet);
  if (avx2) sets.push_back(&avx2::kSet);
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

}  // namespace slipmode::dynamics::kernels
