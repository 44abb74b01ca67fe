#include <slipmode/pod/pod.hpp>

#include <slipmode/core/decompositions.hpp>
#include "pod/internal/accumulator.hpp"
#include "pod/internal/assemble.hpp"
#include "pod/internal/right_svd.hpp"

#include <algorithm>
#include <limits>

namespace slipmode::pod {

namespace {

constexpr Eigen::Index kLargeProblem = 1000;  // below it a QR takes seconds, whatever is asked

/// Fewer snapshots than dofs: X − q̄ = Q R, and Q times the left singular vectors of R.
Decomposition decompose_tall(const Eigen::MatrixXd& snapshots, const PodOptions& options) {
  Decomposition found;
  found.mean = Eigen::VectorXd::Zero(snapshots.rows());
  Eigen::MatrixXd centred = snapshots;
  if (options.remove_mean) {
    const Eigen::VectorXd origin = snapshots.col(0);
    centred.colwise() -= origin;
    const Eigen::VectorXd mean = centred.rowwise().mean();
    centred.colwise() -= mean;
    found.mean = origin + mean;
  }
  const Eigen::Index T = snapshots.cols();
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(centred);
  const Eigen::MatrixXd R = qr.matrixQR().topRows(T).template triangularView<Eigen::Upper>();
  const RightSvd svd = right_svd(R.transpose());
  Eigen::MatrixXd vectors = Eigen::MatrixXd::Zero(snapshots.rows(), T);
  vectors.topRows(T) = svd.vectors;
  vectors.applyOnTheLeft(qr.householderQ());

  found.sigma = svd.sigma;
  found.vectors = std::move(vectors);
  found.total = svd.sigma.squaredNorm();
  found.snapshots = T;
  found.relative_error = 4.0 * static_cast<double>(T) * std::numeric_limits<double>::epsilon();
  found.method = "QR and SVD";
  return found;
}

PodResult pod_by_qr(const Eigen::MatrixXd& snapshots, const PodOptions& options) {
  if (snapshots.cols() < snapshots.rows()) return assemble(decompose_tall(snapshots, options), options);
  PodAccumulator accumulator(snapshots.rows(), options);
  accumulator.add(snapshots);
  return accumulator.finish();
}

}  // namespace

PodMethod resolved_method(Eigen::Index dofs, Eigen::Index snapshots, const PodOptions& options) {
  if (options.method != PodMethod::kAutomatic) return options.method;
  const Eigen::Index small = std::min(dofs, snapshots);
  if (small <= kLargeProblem) return PodMethod::kQrSvd;
  const bool few = options.choice.modes > 0 ? 20 * options.choice.modes <= small : options.choice.energy < 1.0;
  return few ? PodMethod::kLanczos : PodMethod::kQrSvd;
}

PodResult pod(const Ensemble& ensemble, const PodOptions& options) {
  validate(ensemble);
  validate(options, ensemble.snapshots.rows());
  PodOptions resolved = options;
  resolved.method = resolved_method(ensemble.snapshots.rows(), ensemble.snapshots.cols(), options);
  switch (resolved.method) {
    case PodMethod::kLanczos:
      return assemble(decompose_lanczos(ensemble.snapshots, resolved), resolved);
    case PodMethod::kCovariance:
      return assemble(decompose_covariance(ensemble.snapshots, resolved), resolved);
    case PodMethod::kAutomatic:
    case PodMethod::kQrSvd:
      break;
  }
  return pod_by_qr(ensemble.snapshots, resolved);
}

}  // namespace slipmode::pod
