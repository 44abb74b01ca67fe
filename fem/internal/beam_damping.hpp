#pragma once

#include <slipmode/fem/beam_elements.hpp>
#include <slipmode/fem/beam_options.hpp>
#include <slipmode/fem/structure.hpp>

/// Inside of beam.hpp, not for use elsewhere.
namespace slipmode::fem::detail {

/// The structure of the assembled beam with the damping asked for: C = aM + bK from coefficients or from ratios at one
/// or two frequencies, or C = M Φ diag(2 ζ_i ω_i) Φᵀ M (dense) from a ratio for each natural mode.
/// @throws InvalidInput  if a coefficient, ratio or frequency is out of range, or if C would not be positive
///                       semi-definite
[[nodiscard]] Structure damped_beam(MassAndStiffness matrices, const BeamDamping& damping,
                                    std::vector<std::string> dof_names);

}  // namespace slipmode::fem::detail
