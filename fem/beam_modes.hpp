#pragma once

#include <slipmode/fem/beam.hpp>
#include <slipmode/fem/modes.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::fem {

/// Mode shapes of a beam as functions of x, mass-normalised like Modes.
struct BeamShapes {
  Eigen::VectorXd frequency_hz;  ///< k
  Eigen::VectorXd x;             ///< p [m]
  Eigen::MatrixXd displacement;  ///< p x k
  Eigen::MatrixXd slope;         ///< y′, p x k
  Eigen::MatrixXd curvature;     ///< θ′, p x k
};

/// Evaluates modes at positions, in the element's shape functions. `modes` are those of beam.structure(): of the
/// slipping tip (natural_modes) or the stuck one (constrained_modes, compliant_modes).
/// @param x  0 ≤ x ≤ beam.reach(), any order [m]
/// @throws InvalidInput  if a position is off the beam or the modes have another number of degrees of freedom
[[nodiscard]] BeamShapes beam_shapes(const Beam& beam, const Modes& modes, const Eigen::VectorXd& x);

/// What shear and rotary inertia change in one natural mode. Frequencies on the same elements, so that errors of the
/// mesh cancel in the changes. The tip body's own inertia counts in all four.
struct TheoryEffect {
  double euler_bernoulli_hz = 0.0;  ///< neither
  double shear_hz = 0.0;            ///< shear only
  double rotary_hz = 0.0;           ///< rotary inertia only (Rayleigh's beam)
  double timoshenko_hz = 0.0;       ///< both
  // Changes relative to euler_bernoulli_hz, negative: both effects lower frequencies.
  double shear_change = 0.0;
  double rotary_change = 0.0;
  double timoshenko_change = 0.0;
};

/// The effects on modes 1 to `count` of the undamped beam with a slipping tip; `options.theory` does not matter.
/// @throws InvalidInput  if the options are no beam's, or count is not 1 to 2·(number of elements)
[[nodiscard]] std::vector<TheoryEffect> theory_effects(const BeamOptions& options, Eigen::Index count);

}  // namespace slipmode::fem
