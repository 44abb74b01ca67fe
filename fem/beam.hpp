#pragma once

#include <slipmode/fem/beam_elements.hpp>
#include <slipmode/fem/beam_options.hpp>
#include <slipmode/fem/structure.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::fem {

/// A cantilever of finite elements, clamped at x = 0, with a rigid body on its end. Degrees of freedom: displacement
/// y [m] and rotation θ [rad] of every node but the clamped one, named "y1", "theta1", … from the clamp.
///
/// Rows give quantities anywhere on the beam from the degrees of freedom, row · q: what contacts, sensors and plots
/// stand on. On the rigid extension, L < x ≤ L + extension, displacement is y(L) + (x − L) θ(L): a force at its end
/// does work on y + ℓ y′ (S4 (6.6) and (6.31) subtract ℓ y as well, which mixes units).
/// Source: S4 (6.1)-(6.5) in weak form; Przemieniecki, Theory of Matrix Structural Analysis, 1968, chapters 5 and 11.
class Beam {
 public:
  /// @throws InvalidInput  naming the value and what would be valid
  explicit Beam(BeamOptions options);

  [[nodiscard]] const BeamOptions& options() const { return options_; }
  [[nodiscard]] const Structure& structure() const { return structure_; }
  [[nodiscard]] double length() const { return length_; }                          ///< L, of the spans [m]
  [[nodiscard]] double reach() const { return length_ + options_.tip.extension; }  ///< L + extension [m]
  [[nodiscard]] const std::vector<double>& nodes() const { return nodes_; }        ///< x of all, clamp included

  /// Displacement at x [n]. @throws InvalidInput  unless 0 ≤ x ≤ reach(), to rounding (here and below)
  [[nodiscard]] Eigen::VectorXd displacement_row(double x) const;
  /// Slope y′ of the centre line at x (with Timoshenko elements it differs from the rotation θ) [n], 1/m.
  /// On the extension the rotation of its root. At a node between elements the mean of both sides.
  [[nodiscard]] Eigen::VectorXd slope_row(double x) const;
  /// Curvature θ′ at x [n], 1/m²; 0 on the extension. At a node between elements the mean of both sides.
  /// @throws InvalidInput  unless 0 ≤ x ≤ reach()
  [[nodiscard]] Eigen::VectorXd curvature_row(double x) const;
  /// Bending strain at the surface, ½ thickness · curvature, at 0 ≤ x ≤ L [n], 1/m. At a node between elements the mean
  /// of both sides, each with its own thickness. Source: S4 (4.2), with half the thickness (S4 prints half the width).
  /// @throws InvalidInput  unless 0 ≤ x ≤ L
  [[nodiscard]] Eigen::VectorXd strain_row(double x) const;

  /// The degrees of freedom of a function given by its value and slope at every node, clamp left out [n].
  /// @param value, slope  y(x) and y′(x) at nodes() (all of them; those at the clamp are not used). With Timoshenko
  ///                      elements give the rotation θ(x) for the slope.
  /// @throws InvalidInput  if a length is not that of nodes() or a value is not finite
  [[nodiscard]] Eigen::VectorXd interpolate(const Eigen::VectorXd& value, const Eigen::VectorXd& slope) const;

 private:
  BeamOptions options_;
  std::vector<detail::BeamElement> elements_;
  double length_ = 0.0;
  std::vector<double> nodes_;
  Structure structure_;
};

}  // namespace slipmode::fem
