#include "pod/internal/accumulator.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include "pod/internal/assemble.hpp"
#include "pod/internal/right_svd.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <limits>

namespace slipmode::pod {

PodAccumulator::PodAccumulator(Eigen::Index dofs, const PodOptions& options)
    : options_(options), dofs_(dofs), blocks_(std::max<Eigen::Index>(dofs, 0), options.remove_mean) {
  if (dofs < 1) throw InvalidInput(fmt::format("POD of a stream: {} degrees of freedom; expected at least 1", dofs));
  validate(options, dofs);
  if (options.method != PodMethod::kAutomatic && options.method != PodMethod::kQrSvd) {
    throw InvalidInput("POD of a stream: only the QR method takes snapshots in blocks; choose kAutomatic or kQrSvd");
  }
}

void PodAccumulator::add(const Eigen::Ref<const Eigen::MatrixXd>& block) {
  if (block.rows() != dofs_) {
    throw InvalidInput(
        fmt::format("POD of a stream: block has {} rows; expected {}, one per degree of freedom", block.rows(), dofs_));
  }
  if (!block.allFinite()) {
    throw InvalidInput(
        fmt::format("POD of a stream: a block of {} snapshots after the first {} holds values that are "
                    "not finite; remove the run it comes from",
                    block.cols(), snapshots_));
  }
  blocks_.add(block);
  snapshots_ += block.cols();
}

PodResult PodAccumulator::finish() const {
  if (snapshots_ < 2) {
    throw InvalidInput(
        fmt::format("POD of a stream: {} snapshot(s); expected at least 2. Sample more often or longer", snapshots_));
  }
  return modes_of(joined(BlockStream(blocks_).take()), options_);
}

PodResult modes_of(const SnapshotTriangle& sum, const PodOptions& options) {
  const Eigen::Index n = sum.R.cols();
  if (resolved_method(n, sum.count, options) == PodMethod::kLanczos)
    return assemble(decompose_lanczos(sum, options), options);
  const RightSvd svd = right_svd(sum.R);
  const Eigen::Index count = std::min(n, sum.count);

  Decomposition found;
  found.sigma = svd.sigma.head(count);
  found.vectors = svd.vectors.leftCols(count);
  found.mean = sum.origin + sum.mean;
  found.total = svd.sigma.squaredNorm();
  found.snapshots = sum.count;
  found.relative_error = 4.0 * static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  found.method = "blocked QR and SVD";
  return assemble(found, options);
}

}  // namespace slipmode::pod
