#pragma once

#include <slipmode/fem/structure.hpp>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

namespace slipmode::fem::detail {

/// Contacts that hold a structure: column w of `directions` keeps wᵀq = 0 (compliance 0), or pulls back with the force
/// wᵀq / compliance (a spring to the ground).
struct Holds {
  Eigen::MatrixXd directions;  ///< W, n x m; rigid ones independent; m = 0 for none
  Eigen::VectorXd compliance;  ///< D [m], ≥ 0, m/N
};

[[nodiscard]] inline Holds no_holds(Eigen::Index n) { return {Eigen::MatrixXd(n, 0), Eigen::VectorXd(0)}; }

/// x ↦ y with (K − σM) y + W μ = x, Wᵀy = D μ: the inverse that shift-invert Lanczos needs, for rigid holds on the
/// subspace Wᵀy = 0. Springs of any stiffness cost no digits: K + W D⁻¹ Wᵀ is never formed.
///
/// σ is negative, so K − σM is positive definite even when K has rigid-body modes, and a Cholesky factor serves. It is
/// small against the highest eigenvalue, so that the low modes stand apart, and large against rounding. Where the
/// lowest eigenvalue is smaller still and not zero to rounding (a beam of many elements), σ is moved to about minus
/// that. The interface is the one Spectra asks of an operator.
class ShiftInvert {
 public:
  using Scalar = double;

  /// @throws NumericalFailure  if K − σM is not positive definite to rounding
  ShiftInvert(const Structure& structure, const Holds& holds);

  [[nodiscard]] Eigen::Index rows() const { return mass_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return mass_.cols(); }
  [[nodiscard]] double shift() const { return shift_; }
  [[nodiscard]] const SparseMatrix& mass() const { return mass_; }

  /// Spectra sets the shift before it starts; it was already chosen here and factored.
  void set_shift(double) {}
  void perform_op(const double* x_in, double* y_out) const;

  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& x) const;

 private:
  bool factor(const SparseMatrix& stiffness, double shift);
  void approach_lowest(const SparseMatrix& stiffness);

  SparseMatrix mass_;
  double shift_;
  Eigen::SimplicialLLT<SparseMatrix> factor_;
  Eigen::MatrixXd directions_;            // W
  Eigen::MatrixXd flexibility_;           // (K − σM)⁻¹ W
  Eigen::LLT<Eigen::MatrixXd> reaction_;  // of D + Wᵀ (K − σM)⁻¹ W
};

}  // namespace slipmode::fem::detail
