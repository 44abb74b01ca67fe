#include "fem/internal/shift_invert.hpp"

#include <slipmode/core/errors.hpp>
#include "fem/internal/mode_conventions.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::fem::detail {

namespace {

// Relative to max K_ii/M_ii, which is about the highest eigenvalue.
constexpr double kRelativeShift = 1e-8;
constexpr int kMaxShifts = 8;
constexpr int kInverseSteps = 4;
constexpr double kCloseEnough = 0.1;  // lowest eigenvalue to −shift

double choose_shift(const SparseMatrix& M, const SparseMatrix& K) {
  const Eigen::VectorXd mass = M.diagonal();
  const Eigen::VectorXd stiffness = K.diagonal();
  const double scale = (stiffness.array() / mass.array()).maxCoeff();
  return scale > 0.0 ? -kRelativeShift * scale : -1.0;
}

}  // namespace

ShiftInvert::ShiftInvert(const Structure& structure, const Holds& holds)
    : mass_(to_sparse(structure.M())), directions_(holds.directions) {
  const SparseMatrix stiffness = to_sparse(structure.K());
  shift_ = choose_shift(mass_, stiffness);
  if (!factor(stiffness, shift_)) {
    throw NumericalFailure(fmt::format("natural modes: K + {:.3g} M is not positive definite; expected K to be "
                                       "positive semi-definite",
                                       -shift_),
                           std::nan(""), {}, std::nan(""));
  }
  approach_lowest(stiffness);
  if (directions_.cols() == 0) return;
  flexibility_ = factor_.solve(directions_);
  Eigen::MatrixXd reaction = directions_.transpose() * flexibility_;
  reaction.diagonal() += holds.compliance;
  reaction_.compute(reaction);
}

bool ShiftInvert::factor(const SparseMatrix& stiffness, double shift) {
  factor_.compute(SparseMatrix(stiffness - shift * mass_));
  return factor_.info() == Eigen::Success;
}

void ShiftInvert::approach_lowest(const SparseMatrix& stiffness) {
  Eigen::VectorXd shape = Eigen::VectorXd::Ones(rows());
  for (int round = 0; round < kMaxShifts; ++round) {
    for (int step = 0; step < kInverseSteps; ++step) shape = factor_.solve(mass_ * shape).eval().normalized();
    const double energy = shape.dot(stiffness * shape);
    const double lowest = energy / shape.dot(mass_ * shape);  // never below the true one
    if (energy <= rounding_of_quotient(stiffness, shape) || lowest > -kCloseEnough * shift_) return;
    if (!factor(stiffness, -lowest)) {
      factor(stiffness, shift_);
      return;
    }
    shift_ = -lowest;
  }
}

void ShiftInvert::perform_op(const double* x_in, double* y_out) const {
  Eigen::Map<Eigen::VectorXd>(y_out, rows()) = solve(Eigen::Map<const Eigen::VectorXd>(x_in, rows()));
}

Eigen::MatrixXd ShiftInvert::solve(const Eigen::MatrixXd& x) const {
  Eigen::MatrixXd y = factor_.solve(x);
  if (directions_.cols() > 0) y -= flexibility_ * reaction_.solve(directions_.transpose() * y);
  return y;
}

}  // namespace slipmode::fem::detail
