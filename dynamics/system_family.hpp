#pragma once

#include <slipmode/dynamics/system.hpp>

#include <functional>

namespace slipmode::dynamics {

/// A system for each value of a parameter, of the same size and kind of drive everywhere. With HybridSystem::with_drive
/// inside, modal data and regimes are shared. Called from several threads at once: must not change anything.
using SystemFamily = std::function<HybridSystem(double parameter)>;
/// The same over two.
using PlaneFamily = std::function<HybridSystem(double one, double other)>;

}  // namespace slipmode::dynamics
