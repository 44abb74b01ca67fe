#pragma once

#include <slipmode/fem/structure.hpp>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <string_view>
#include <variant>

namespace slipmode::pod {

/// Coordinates in which the inner product xᵀMy is the plain one: x̃ = Lᵀx with M = L Lᵀ (for sparse M a permutation that
/// keeps L sparse is part of L).
class MassMetric {
 public:
  /// @param M      symmetric positive definite
  /// @param n      expected size
  /// @param where  the operation, for messages
  /// @throws InvalidInput  for another size or M not positive definite
  MassMetric(const fem::Matrix& M, Eigen::Index n, std::string_view where);

  /// Lᵀ x, column by column [n x k].
  [[nodiscard]] Eigen::MatrixXd whiten(const Eigen::MatrixXd& x) const;
  /// L⁻ᵀ y: the inverse of whiten().
  [[nodiscard]] Eigen::MatrixXd unwhiten(const Eigen::MatrixXd& y) const;

 private:
  using Dense = Eigen::LLT<Eigen::MatrixXd>;
  using Sparse = Eigen::SimplicialLLT<fem::SparseMatrix>;
  std::variant<Dense, Sparse> factor_;
};

}  // namespace slipmode::pod
