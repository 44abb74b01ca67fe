#include "core/errors.hpp"
#include "fem/eigensolvers.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace slipmode::fem::detail {

EigenPairs solve_dense(const Structure& structure) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(to_dense(structure.K()),
                                                                         to_dense(structure.M()));
  if (solver.info() != Eigen::Success) {
    throw NumericalFailure("natural modes: the dense eigensolver did not converge", std::nan(""), {}, std::nan(""));
  }
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace slipmode::fem::detail
