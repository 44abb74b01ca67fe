#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/dense_lapack.hpp>
#include <slipmode/core/errors.hpp>
#include "fem/internal/eigensolvers.hpp"

#include <cmath>
#include <utility>

namespace slipmode::fem::detail {

namespace {

// Of the lowest to the highest eigenvalue: below it the direct method leaves fewer than ten digits of the lowest.
constexpr double kWideSpectrum = 1e-6;

/// What M and K couple.
EigenPairs solve_coupled(const Eigen::MatrixXd& M, const Eigen::MatrixXd& K) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  if (solver.info() != Eigen::Success) {
    throw NumericalFailure("natural modes: the dense eigensolver did not converge", std::nan(""), {}, std::nan(""));
  }
  const Eigen::VectorXd& values = solver.eigenvalues();
  if (values(0) < kWideSpectrum * values(values.size() - 1)) {
    if (auto accurate = solve_by_factors(M, K, Eigen::MatrixXd(0, M.rows()))) return *std::move(accurate);
  }
  return {values, solver.eigenvectors()};
}

}  // namespace

std::optional<EigenPairs> solve_by_factors(const Eigen::MatrixXd& M, const Eigen::MatrixXd& K,
                                           const Eigen::MatrixXd& springs) {
  // With K = RᵀR and M = LLᵀ the frequencies are the singular values of [R; S] L⁻ᵀ.
  const Eigen::LLT<Eigen::MatrixXd> mass(M), stiffness(K);
  if (mass.info() != Eigen::Success || stiffness.info() != Eigen::Success) return std::nullopt;
  const Eigen::Index n = M.rows();
  Eigen::MatrixXd root(springs.rows() + n, n);
  root << springs, Eigen::MatrixXd(stiffness.matrixU());
  mass.matrixU().solveInPlace<Eigen::OnTheRight>(root);
  const SingularValues found = singular_values(std::move(root));
  const Eigen::MatrixXd shapes = mass.matrixU().solve(found.V.rowwise().reverse());
  return EigenPairs{found.sigma.reverse().cwiseAbs2(), shapes};
}

EigenPairs solve_dense(const Structure& structure) {
  const Eigen::MatrixXd M = to_dense(structure.M()), K = to_dense(structure.K());
  return spectrum_by_parts(coupled_parts(M.cwiseAbs() + K.cwiseAbs()),
                           [&](const Part& part) { return solve_coupled(M(part, part), K(part, part)); });
}

}  // namespace slipmode::fem::detail
