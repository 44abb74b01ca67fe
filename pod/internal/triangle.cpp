#include "pod/internal/triangle.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::pod {

namespace {

constexpr Eigen::Index kPanel = 32;

/// Reduces the panel of columns [begin, begin + width) and returns the triangular factor of its compact WY form; the
/// lower parts of the reflectors replace those columns of `rows`.
Eigen::MatrixXd reduce_panel(Eigen::Ref<Eigen::MatrixXd>& R, Eigen::Ref<Eigen::MatrixXd>& rows, Eigen::Index begin,
                             Eigen::Index width) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(width, width);
  for (Eigen::Index j = 0; j < width; ++j) {
    const Eigen::Index column = begin + j;
    auto v = rows.col(column);
    const double below = v.norm();
    if (below == 0.0) continue;
    const double alpha = R(column, column);
    const double beta = -std::copysign(std::hypot(alpha, below), alpha);
    const double tau = (beta - alpha) / beta;
    v /= alpha - beta;
    R(column, column) = beta;

    const Eigen::Index left = width - j - 1;
    if (left > 0) {
      auto rest = rows.middleCols(column + 1, left);
      Eigen::RowVectorXd update = R.row(column).segment(column + 1, left);
      update.noalias() += v.transpose() * rest;
      update *= tau;
      R.row(column).segment(column + 1, left) -= update;
      rest.noalias() -= v * update;
    }
    if (j > 0) {
      const Eigen::VectorXd overlap = rows.middleCols(begin, j).transpose() * v;
      factor.col(j).head(j) = factor.topLeftCorner(j, j).triangularView<Eigen::Upper>() * (-tau * overlap).eval();
    }
    factor(j, j) = tau;
  }
  return factor;
}

}  // namespace

void absorb_rows(Eigen::Ref<Eigen::MatrixXd> R, Eigen::Ref<Eigen::MatrixXd> rows) {
  const Eigen::Index n = R.cols();
  for (Eigen::Index begin = 0; begin < n; begin += kPanel) {
    const Eigen::Index width = std::min(kPanel, n - begin);
    const Eigen::MatrixXd factor = reduce_panel(R, rows, begin, width);
    const Eigen::Index end = begin + width;
    if (end == n) continue;
    auto trailing = rows.rightCols(n - end);
    Eigen::MatrixXd update = R.block(begin, end, width, n - end);
    update.noalias() += rows.middleCols(begin, width).transpose() * trailing;
    update = factor.triangularView<Eigen::Upper>().transpose() * update;
    R.block(begin, end, width, n - end) -= update;
    trailing.noalias() -= rows.middleCols(begin, width) * update;
  }
}

}  // namespace slipmode::pod
