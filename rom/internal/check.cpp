#include "rom/internal/check.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/dense_lapack.hpp>
#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

namespace slipmode::rom {

namespace {

// The projected mass matrix has the square of this as its reciprocal condition: 1e-14 still factorises.
constexpr double kIndependence = 1e-7;

}  // namespace

void check_basis(const pod::Basis& basis, Eigen::Index n, std::string_view where) {
  const Eigen::MatrixXd& Phi = basis.vectors;
  const Eigen::Index rows = n < 0 ? Phi.rows() : n;
  if (Phi.rows() != rows || Phi.cols() < 1 || Phi.cols() > rows) {
    throw InvalidInput(
        fmt::format("{}: basis is {} x {}; expected {} rows, one per degree of freedom, and 1 to {} "
                    "columns. Was it made for another structure?",
                    where, Phi.rows(), Phi.cols(), rows, rows));
  }
  if (basis.mean.size() != 0 && basis.mean.size() != rows) {
    throw InvalidInput(
        fmt::format("{}: the basis's mean has {} values; expected {} or none", where, basis.mean.size(), rows));
  }
  if (!Phi.allFinite() || !basis.mean.allFinite()) {
    throw InvalidInput(
        fmt::format("{}: the basis holds values that are not finite; make it again or mend its file", where));
  }
  const Eigen::VectorXd norms = Phi.colwise().norm();
  for (Eigen::Index j = 0; j < norms.size(); ++j) {
    if (norms[j] == 0.0)
      throw InvalidInput(fmt::format("{}: basis vector {} (from 1) is zero; remove it", where, j + 1));
  }
  const Eigen::VectorXd sigma = singular_values(Phi * norms.cwiseInverse().asDiagonal(), false).sigma;
  const double ratio = sigma[sigma.size() - 1] / sigma[0];
  if (!(ratio >= kIndependence)) {
    throw InvalidInput(
        fmt::format("{}: the {} basis vectors are linearly dependent: smallest to largest singular value "
                    "{:.3g}, at least {:.0e} needed. Remove vectors that others combine to, or "
                    "orthonormalise them",
                    where, Phi.cols(), ratio, kIndependence));
  }
}

Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& vectors) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(vectors);
  return qr.householderQ() * Eigen::MatrixXd::Identity(vectors.rows(), vectors.cols());
}

Eigen::VectorXd mean_or_zero(const pod::Basis& basis) {
  if (basis.mean.size() > 0) return basis.mean;
  return Eigen::VectorXd::Zero(basis.vectors.rows());
}

}  // namespace slipmode::rom
