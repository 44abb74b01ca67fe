#include "pod/internal/snapshot_triangle.hpp"

#include "pod/internal/triangle.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::pod {

namespace {

/// Moves the mean by that of `added` snapshots. @return the row that R takes for the distance of the means
Eigen::RowVectorXd move_mean(SnapshotTriangle& sum, const Eigen::VectorXd& step, Eigen::Index added) {
  const double before = static_cast<double>(sum.count);
  const double now = static_cast<double>(added);
  sum.mean += step * (now / (before + now));
  sum.count += added;
  return std::sqrt(before * now / (before + now)) * step.transpose();
}

}  // namespace

SnapshotTriangle empty_triangle(const Eigen::VectorXd& origin) {
  const Eigen::Index n = origin.size();
  return {.origin = origin, .mean = Eigen::VectorXd::Zero(n), .R = Eigen::MatrixXd::Zero(n, n)};
}

void absorb(SnapshotTriangle& sum, const Eigen::Ref<const Eigen::MatrixXd>& group, bool remove_mean) {
  if (!remove_mean) {
    Eigen::MatrixXd rows = group.transpose();
    absorb_rows(sum.R, rows);
    sum.count += group.cols();
    return;
  }
  const Eigen::VectorXd mean = group.rowwise().mean();
  Eigen::MatrixXd rows(group.cols() + 1, group.rows());
  rows.topRows(group.cols()) = (group.colwise() - mean).transpose();
  rows.row(group.cols()) = move_mean(sum, mean - sum.mean, group.cols());
  absorb_rows(sum.R, rows);
}

void join(SnapshotTriangle& sum, const SnapshotTriangle& other,
          const std::function<Eigen::MatrixXd(Eigen::Index k)>& rows) {
  // Origins that are close differ without rounding.
  const Eigen::VectorXd step = (other.origin - sum.origin) + (other.mean - sum.mean);
  Eigen::MatrixXd distance = move_mean(sum, step, other.count);
  absorb_rows(sum.R, distance);
  const Eigen::Index n = sum.R.cols();
  for (Eigen::Index k = 0; k < n; k += kTriangleRows) {
    Eigen::MatrixXd more = rows(k);
    absorb_rows(sum.R.bottomRightCorner(n - k, n - k), more);
  }
}

void join(SnapshotTriangle& sum, const SnapshotTriangle& other) {
  join(sum, other, [&](Eigen::Index k) { return rows_of(other, k); });
}

Eigen::MatrixXd rows_of(const SnapshotTriangle& triangle, Eigen::Index k) {
  const Eigen::Index n = triangle.R.cols();
  return triangle.R.block(k, k, std::min(kTriangleRows, n - k), n - k).triangularView<Eigen::Upper>();
}

}  // namespace slipmode::pod
