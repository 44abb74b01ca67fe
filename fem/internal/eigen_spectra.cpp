#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include "fem/internal/eigensolvers.hpp"
#include "fem/internal/shift_invert.hpp"

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::fem::detail {

namespace {

constexpr double kTolerance = 1e-12;

// One step of inverse iteration, then the best pairs within its range. A rigid-body mode's eigenvalue dominates the
// inverse, so Lanczos finds the others with an error relative to that one; this step makes it relative to their own.
EigenPairs polish(const Structure& structure, const Holds& holds, const ShiftInvert& inverse,
                  const Eigen::MatrixXd& vectors) {
  Eigen::MatrixXd basis = inverse.solve(inverse.mass() * vectors);
  basis.colwise().normalize();
  Eigen::MatrixXd stiffness = basis.transpose() * multiply(structure.K(), basis);
  const Eigen::MatrixXd stretch = holds.directions.transpose() * basis;
  for (Eigen::Index c = 0; c < stretch.rows(); ++c) {
    if (holds.compliance(c) > 0.0) stiffness += stretch.row(c).transpose() * stretch.row(c) / holds.compliance(c);
  }
  const Eigen::MatrixXd mass = basis.transpose() * (inverse.mass() * basis);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  return {solver.eigenvalues(), basis * solver.eigenvectors()};
}

}  // namespace

EigenPairs solve_spectra(const Structure& structure, const Holds& holds, Eigen::Index count) {
  ShiftInvert inverse(structure, holds);
  Spectra::SparseSymMatProd<double> mass(inverse.mass());
  const Eigen::Index free_dofs = structure.size() - (holds.compliance.array() == 0.0).count();
  const Eigen::Index subspace = std::min(free_dofs, 2 * count + 20);
  Spectra::SymGEigsShiftSolver<ShiftInvert, Spectra::SparseSymMatProd<double>, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, count, subspace, inverse.shift());
  solver.init();
  const Eigen::Index converged =
      solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, kTolerance, Spectra::SortRule::SmallestAlge);
  if (solver.info() != Spectra::CompInfo::Successful) {
    throw NumericalFailure(fmt::format("natural modes: shift-invert Lanczos converged for {} of {} modes after {} "
                                       "restarts; ask for fewer or use the dense method",
                                       converged, count, solver.num_iterations()),
                           std::nan(""), {}, std::nan(""));
  }
  return polish(structure, holds, inverse, solver.eigenvectors());
}

}  // namespace slipmode::fem::detail
