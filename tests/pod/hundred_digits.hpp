#pragma once

#include "known.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstdint>
#include <vector>

namespace slipmode::tests {

using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;
using WideMatrix = std::vector<std::vector<Wide>>;

/// Eigenvalues of a symmetric matrix by cyclic two-sided Jacobi, in no order.
inline std::vector<Wide> eigenvalues(WideMatrix A) {
  const std::size_t n = A.size();
  for (int sweep = 0; sweep < 40; ++sweep) {
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        if (A[p][q] == 0) continue;
        const Wide zeta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
        const Wide t = (zeta < 0 ? -1 : 1) / (abs(zeta) + sqrt(1 + zeta * zeta));
        const Wide c = 1 / sqrt(1 + t * t);
        const Wide s = c * t;
        for (std::size_t k = 0; k < n; ++k) {
          const Wide x = A[k][p];
          A[k][p] = c * x - s * A[k][q];
          A[k][q] = s * x + c * A[k][q];
        }
        for (std::size_t k = 0; k < n; ++k) {
          const Wide x = A[p][k];
          A[p][k] = c * x - s * A[q][k];
          A[q][k] = s * x + c * A[q][k];
        }
      }
    }
  }
  std::vector<Wide> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(A[i][i]);
  return values;
}

/// Singular values of X − q̄ over sqrt(T) by the covariance in 100 digits: squaring a condition of 1e16 leaves 68.
inline Eigen::VectorXd singular_values_100_digits(const Eigen::MatrixXd& X, bool remove_mean) {
  const auto n = static_cast<std::size_t>(X.rows());
  const auto T = static_cast<std::size_t>(X.cols());
  WideMatrix wide(n, std::vector<Wide>(T));
  for (std::size_t i = 0; i < n; ++i) {
    Wide sum = 0;
    for (std::size_t t = 0; t < T; ++t) {
      wide[i][t] = X(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(t));
      sum += wide[i][t];
    }
    if (!remove_mean) continue;
    for (Wide& value : wide[i]) value -= sum / T;
  }
  WideMatrix covariance(n, std::vector<Wide>(n, Wide(0)));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t t = 0; t < T; ++t) covariance[i][j] += wide[i][t] * wide[j][t];
    }
  }
  std::vector<Wide> values = eigenvalues(covariance);
  std::sort(values.rbegin(), values.rend());
  Eigen::VectorXd sigma(X.rows());
  for (std::size_t i = 0; i < n; ++i) sigma[static_cast<Eigen::Index>(i)] = static_cast<double>(sqrt(values[i] / T));
  return sigma;
}

/// Dofs that differ by two decades from one to the next, mixed by a well-conditioned matrix: sixteen decades.
inline pod::Ensemble graded(std::uint64_t seed, Eigen::Index T) {
  Random random(seed);
  pod::Ensemble ensemble;
  ensemble.snapshots = powers(0.01, 9).asDiagonal() * normal_matrix(random, 9, T);
  return ensemble;
}

inline double worst_relative(const Eigen::VectorXd& found, const Eigen::VectorXd& expected) {
  return ((found - expected).array() / expected.array()).abs().maxCoeff();
}

}  // namespace slipmode::tests
