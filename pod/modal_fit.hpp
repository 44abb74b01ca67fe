#pragma once

#include <slipmode/pod/ensemble.hpp>
#include <slipmode/pod/sensors.hpp>

#include <string>

namespace slipmode::pod {

/// Functions of x along a beam, each given by the beam's degrees of freedom.
struct ModalFunctions {
  Eigen::MatrixXd shapes;  ///< n x k
  std::string name;        ///< "natural modes", …
};

/// The lowest `count` natural modes of the beam with its tip body, mass-normalised.
/// @throws InvalidInput  for count < 1 or more than the beam's degrees of freedom
[[nodiscard]] ModalFunctions natural_functions(const fem::Beam& beam, Eigen::Index count);

/// (x/L)², (x/L)³, …, `count` of them, so that y(0) = y′(0) = 0 holds term by term. (S4 (4.6) starts with x¹, which
/// leaves the clamp free to turn.) Cubic elements hold the first two exactly, the others at the nodes.
/// @throws InvalidInput  for count < 1 or more than the beam's degrees of freedom
[[nodiscard]] ModalFunctions polynomial_functions(const fem::Beam& beam, Eigen::Index count);

/// Finds a motion y(x) = Σ a_i φ_i(x) from sensor readings: F a ≈ s with F = S Φ [ns x k].
///
/// k = ns interpolates (S4 (4.5), (4.9)), k < ns is the least-squares fit. Columns of F are scaled to unit length, and
/// with sensors of both kinds the rows of each kind by their largest element, which makes the fit free of units; it is
/// solved by the singular value decomposition. Motion outside the span is aliased into it: a motion φ_m, m > k, reads
/// as the amplitudes F⁺ S φ_m.
class ModalFit {
 public:
  /// @throws InvalidInput  for functions of another beam, more of them than sensors ("more modal functions than sensors
  ///                       can tell apart"), or a singular fit (condition number above 1e10)
  ModalFit(const SensorArray& sensors, ModalFunctions functions);

  [[nodiscard]] const ModalFunctions& functions() const { return functions_; }
  /// Largest to smallest singular value of the scaled F: how many times noise on the readings is magnified, at worst.
  [[nodiscard]] double condition() const { return condition_; }
  /// a for every column of readings [k x T]. @throws InvalidInput  for another number of rows than sensors
  [[nodiscard]] Eigen::MatrixXd amplitudes(const Eigen::MatrixXd& readings) const;
  /// The motion in the beam's degrees of freedom, Φ a [n x T]. @throws InvalidInput  as amplitudes()
  [[nodiscard]] Eigen::MatrixXd motion(const Eigen::MatrixXd& readings) const;
  /// What sensors `at` would read of the fitted motion, as a matrix on the readings, S_at Φ F⁺ [ns_at x ns]. With
  /// strain gauges here and displacement sensors there this is the matrix of S4 (4.5).
  [[nodiscard]] Eigen::MatrixXd transfer(const SensorArray& at) const;

 private:
  ModalFunctions functions_;
  Eigen::MatrixXd inverse_;  // F⁺, k x ns
  double condition_ = 0.0;
};

/// An ensemble of readings turned into what sensors `at` would read: strains to displacements, at the gauges' places or
/// at any number of pseudo-sensors. The rank of the result is at most the number of modal functions of the fit.
/// @throws InvalidInput  for another number of rows than sensors
[[nodiscard]] Ensemble converted(const Ensemble& readings, const ModalFit& fit, const SensorArray& at);

}  // namespace slipmode::pod
