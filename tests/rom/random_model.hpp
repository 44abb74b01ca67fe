#pragma once

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/pod/basis.hpp>
#include "fixtures/normal_matrix.hpp"

namespace slipmode::tests {

using fixtures::normal_matrix;

/// G Gᵀ of `rank` columns, plus `shift` on the diagonal.
inline Eigen::MatrixXd random_definite(Random& random, Eigen::Index n, Eigen::Index rank, double shift) {
  const Eigen::MatrixXd G = normal_matrix(random, n, rank);
  return G * G.transpose() + shift * Eigen::MatrixXd::Identity(n, n);
}

/// Dense M > 0, K ≥ 0 (sometimes with rigid-body motion), C ≥ 0 (Rayleigh, general or zero), one contact, a load.
inline dynamics::HybridSystem random_system(Random& random, Eigen::Index n) {
  Eigen::MatrixXd M = random_definite(random, n, n, 0.1);
  Eigen::MatrixXd K = random_definite(random, n, random.uniform() < 0.2 ? n - 1 : n, 0.0);
  const double kind = random.uniform();
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  if (kind < 0.4) C = 0.01 * M + 0.02 * K;
  if (kind > 0.6) C = random_definite(random, n, (n + 1) / 2, 0.0);
  friction::Contact contact{normal_matrix(random, n, 1), friction::Stribeck{0.4, 0.2, 8.0}, 3.0, 0.7, 0.0, "pad"};
  return {fem::Structure(M, fem::Matrix(C), K), {contact}, friction::Belt::constant(0.2), normal_matrix(random, n, 1)};
}

inline pod::Basis random_basis(Random& random, Eigen::Index n, Eigen::Index L) {
  pod::Basis basis;
  basis.vectors = normal_matrix(random, n, L);
  basis.mean = normal_matrix(random, n, 1);
  return basis;
}

}  // namespace slipmode::tests
