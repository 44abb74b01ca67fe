#include "pod/internal/accumulator.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include "pod/internal/assemble.hpp"
#include "pod/internal/right_svd.hpp"
#include "pod/internal/triangle.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::pod {

namespace {

constexpr Eigen::Index kGroup = 256;  // snapshots reduced at once: wide enough for matrix products, small beside n²

}  // namespace

PodAccumulator::PodAccumulator(Eigen::Index dofs, const PodOptions& options) : options_(options) {
  if (dofs < 1) throw InvalidInput(fmt::format("POD of a stream: {} degrees of freedom; expected at least 1", dofs));
  validate(options, dofs);
  if (options.method != PodMethod::kAutomatic && options.method != PodMethod::kQrSvd) {
    throw InvalidInput("POD of a stream: only the QR method takes snapshots in blocks; choose kAutomatic or kQrSvd");
  }
  triangle_ = Eigen::MatrixXd::Zero(dofs, dofs);
  group_.resize(dofs, kGroup);
  origin_ = Eigen::VectorXd::Zero(dofs);
  mean_ = Eigen::VectorXd::Zero(dofs);
}

void PodAccumulator::add(const Eigen::Ref<const Eigen::MatrixXd>& block) {
  if (block.rows() != group_.rows()) {
    throw InvalidInput(fmt::format("POD of a stream: block has {} rows; expected {}, one per degree of freedom",
                                   block.rows(), group_.rows()));
  }
  if (!block.allFinite()) {
    throw InvalidInput(
        fmt::format("POD of a stream: a block of {} snapshots after the first {} holds values that are "
                    "not finite; remove the run it comes from",
                    block.cols(), snapshots()));
  }
  if (block.cols() == 0) return;
  if (options_.remove_mean && snapshots() == 0) origin_ = block.col(0);
  for (Eigen::Index taken = 0; taken < block.cols();) {
    const Eigen::Index count = std::min(kGroup - pending_, block.cols() - taken);
    group_.middleCols(pending_, count) = block.middleCols(taken, count).colwise() - origin_;
    pending_ += count;
    taken += count;
    if (pending_ == kGroup) absorb_pending();
  }
}

void PodAccumulator::absorb_pending() {
  if (pending_ == 0) return;
  const auto group = group_.leftCols(pending_);
  if (!options_.remove_mean) {
    Eigen::MatrixXd rows = group.transpose();
    absorb_rows(triangle_, rows);
  } else {
    const double before = static_cast<double>(absorbed_);
    const double added = static_cast<double>(pending_);
    const Eigen::VectorXd group_mean = group.rowwise().mean();
    const Eigen::VectorXd step = group_mean - mean_;
    Eigen::MatrixXd rows(pending_ + 1, group.rows());
    rows.topRows(pending_) = (group.colwise() - group_mean).transpose();
    rows.row(pending_) = std::sqrt(before * added / (before + added)) * step.transpose();
    absorb_rows(triangle_, rows);
    mean_ += step * (added / (before + added));
  }
  absorbed_ += pending_;
  pending_ = 0;
}

PodResult PodAccumulator::finish() const {
  PodAccumulator all = *this;
  all.absorb_pending();
  const Eigen::Index n = all.triangle_.cols();
  if (all.absorbed_ < 2) {
    throw InvalidInput(fmt::format("POD of a stream: {} snapshot(s); expected at least 2. Sample more often or longer",
                                   all.absorbed_));
  }
  RightSvd svd = right_svd(all.triangle_);
  const Eigen::Index count = std::min(n, all.absorbed_);

  Decomposition found;
  found.sigma = svd.sigma.head(count);
  found.vectors = svd.vectors.leftCols(count);
  found.mean = all.origin_ + all.mean_;
  found.total = svd.sigma.squaredNorm();
  found.snapshots = all.absorbed_;
  found.relative_error = 4.0 * static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  found.method = "blocked QR and SVD";
  return assemble(found, options_);
}

}  // namespace slipmode::pod
