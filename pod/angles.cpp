#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/pod/pod.hpp>
#include "pod/internal/mass_metric.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::pod {

namespace {

/// Orthonormal basis of the columns of A.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& A, const char* name) {
  if (A.cols() < 1 || A.cols() > A.rows() || !A.allFinite()) {
    throw InvalidInput(
        fmt::format("subspace angles: {} is {} x {}; expected 1 to {} independent columns of finite values", name,
                    A.rows(), A.cols(), A.rows()));
  }
  const Eigen::VectorXd norms = A.colwise().norm();
  if (norms.minCoeff() == 0.0) throw InvalidInput(fmt::format("subspace angles: {} has a column of zeros", name));
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A * norms.cwiseInverse().asDiagonal());
  const double independence = std::abs(qr.matrixR()(A.cols() - 1, A.cols() - 1));
  if (independence < 1e-12) {
    throw InvalidInput(
        fmt::format("subspace angles: columns of {} are linearly dependent (one lies within {:.3g} of the "
                    "span of the others); remove it",
                    name, independence));
  }
  return qr.householderQ() * Eigen::MatrixXd::Identity(A.rows(), A.cols());
}

void check_rows(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  if (A.rows() != B.rows()) {
    throw InvalidInput(fmt::format("subspace angles: A has {} rows, B {}; expected the same", A.rows(), B.rows()));
  }
}

}  // namespace

Eigen::VectorXd subspace_angles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  check_rows(A, B);
  const Eigen::MatrixXd QA = orthonormal(A, "A");
  const Eigen::MatrixXd QB = orthonormal(B, "B");
  const Eigen::MatrixXd& large = QA.cols() >= QB.cols() ? QA : QB;
  const Eigen::MatrixXd& small = QA.cols() >= QB.cols() ? QB : QA;
  const Eigen::MatrixXd overlap = large.transpose() * small;
  const Eigen::VectorXd cosines = Eigen::JacobiSVD<Eigen::MatrixXd>(overlap).singularValues();
  const Eigen::VectorXd sines = Eigen::JacobiSVD<Eigen::MatrixXd>(small - large * overlap).singularValues().reverse();
  return sines.binaryExpr(cosines, [](double s, double c) { return std::atan2(s, c); });
}

Eigen::VectorXd subspace_angles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const fem::Matrix& W) {
  check_rows(A, B);
  const MassMetric metric(W, A.rows(), "subspace angles");
  return subspace_angles(metric.whiten(A), metric.whiten(B));
}

}  // namespace slipmode::pod
