#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// 10,000 masses (1,000 when quick) on ground springs, Stribeck, from rest: set-up and 10⁴ units beside dopri5 over
/// 1,000 of them. Errors are those of the contact after 100 units, beside the reference of a chain cut off where no
/// wave comes back from by then.
[[nodiscard]] Row measure_long_chain(bool quick);

}  // namespace slipmode::bench
