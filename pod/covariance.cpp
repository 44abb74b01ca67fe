#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include "pod/internal/assemble.hpp"
#include "pod/internal/centred.hpp"

#include <fmt/format.h>
#include <cmath>
#include <limits>

namespace slipmode::pod {

Decomposition decompose_covariance(const Eigen::MatrixXd& snapshots, const PodOptions& options) {
  const Centred centred(snapshots, options.remove_mean);
  const Eigen::Index n = centred.rows();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  centred.for_each_block([&](const auto& block) { covariance.selfadjointView<Eigen::Lower>().rankUpdate(block); });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  if (eigen.info() != Eigen::Success) {
    throw NumericalFailure(fmt::format("POD: eigenvalues of the {} x {} covariance did not converge", n, n), kNone, {},
                           kNone);
  }
  const Eigen::Index count = std::min(n, centred.cols());

  Decomposition found;
  // A negative eigenvalue of a covariance is rounding: its singular value is not known to be anything but zero.
  found.sigma = eigen.eigenvalues().reverse().head(count).cwiseMax(0.0).cwiseSqrt();
  found.vectors = eigen.eigenvectors().rowwise().reverse().leftCols(count);
  found.mean = centred.mean();
  found.total = found.sigma.squaredNorm();
  found.snapshots = centred.cols();
  found.relative_error = 4.0 * std::sqrt(static_cast<double>(n) * std::numeric_limits<double>::epsilon());
  found.method = "covariance";
  return found;
}

}  // namespace slipmode::pod
