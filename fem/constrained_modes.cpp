#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/signs.hpp>
#include <slipmode/fem/modes.hpp>
#include "fem/internal/eigensolvers.hpp"
#include "fem/internal/mode_conventions.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <optional>
#include <vector>

namespace slipmode::fem {

namespace {

constexpr double kRankTolerance = 1e-10;  // on columns of unit length

Eigen::MatrixXd checked_unit_columns(const Eigen::MatrixXd& W, Eigen::Index n) {
  if (W.rows() != n) {
    throw InvalidInput(
        fmt::format("constrained modes: constraints have {} rows, expected {} like the structure", W.rows(), n));
  }
  if (W.cols() >= n) {
    throw InvalidInput(
        fmt::format("constrained modes: {} constraints leave nothing of {} degrees of freedom", W.cols(), n));
  }
  if (!W.allFinite()) throw InvalidInput("constrained modes: a constraint holds a value that is not finite");
  Eigen::MatrixXd unit = W.colwise().normalized();  // a zero column stays zero and fails the rank test
  if (unit.cols() > 0) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(unit);
    qr.setThreshold(kRankTolerance);
    if (qr.rank() < unit.cols()) {
      throw InvalidInput(
          fmt::format("constrained modes: {} constraints are linearly dependent (rank {}); remove the "
                      "redundant ones",
                      unit.cols(), qr.rank()));
    }
  }
  return unit;
}

// The dofs that stay free when every constraint holds one single dof; nothing otherwise.
std::optional<std::vector<int>> dofs_left_free(const Eigen::MatrixXd& W) {
  std::vector<bool> held(static_cast<std::size_t>(W.rows()), false);
  for (const auto column : W.colwise()) {
    if ((column.array() != 0.0).count() != 1) return std::nullopt;
    Eigen::Index dof = 0;
    column.cwiseAbs().maxCoeff(&dof);
    held[static_cast<std::size_t>(dof)] = true;
  }
  std::vector<int> free;
  for (int i = 0; i < W.rows(); ++i) {
    if (!held[static_cast<std::size_t>(i)]) free.push_back(i);
  }
  return free;
}

Matrix take(const Matrix& A, const std::vector<int>& dofs) {
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&A)) return Eigen::MatrixXd((*dense)(dofs, dofs));
  const SparseMatrix& sparse = std::get<SparseMatrix>(A);
  std::vector<int> place(static_cast<std::size_t>(sparse.rows()), -1);
  for (std::size_t i = 0; i < dofs.size(); ++i) place[static_cast<std::size_t>(dofs[i])] = static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> kept;
  for (Eigen::Index outer = 0; outer < sparse.outerSize(); ++outer) {
    for (SparseMatrix::InnerIterator it(sparse, outer); it; ++it) {
      const int row = place[static_cast<std::size_t>(it.row())];
      const int col = place[static_cast<std::size_t>(it.col())];
      if (row >= 0 && col >= 0) kept.emplace_back(row, col, it.value());
    }
  }
  SparseMatrix result(static_cast<int>(dofs.size()), static_cast<int>(dofs.size()));
  result.setFromTriplets(kept.begin(), kept.end());
  return result;
}

// Z = columns of the identity: the rest of the structure keeps its sparsity, and a chain stays a chain.
Modes modes_of_free_dofs(const Structure& structure, const std::vector<int>& dofs, Eigen::Index count) {
  const Structure rest(take(structure.M(), dofs), Rayleigh{}, take(structure.K(), dofs), {}, structure.units());
  Modes modes = natural_modes(rest, count);
  Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(structure.size(), count);
  shapes(dofs, Eigen::all) = modes.shapes;
  modes.shapes = std::move(shapes);
  return modes;
}

// ZᵀAZ without forming Z: both sides are turned by the Householder reflections, then the constrained part is cut off.
Eigen::MatrixXd project(const Matrix& A, const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::Index constrained) {
  Eigen::MatrixXd turned = to_dense(A);
  turned.applyOnTheLeft(qr.householderQ().adjoint());
  turned.applyOnTheRight(qr.householderQ());
  const Eigen::Index free = turned.rows() - constrained;
  const Eigen::MatrixXd corner = turned.bottomRightCorner(free, free);
  return 0.5 * (corner + corner.transpose());
}

Modes modes_by_projection(const Structure& structure, const Eigen::MatrixXd& W, Eigen::Index count) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(W);
  const Structure rest(project(structure.M(), qr, W.cols()), Rayleigh{}, project(structure.K(), qr, W.cols()), {},
                       structure.units());
  Modes modes = natural_modes(rest, count, EigenMethod::kDense);
  Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(structure.size(), count);
  shapes.bottomRows(rest.size()) = modes.shapes;
  shapes.applyOnTheLeft(qr.householderQ());
  fix_signs(shapes);
  modes.shapes = std::move(shapes);
  return modes;
}

}  // namespace

Modes constrained_modes(const Structure& structure, const Eigen::MatrixXd& constraints, Eigen::Index count) {
  const Eigen::MatrixXd W = checked_unit_columns(constraints, structure.size());
  const Eigen::Index free = structure.size() - W.cols();
  if (count < 0 || count > free) {
    throw InvalidInput(fmt::format("constrained modes: {} modes asked; expected 0 (all) to {}", count, free));
  }
  const Eigen::Index wanted = count == 0 ? free : count;
  if (const auto dofs = dofs_left_free(W)) return modes_of_free_dofs(structure, *dofs, wanted);
  if (free < detail::kDenseLimit || 5 * wanted >= free) return modes_by_projection(structure, W, wanted);
  const detail::Holds rigid{W, Eigen::VectorXd::Zero(W.cols())};
  return detail::conventional_modes(structure, detail::solve_spectra(structure, rigid, wanted));
}

}  // namespace slipmode::fem
