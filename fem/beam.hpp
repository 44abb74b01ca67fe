#pragma once

#include "fem/structure.hpp"

#include <Eigen/Core>
#include <variant>
#include <vector>

namespace slipmode::fem {

enum class BeamTheory {
  kEulerBernoulli,  ///< Hermite elements: no shear, no rotary inertia
  kTimoshenko,      ///< elements exact in shear for end loads (no locking), with rotary inertia
};

/// A stretch of beam with one rectangular section and one material. SI units.
struct BeamSpan {
  double length = 0.0;          ///< > 0 [m]
  double width = 0.0;           ///< > 0 [m]
  double thickness = 0.0;       ///< in the direction of motion, > 0 [m]
  double youngs_modulus = 0.0;  ///< > 0 [Pa]
  double density = 0.0;         ///< > 0 [kg/m³]
  int elements = 10;            ///< ≥ 1
  /// Timoshenko only: G = E / (2 (1 + ν)), −1 < ν ≤ 0.5.
  double poisson_ratio = 0.3;
  /// Timoshenko only: κ in κ G A, > 0. Default: Cowper's for a rectangle at ν = 0.3, 10(1+ν)/(12+11ν).
  double shear_coefficient = 0.8497;
};

/// A rigid body on the free end.
struct TipBody {
  double mass = 0.0;       ///< ≥ 0 [kg]
  double inertia = 0.0;    ///< about its own centre of mass, ≥ 0 [kg m²]
  double offset = 0.0;     ///< of its centre of mass beyond the beam's end, along the beam [m]
  double extension = 0.0;  ///< rigid, from the beam's end to the contact, ≥ 0 [m]
};

/// A damping ratio wanted at a frequency.
struct RatioAt {
  double ratio = 0.0;         ///< ≥ 0
  double frequency_hz = 0.0;  ///< > 0
};

/// C = cK with the ratio met at one frequency, or C = aM + bK with ratios met at two.
struct ProportionalRatios {
  std::vector<RatioAt> at;  ///< one or two
};

/// Each natural mode of the beam with its tip body, no contact, has its own ratio: C = M Φ diag(2 ζ_i ω_i) Φᵀ M.
struct ModalRatios {
  std::vector<double> ratios;  ///< of modes 1, 2, …; the last one holds for all further modes; not empty, each ≥ 0
};

using BeamDamping = std::variant<Rayleigh, ProportionalRatios, ModalRatios>;

struct BeamOptions {
  BeamTheory theory = BeamTheory::kEulerBernoulli;
  std::vector<BeamSpan> spans;  ///< from the clamp to the free end, at least one
  TipBody tip;
  BeamDamping damping = Rayleigh{};
};

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

  /// Displacement at x [n]. @throws InvalidInput  unless 0 ≤ x ≤ reach()
  [[nodiscard]] Eigen::VectorXd displacement_row(double x) const;
  /// Slope y′ of the centre line at x (with Timoshenko elements it differs from the rotation θ) [n], 1/m.
  /// On the extension the rotation of its root.
  [[nodiscard]] Eigen::VectorXd slope_row(double x) const;
  /// Curvature θ′ at x [n], 1/m²; 0 on the extension. At a node between elements the mean of both sides.
  /// @throws InvalidInput  unless 0 ≤ x ≤ reach()
  [[nodiscard]] Eigen::VectorXd curvature_row(double x) const;
  /// Bending strain at the surface, ½ thickness · curvature, at 0 ≤ x ≤ L [n], 1/m. Source: S4 (4.2), with half the
  /// thickness (S4 prints half the width).
  [[nodiscard]] Eigen::VectorXd strain_row(double x) const;

  /// The degrees of freedom of a function given by its value and slope at every node, clamp left out [n].
  /// @param value, slope  y(x) and y′(x) at nodes() (all of them; those at the clamp are not used)
  [[nodiscard]] Eigen::VectorXd interpolate(const Eigen::VectorXd& value, const Eigen::VectorXd& slope) const;

 private:
  BeamOptions options_;
  double length_ = 0.0;
  std::vector<double> nodes_;
  Structure structure_;
};

}  // namespace slipmode::fem
