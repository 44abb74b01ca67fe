#pragma once

#include "fem/structure.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

namespace slipmode::fem::detail {

/// x ↦ y with (K − σM) y + W μ = x, Wᵀy = 0: the inverse that shift-invert Lanczos needs, on the subspace Wᵀy = 0.
///
/// σ is negative, so K − σM is positive definite even when K has rigid-body modes, and a Cholesky factor serves. It is
/// small against the highest eigenvalue, so that the low modes stand apart, and large against rounding.
/// The interface is the one Spectra asks of an operator.
class ShiftInvert {
 public:
  using Scalar = double;

  /// @param constraints  W, n x m, independent columns; m = 0 for none
  /// @throws NumericalFailure  if K − σM is not positive definite to rounding
  ShiftInvert(const Structure& structure, const Eigen::MatrixXd& constraints);

  [[nodiscard]] Eigen::Index rows() const { return mass_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return mass_.cols(); }
  [[nodiscard]] double shift() const { return shift_; }
  [[nodiscard]] const SparseMatrix& mass() const { return mass_; }

  /// Spectra sets the shift before it starts; it was already chosen here and factored.
  void set_shift(double) {}
  void perform_op(const double* x_in, double* y_out) const;

  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& x) const;

 private:
  SparseMatrix mass_;
  double shift_;
  Eigen::SimplicialLLT<SparseMatrix> factor_;
  Eigen::MatrixXd constraints_;           // W
  Eigen::MatrixXd compliance_;            // (K − σM)⁻¹ W
  Eigen::LLT<Eigen::MatrixXd> reaction_;  // of Wᵀ (K − σM)⁻¹ W
};

}  // namespace slipmode::fem::detail
