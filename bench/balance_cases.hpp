#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// Harmonic balance beside the alternating scheme on Eigen and FFTW with 1,024 samples, at equal true error; a balance
/// of 49 harmonics, and a certificate, each in time.
[[nodiscard]] Row measure_balances(bool quick);

}  // namespace slipmode::bench
