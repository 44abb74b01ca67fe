#include "pod/internal/mass_metric.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

namespace slipmode::pod {

MassMetric::MassMetric(const fem::Matrix& M, Eigen::Index n, std::string_view where) {
  const Eigen::Index size = std::visit([](const auto& matrix) -> Eigen::Index { return matrix.rows(); }, M);
  if (size != n) {
    throw InvalidInput(fmt::format("{}: the mass matrix is {} x {}; expected {} x {}", where, size, size, n, n));
  }
  Eigen::ComputationInfo info;
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&M)) {
    info = factor_.emplace<Dense>(*dense).info();
  } else {
    info = factor_.emplace<Sparse>(std::get<fem::SparseMatrix>(M)).info();
  }
  if (info != Eigen::Success) throw InvalidInput(fmt::format("{}: the mass matrix is not positive definite", where));
}

Eigen::MatrixXd MassMetric::whiten(const Eigen::MatrixXd& x) const {
  if (const auto* dense = std::get_if<Dense>(&factor_)) return dense->matrixU() * x;
  const auto& sparse = std::get<Sparse>(factor_);
  return sparse.matrixU() * (sparse.permutationP() * x).eval();
}

Eigen::MatrixXd MassMetric::unwhiten(const Eigen::MatrixXd& y) const {
  if (const auto* dense = std::get_if<Dense>(&factor_)) return dense->matrixU().solve(y);
  const auto& sparse = std::get<Sparse>(factor_);
  return sparse.permutationPinv() * sparse.matrixU().solve(y).eval();
}

}  // namespace slipmode::pod
