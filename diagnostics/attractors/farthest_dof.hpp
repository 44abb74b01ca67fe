#pragma once

#include <slipmode/dynamics/system.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// The degree of freedom most links of the stiffness matrix away from any contact, where stick and slip disturb a
/// velocity least; the first of several, the first of all without contacts. Source: S4, section 3.2.
[[nodiscard]] Eigen::Index farthest_dof(const dynamics::HybridSystem& system);

}  // namespace slipmode::diagnostics
