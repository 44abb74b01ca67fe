#include "pod/internal/centred.hpp"

namespace slipmode::pod {

Centred::Centred(const Eigen::MatrixXd& snapshots, bool remove_mean)
    : snapshots_(snapshots),
      origin_(Eigen::VectorXd::Zero(snapshots.rows())),
      mean_(Eigen::VectorXd::Zero(snapshots.rows())) {
  if (!remove_mean) return;
  origin_ = snapshots.col(0);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(rows());
  for_each_block([&](const auto& block) { sum += block.rowwise().sum(); });
  mean_ = sum / static_cast<double>(cols());
}

double Centred::total() const {
  double sum = 0.0;
  for_each_block([&](const auto& block) { sum += block.squaredNorm(); });
  return sum;
}

}  // namespace slipmode::pod
