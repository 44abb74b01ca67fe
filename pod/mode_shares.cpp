#include <slipmode/pod/mode_shares.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

namespace slipmode::pod {

Eigen::MatrixXd mode_shares(const Basis& basis, const fem::Modes& modes, const fem::Matrix& M) {
  const Eigen::Index n = std::visit([](const auto& matrix) -> Eigen::Index { return matrix.rows(); }, M);
  if (basis.vectors.rows() != n || modes.shapes.rows() != n) {
    throw InvalidInput(fmt::format("mode shares: basis has {} rows, modes {}; expected {} like the mass matrix",
                                   basis.vectors.rows(), modes.shapes.rows(), n));
  }
  const Eigen::MatrixXd weighted = fem::multiply(M, basis.vectors);
  const Eigen::VectorXd squares = basis.vectors.cwiseProduct(weighted).colwise().sum();
  for (Eigen::Index i = 0; i < squares.size(); ++i) {
    if (!(squares[i] > 0.0)) {
      throw InvalidInput(fmt::format("mode shares: basis vector {} (from 1) is zero or not finite", i + 1));
    }
  }
  return squares.cwiseInverse().asDiagonal() * (weighted.transpose() * modes.shapes).cwiseAbs2();
}

}  // namespace slipmode::pod
