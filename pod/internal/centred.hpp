#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace slipmode::pod {

/// X − q̄ handed out in column blocks, so that no second copy of the snapshots is needed.
class Centred {
 public:
  /// Keeps a reference to the snapshots.
  /// @param remove_mean  false: q̄ = 0
  Centred(const Eigen::MatrixXd& snapshots, bool remove_mean);

  [[nodiscard]] Eigen::Index rows() const { return snapshots_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return snapshots_.cols(); }
  [[nodiscard]] Eigen::VectorXd mean() const { return origin_ + mean_; }

  /// Calls use(block) for consecutive n x b blocks, b ≤ 256.
  template <class Use>
  void for_each_block(const Use& use) const {
    constexpr Eigen::Index kBlock = 256;
    Eigen::MatrixXd block(rows(), std::min(kBlock, cols()));
    for (Eigen::Index begin = 0; begin < cols(); begin += kBlock) {
      const Eigen::Index count = std::min(kBlock, cols() - begin);
      auto part = block.leftCols(count);
      // Two subtractions: the first is exact for snapshots close to the origin, so a large offset costs no digits.
      part = (snapshots_.middleCols(begin, count).colwise() - origin_).colwise() - mean_;
      use(part);
    }
  }

  /// ‖X − q̄‖²_F
  [[nodiscard]] double total() const;

 private:
  const Eigen::MatrixXd& snapshots_;
  Eigen::VectorXd origin_;  // the first snapshot, or zero
  Eigen::VectorXd mean_;    // measured from origin_
};

}  // namespace slipmode::pod
