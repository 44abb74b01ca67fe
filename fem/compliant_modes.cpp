#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>
#include "fem/internal/eigensolvers.hpp"
#include "fem/internal/mode_conventions.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::fem {

namespace {

void check(const Structure& structure, const Eigen::MatrixXd& W, const Eigen::VectorXd& stiffnesses,
           Eigen::Index count) {
  const Eigen::Index n = structure.size();
  if (W.rows() != n) {
    throw InvalidInput(
        fmt::format("compliant modes: directions have {} rows, expected {} like the structure", W.rows(), n));
  }
  if (stiffnesses.size() != W.cols()) {
    throw InvalidInput(
        fmt::format("compliant modes: {} stiffnesses for {} directions; give one each", stiffnesses.size(), W.cols()));
  }
  if (!W.allFinite()) throw InvalidInput("compliant modes: a direction holds a value that is not finite");
  for (const double k : stiffnesses) {
    if (!(k > 0.0) || !std::isfinite(k)) {
      throw InvalidInput(fmt::format("compliant modes: contact stiffness = {}; expected a finite value > 0", k));
    }
  }
  if (count < 0 || count > n) {
    throw InvalidInput(fmt::format("compliant modes: {} modes asked; expected 0 (all) to {}", count, n));
  }
}

// K + W diag(k) Wᵀ, for the methods that need the sum and for judging what counts as zero.
Structure sprung(const Structure& structure, const Eigen::MatrixXd& springs) {
  const SparseMatrix S = springs.sparseView(0.0, 0.0);
  return {structure.M(),
          Rayleigh{},
          SparseMatrix(to_sparse(structure.K()) + SparseMatrix(S.transpose()) * S),
          {},
          structure.units()};
}

detail::EigenPairs solve(const Structure& structure, const Structure& sum, const Eigen::MatrixXd& W,
                         const Eigen::MatrixXd& springs, const Eigen::VectorXd& stiffnesses, Eigen::Index count) {
  const Eigen::Index n = structure.size();
  if (n >= detail::kDenseLimit && 5 * count < n) {
    return detail::solve_spectra(structure, {W, stiffnesses.cwiseInverse()}, count);
  }
  if (auto factored = detail::solve_by_factors(to_dense(structure.M()), to_dense(structure.K()), springs))
    return *std::move(factored);
  return detail::solve_dense(sum);  // a structure with rigid-body modes
}

}  // namespace

Modes compliant_modes(const Structure& structure, const Eigen::MatrixXd& directions, const Eigen::VectorXd& stiffnesses,
                      Eigen::Index count) {
  check(structure, directions, stiffnesses, count);
  const Eigen::Index wanted = count == 0 ? structure.size() : count;
  const Eigen::MatrixXd springs = stiffnesses.cwiseSqrt().asDiagonal() * directions.transpose();
  const Structure sum = sprung(structure, springs);
  const detail::EigenPairs pairs = solve(structure, sum, directions, springs, stiffnesses, wanted);
  return detail::conventional_modes(sum, {pairs.values.head(wanted), pairs.vectors.leftCols(wanted)});
}

}  // namespace slipmode::fem
