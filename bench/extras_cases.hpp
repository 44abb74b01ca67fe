#pragma once

#include "bench/library_cases.hpp"

namespace slipmode::bench {

/// What a scene pays for that names no extras: ten masses, Coulomb friction, read from a scene, beside the same system
/// made by hand; then with each extra named (contact spring, load that varies, tilt, normal vibration). Time per event
/// and regimes built, all by turns.
[[nodiscard]] Row measure_extras(bool quick);

}  // namespace slipmode::bench
