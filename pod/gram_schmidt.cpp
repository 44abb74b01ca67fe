#include <slipmode/pod/gram_schmidt.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::pod {

void check_mass_orthonormal(const Eigen::MatrixXd& vectors, const fem::Matrix& M, std::string_view where) {
  constexpr double kTolerance = 1e-10;
  const Eigen::Index L = vectors.cols();
  const Eigen::MatrixXd gram = vectors.transpose() * fem::multiply(M, vectors);
  const double error = (gram - Eigen::MatrixXd::Identity(L, L)).cwiseAbs().maxCoeff();
  if (!(error <= kTolerance)) {
    throw NumericalFailure(
        fmt::format("{}: vectors are mass-orthonormal to {:.3g} only; expected {:.0e}. Keep fewer vectors, or write "
                    "degrees of freedom in units that bring masses closer together",
                    where, error, kTolerance),
        std::numeric_limits<double>::quiet_NaN(), {}, error);
  }
}

MassOrthonormal mass_orthonormalise(const Eigen::MatrixXd& V, const fem::Matrix& M, std::string_view where) {
  constexpr double kIndependent = 1e-10;
  const Eigen::Index n = std::visit([](const auto& matrix) -> Eigen::Index { return matrix.rows(); }, M);
  const Eigen::Index L = V.cols();
  if (V.rows() != n || L < 1 || L > n || !V.allFinite()) {
    throw InvalidInput(
        fmt::format("{}: {} x {} vectors; expected {} rows, one per degree of freedom, and 1 to {} columns of finite "
                    "values",
                    where, V.rows(), L, n, n));
  }
  MassOrthonormal result{Eigen::MatrixXd(n, L), Eigen::MatrixXd::Zero(L, L)};
  Eigen::MatrixXd weighted(n, L);  // M Φ
  for (Eigen::Index j = 0; j < L; ++j) {
    Eigen::VectorXd v = V.col(j);
    const double before = std::sqrt(v.dot(fem::multiply(M, v).col(0)));
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index i = 0; i < j; ++i) {
        const double along = weighted.col(i).dot(v);
        v -= along * result.vectors.col(i);
        result.triangle(i, j) += along;
      }
    }
    const double left = std::sqrt(std::max(0.0, v.dot(fem::multiply(M, v).col(0))));
    if (!(left > kIndependent * before)) {
      throw InvalidInput(
          fmt::format("{}: vector {} (from 1) depends on those before it: {:.3g} of its length is left outside their "
                      "span, more than {:.0e} needed. Keep fewer vectors",
                      where, j + 1, before > 0.0 ? left / before : 0.0, kIndependent));
    }
    result.triangle(j, j) = left;
    result.vectors.col(j) = v / left;
    weighted.col(j) = fem::multiply(M, result.vectors.col(j)).col(0);
  }
  check_mass_orthonormal(result.vectors, M, where);
  return result;
}

}  // namespace slipmode::pod
