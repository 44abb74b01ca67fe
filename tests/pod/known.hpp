#pragma once

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/pod/ensemble.hpp>
#include "fixtures/normal_matrix.hpp"

#include <cmath>
#include <cstdint>

namespace slipmode::tests {

using fixtures::normal_matrix;

inline Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& A) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  return qr.householderQ() * Eigen::MatrixXd::Identity(A.rows(), A.cols());
}

/// Snapshots q̄1ᵀ + sqrt(T) U diag(σ) Vᵀ with UᵀU = VᵀV = I and Vᵀ1 = 0: mean, modes and singular values are known.
struct Known {
  pod::Ensemble ensemble;
  Eigen::VectorXd mean;
  Eigen::MatrixXd modes;
  Eigen::VectorXd sigma;
};

inline Known known_ensemble(std::uint64_t seed, Eigen::Index n, Eigen::Index T, const Eigen::VectorXd& sigma,
                            double mean_size = 1.0) {
  Random random(seed);
  const Eigen::Index k = sigma.size();
  Known known;
  known.mean = mean_size * normal_matrix(random, n, 1);
  known.modes = orthonormal(normal_matrix(random, n, k));
  Eigen::MatrixXd with_ones(T, k + 1);
  with_ones << Eigen::VectorXd::Ones(T), normal_matrix(random, T, k);
  const Eigen::MatrixXd V = orthonormal(with_ones).rightCols(k);
  known.sigma = sigma;
  known.ensemble.snapshots = std::sqrt(static_cast<double>(T)) * known.modes * sigma.asDiagonal() * V.transpose();
  known.ensemble.snapshots.colwise() += known.mean;
  return known;
}

/// 1, r, r², ...
inline Eigen::VectorXd powers(double ratio, Eigen::Index count) {
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) values[i] = std::pow(ratio, static_cast<double>(i));
  return values;
}

/// Largest component of a column outside its partner's direction, sign ignored.
inline double misalignment(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
  double worst = 0.0;
  for (Eigen::Index j = 0; j < expected.cols(); ++j) {
    const Eigen::VectorXd a = found.col(j);
    const Eigen::VectorXd b = expected.col(j);
    worst = std::max(worst, std::min((a - b).norm(), (a + b).norm()));
  }
  return worst;
}

}  // namespace slipmode::tests
