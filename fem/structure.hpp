#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace slipmode::fem {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// A square matrix, stored as it came: sparse for assembled structures, dense for projected ones.
using Matrix = std::variant<SparseMatrix, Eigen::MatrixXd>;

/// C = mass·M + stiffness·K (Rayleigh damping). `mass` in 1/s, `stiffness` in s.
struct Rayleigh {
  double mass = 0.0;
  double stiffness = 0.0;
};

/// A linear structure M q̈ + C q̇ + K q = f, the part that full and reduced models share.
///
/// M is symmetric positive definite, K symmetric positive semi-definite: a structure may float [n x n]. C may have a
/// skew part, as gyroscopic forces and damping printed for relative coordinates have (S1 (6)): it does no work, so only
/// the symmetric part ½(C + Cᵀ), positive semi-definite, dissipates. Immutable after construction. Source: S4 (3.1).
class Structure {
 public:
  /// @param M, K       n x n, symmetric to rounding
  /// @param C          n x n
  /// @param dof_names  n names, or empty: then "q1".."qn"
  /// @param units      "dimensionless" or "SI"
  /// @throws InvalidInput  if n = 0, sizes differ, a value is not finite, M or K is not symmetric, M is not
  ///                       positive definite, a C that is not symmetric has a symmetric part that is indefinite, or the
  ///                       units are unknown
  Structure(Matrix M, Matrix C, Matrix K, std::vector<std::string> dof_names = {}, std::string units = "dimensionless");

  /// Same, with C = r.mass·M + r.stiffness·K; the structure then knows its damping to be proportional.
  Structure(Matrix M, Rayleigh r, Matrix K, std::vector<std::string> dof_names = {},
            std::string units = "dimensionless");

  [[nodiscard]] Eigen::Index size() const;
  [[nodiscard]] const Matrix& M() const;
  [[nodiscard]] const Matrix& C() const;
  [[nodiscard]] const Matrix& K() const;
  [[nodiscard]] const std::vector<std::string>& dof_names() const;
  [[nodiscard]] const std::string& units() const;

  /// The Rayleigh coefficients, when the structure was built from them or C was found to fit them to rounding.
  [[nodiscard]] std::optional<Rayleigh> rayleigh() const;

  /// True when C equals its transpose to rounding.
  [[nodiscard]] bool has_symmetric_damping() const;

  /// True when M is diagonal and K is tridiagonal (a chain): modes then cost O(n²) or less.
  [[nodiscard]] bool is_chain_like() const;

  /// ½ vᵀMv + ½ qᵀKq [J]. Source: S4 (3.35) written for any structure.
  [[nodiscard]] double energy(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;

  /// vᵀCv, the power that damping takes from the structure, ≥ 0 [W].
  [[nodiscard]] double dissipation(const Eigen::VectorXd& v) const;

 private:
  Matrix M_, C_, K_;
  std::vector<std::string> dof_names_;
  std::string units_;
  std::optional<Rayleigh> rayleigh_;
  bool chain_like_ = false;
  bool symmetric_damping_ = true;
};

/// y = A x for either storage.
[[nodiscard]] Eigen::MatrixXd multiply(const Matrix& A, const Eigen::MatrixXd& x);
/// A as a dense matrix (a copy).
[[nodiscard]] Eigen::MatrixXd to_dense(const Matrix& A);
/// A as a sparse matrix (a copy).
[[nodiscard]] SparseMatrix to_sparse(const Matrix& A);

}  // namespace slipmode::fem
