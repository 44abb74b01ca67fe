#pragma once

#include <slipmode/pod/modal_fit.hpp>
#include <slipmode/pod/pod.hpp>

namespace slipmode::pod {

enum class FitFamily {
  kNaturalModes,  ///< natural_functions(): S4's choice
  kPolynomials,   ///< polynomial_functions()
};

struct PomfOptions {
  FitFamily family = FitFamily::kNaturalModes;
  Eigen::Index functions = 0;  ///< modal functions that carry each POM, at most one per sensor; 0: one per sensor
  PodOptions pod = {};         ///< of the sensor displacements: how many POMs, mean removed or not
};

/// Proper orthogonal modal functions and what they were made from.
struct PomfResult {
  /// POMFs in the beam's degrees of freedom: ΦᵀMΦ = I, M of the beam with its tip body; the mean is the fit of the mean
  /// reading; energy[i] is the share of POM i. Ready for rom::reduce.
  Basis basis;
  PodResult discrete;          ///< POMs at the sensors [ns x L], with their own energies
  Eigen::MatrixXd continuous;  ///< the fits of the POMs before Gram-Schmidt [n x L]
  /// Share of POMF i in the fitted ensemble's mass-metric mean square; the sum is 1 when as many are kept as the fitted
  /// ensemble has rank. (S4 section 5.4 leaves open how POMFs get an energy of their own; this is it.)
  Eigen::VectorXd mass_shares;
  double condition = 0.0;  ///< of the fit
  double misfit = 0.0;  ///< largest |S ψ_i − p_i| of a kept POM p_i, |p_i| = 1; 0 when there are as many functions as
                        ///< sensors
};

/// Proper orthogonal modal functions: POMs of sensor displacements, each made continuous by a fit of modal functions,
/// then orthonormalised in their order in the inner product ∫ρA φ_i φ_j dx + tip body = φ_iᵀMφ_j. A POMF has the sign
/// of its POM: the largest sensor displacement is positive.
///
///     const SensorArray gauges(beam, sensors_at(SensorKind::kStrain, x));
///     const ModalFit strains(gauges, natural_functions(beam, 6));
///     const SensorArray places(beam, sensors_at(SensorKind::kDisplacement, x));
///     const Ensemble y = converted({gauges.readings(run.q)}, strains, places);
///     const PomfResult found = pomfs(beam, places, y, {.functions = 6, .pod = {.choice = {.modes = 3}}});
///
/// @param sensors        displacement sensors only
/// @param displacements  their readings, ns x T [m]
/// @throws InvalidInput      for strain gauges among the sensors, another number of rows than sensors, more POMs than
///                           modal functions to carry them, and as pod(), ModalFit and mass_orthonormalise()
/// @throws NumericalFailure  as pod() and mass_orthonormalise()
/// Source: S4 section 4.4.2, 5.4 and (6.28).
[[nodiscard]] PomfResult pomfs(const fem::Beam& beam, const SensorArray& sensors, const Ensemble& displacements,
                               const PomfOptions& options = {});

}  // namespace slipmode::pod
