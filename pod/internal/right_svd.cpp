#include "pod/internal/right_svd.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/dense_lapack.hpp>
#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace slipmode::pod {

namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();
constexpr int kMaxSweeps = 60;
constexpr Eigen::Index kJacobiLimit = 256;
constexpr double kNegligible = 1e-125;  // relative to the largest entry; its square is still a normal number

double power_of_two_near(double value) { return value > 0.0 ? std::exp2(std::ilogb(value)) : 1.0; }

/// Makes columns p and q of G orthogonal. Returns |cosine| of the angle between them before.
double rotate(Eigen::MatrixXd& G, Eigen::Index p, Eigen::Index q, double tolerance) {
  const double a = G.col(p).squaredNorm();
  const double b = G.col(q).squaredNorm();
  if (a == 0.0 || b == 0.0) return 0.0;
  const double c = G.col(p).dot(G.col(q));
  const double cosine = std::abs(c) / (std::sqrt(a) * std::sqrt(b));
  if (!(cosine > tolerance)) return cosine;
  const double zeta = (b - a) / (2.0 * c);
  const double t = std::copysign(1.0 / (std::abs(zeta) + std::hypot(1.0, zeta)), zeta);
  const double cs = 1.0 / std::hypot(1.0, t);
  G.applyOnTheRight(p, q, Eigen::JacobiRotation<double>(cs, cs * t));
  return cosine;
}

void orthogonalise_columns(Eigen::MatrixXd& G) {
  const Eigen::Index n = G.cols();
  const double tolerance = kRounding * std::sqrt(static_cast<double>(std::max<Eigen::Index>(n, 4)));
  double worst = 0.0;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    worst = 0.0;
    for (Eigen::Index p = 0; p + 1 < n; ++p) {
      for (Eigen::Index q = p + 1; q < n; ++q) worst = std::max(worst, rotate(G, p, q, tolerance));
    }
    if (worst <= tolerance) return;
  }
  throw NumericalFailure(fmt::format("SVD: columns still overlap by {:.3g} after {} Jacobi sweeps; expected {:.3g}",
                                     worst, kMaxSweeps, tolerance),
                         std::numeric_limits<double>::quiet_NaN(), {}, worst);
}

}  // namespace

RightSvd right_svd_jacobi(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.cols();
  const Eigen::Index k = std::min(A.rows(), n);
  // Squares of column norms must neither overflow nor underflow.
  const double scale = power_of_two_near(A.size() == 0 ? 0.0 : A.cwiseAbs().maxCoeff());
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A / scale);
  // A P = Q R; the left singular vectors of Rᵀ, permuted back, are the right ones of A.
  Eigen::MatrixXd G = qr.matrixR().topRows(k).template triangularView<Eigen::Upper>().toDenseMatrix().transpose();
  for (Eigen::Index i = 0; i < k; ++i) {
    if (G.col(i).norm() < kNegligible) G.col(i).setZero();
  }
  orthogonalise_columns(G);

  const Eigen::VectorXd norms = G.colwise().norm();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(k));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) { return norms[i] > norms[j]; });

  RightSvd svd{Eigen::VectorXd(k), Eigen::MatrixXd::Zero(n, k)};
  for (Eigen::Index i = 0; i < k; ++i) {
    const Eigen::Index from = order[static_cast<std::size_t>(i)];
    svd.sigma[i] = scale * norms[from];
    if (norms[from] > 0.0) svd.vectors.col(i) = qr.colsPermutation() * (G.col(from) / norms[from]);
  }
  return svd;
}

RightSvd right_svd(const Eigen::MatrixXd& A) {
  if (A.cols() <= kJacobiLimit) return right_svd_jacobi(A);
  SingularValues found = singular_values(A);
  return {std::move(found.sigma), std::move(found.V)};
}

}  // namespace slipmode::pod
