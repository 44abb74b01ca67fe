#pragma once

#include <slipmode/fem/beam_options.hpp>
#include <slipmode/fem/structure.hpp>

#include <Eigen/Core>
#include <limits>
#include <vector>

/// The elements behind beam.hpp. Not meant for use outside this folder: inputs are not checked, except by
/// check_beam_options.
///
/// An element has the degrees of freedom (y₁, θ₁, y₂, θ₂): displacement of the centre line and rotation of the section
/// at its ends. Its shape functions are the exact static solution for loads at the ends, EI θ‴ = 0 and
/// κGA (y′ − θ) = −EI θ″, so y is cubic, θ quadratic and the shear angle y′ − θ constant. Φ = 12 EI/(κGA l²) measures
/// shear; Φ = 0 gives Hermite's functions. Derivation: docs/theory/beam.md.
namespace slipmode::fem::detail {

/// A uniform piece of beam between two nodes.
struct BeamElement {
  double length = 0.0;                                     ///< l [m]
  double bending = 0.0;                                    ///< EI [N m²]
  double mass = 0.0;                                       ///< ρA [kg/m]
  double half_thickness = 0.0;                             ///< from the centre line to the surface [m]
  double shear = std::numeric_limits<double>::infinity();  ///< κGA [N]; infinite: no shear
  double rotary = 0.0;                                     ///< ρI [kg m]; 0: no rotary inertia

  /// Φ = 12 EI/(κGA l²).
  [[nodiscard]] double shear_ratio() const { return 12.0 * bending / (shear * length * length); }
};

/// What a theory counts beside bending and translation.
struct BeamEffects {
  bool shear = false;
  bool rotary = false;
};

[[nodiscard]] BeamEffects effects_of(BeamTheory theory);

/// Row over (y₁, θ₁, y₂, θ₂) that gives y, y′, θ or θ′ at ξ = x/l in [0, 1].
[[nodiscard]] Eigen::RowVector4d displacement_functions(const BeamElement& element, double xi);
[[nodiscard]] Eigen::RowVector4d slope_functions(const BeamElement& element, double xi);
[[nodiscard]] Eigen::RowVector4d rotation_functions(const BeamElement& element, double xi);
[[nodiscard]] Eigen::RowVector4d curvature_functions(const BeamElement& element, double xi);

/// ∫ EI θ′² + κGA (y′ − θ)² dx as a quadratic form.
[[nodiscard]] Eigen::Matrix4d element_stiffness(const BeamElement& element);
/// ∫ ρA ẏ² + ρI θ̇² dx as a quadratic form (consistent with the shape functions).
[[nodiscard]] Eigen::Matrix4d element_mass(const BeamElement& element);
/// m (ẏ + e θ̇)² + J θ̇² as a quadratic form in (y, θ) of the last node.
[[nodiscard]] Eigen::Matrix2d tip_mass(const TipBody& tip);

/// Elements from the clamp to the free end, in order.
[[nodiscard]] std::vector<BeamElement> beam_elements(const BeamOptions& options, BeamEffects effects);

struct MassAndStiffness {
  SparseMatrix M, K;
};

/// Assembled with the clamped node struck out: dof 2k is y, 2k + 1 is θ of node k + 1.
[[nodiscard]] MassAndStiffness assemble_beam(const std::vector<BeamElement>& elements, const TipBody& tip);

/// @throws InvalidInput  naming the value and what would be valid. Poisson's ratio and the shear coefficient are
///                       looked at only with shear.
void check_beam_options(const BeamOptions& options, BeamEffects effects);

}  // namespace slipmode::fem::detail
