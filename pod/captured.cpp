#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include "pod/internal/assemble.hpp"
#include "pod/internal/centred.hpp"
#include "pod/internal/mass_metric.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::pod {

Eigen::VectorXd captured_energy(const Ensemble& ensemble, const Basis& basis) {
  validate(ensemble);
  const Eigen::Index n = ensemble.snapshots.rows();
  const Eigen::Index L = basis.modes();
  if (basis.vectors.rows() != n || L < 1 || L > n || !basis.vectors.allFinite()) {
    throw InvalidInput(
        fmt::format("captured energy: basis is {} x {}, snapshots have {} rows; expected {} rows and 1 to "
                    "{} columns of finite values",
                    basis.vectors.rows(), L, n, n, n));
  }
  // The leading columns of Q span those of Φ for every L at once: no pivoting.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis.vectors);
  for (Eigen::Index j = 0; j < L; ++j) {
    if (std::abs(qr.matrixQR()(j, j)) <= 1e-12 * basis.vectors.col(j).norm()) {
      throw InvalidInput(
          fmt::format("captured energy: basis vector {} (from 1) depends on those before it; remove it", j + 1));
    }
  }
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(n, L);

  const Centred centred(ensemble.snapshots, true);
  double total = 0.0;
  Eigen::VectorXd captured = Eigen::VectorXd::Zero(L);
  centred.for_each_block([&](const auto& block) {
    total += block.squaredNorm();
    captured += (Q.transpose() * block).rowwise().squaredNorm();
  });
  if (is_constant(total, centred.mean(), centred.cols())) fail_constant(centred.cols(), total, true);
  for (Eigen::Index j = 1; j < L; ++j) captured[j] += captured[j - 1];
  return captured / total;
}

Eigen::VectorXd captured_energy(const Ensemble& ensemble, const Basis& basis, const fem::Matrix& M) {
  validate(ensemble);
  const Eigen::Index n = ensemble.snapshots.rows();
  const MassMetric metric(M, n, "captured energy");
  if (basis.vectors.rows() != n) {
    throw InvalidInput(fmt::format("captured energy: basis is {} x {}, snapshots have {} rows; expected {} rows",
                                   basis.vectors.rows(), basis.modes(), n, n));
  }
  Basis whitened;
  whitened.vectors = metric.whiten(basis.vectors);
  return captured_energy({metric.whiten(ensemble.snapshots), ensemble.run_begin}, whitened);
}

}  // namespace slipmode::pod
