#include "fem/shift_invert.hpp"

#include "core/errors.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::fem::detail {

namespace {

// Relative to max K_ii/M_ii, which is about the highest eigenvalue.
constexpr double kRelativeShift = 1e-8;

double choose_shift(const SparseMatrix& M, const SparseMatrix& K) {
  const Eigen::VectorXd mass = M.diagonal();
  const Eigen::VectorXd stiffness = K.diagonal();
  const double scale = (stiffness.array() / mass.array()).maxCoeff();
  return scale > 0.0 ? -kRelativeShift * scale : -1.0;
}

}  // namespace

ShiftInvert::ShiftInvert(const Structure& structure, const Eigen::MatrixXd& constraints)
    : mass_(to_sparse(structure.M())), constraints_(constraints) {
  const SparseMatrix stiffness = to_sparse(structure.K());
  shift_ = choose_shift(mass_, stiffness);
  factor_.compute(SparseMatrix(stiffness - shift_ * mass_));
  if (factor_.info() != Eigen::Success) {
    throw NumericalFailure(fmt::format("natural modes: K + {:.3g} M is not positive definite; expected K to be "
                                       "positive semi-definite",
                                       -shift_),
                           std::nan(""), {}, std::nan(""));
  }
  if (constraints_.cols() == 0) return;
  compliance_ = factor_.solve(constraints_);
  reaction_.compute(constraints_.transpose() * compliance_);
}

void ShiftInvert::perform_op(const double* x_in, double* y_out) const {
  Eigen::Map<Eigen::VectorXd>(y_out, rows()) = solve(Eigen::Map<const Eigen::VectorXd>(x_in, rows()));
}

Eigen::MatrixXd ShiftInvert::solve(const Eigen::MatrixXd& x) const {
  Eigen::MatrixXd y = factor_.solve(x);
  if (constraints_.cols() > 0) y -= compliance_ * reaction_.solve(constraints_.transpose() * y);
  return y;
}

}  // namespace slipmode::fem::detail
