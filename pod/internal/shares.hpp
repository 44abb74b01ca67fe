#pragma once

#include "pod/internal/snapshot_blocks.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace slipmode::pod {

/// Which rank has which snapshots, and which blocks it makes triangles of: those that begin in its share, and rank 0
/// the first in any case. Snapshots of a share that belong to an earlier rank's block, its head, go there.
class Shares {
 public:
  /// @param counts      snapshots by rank
  /// @param block_size  in snapshots
  Shares(const std::vector<Eigen::Index>& counts, Eigen::Index block_size);

  [[nodiscard]] Eigen::Index snapshots() const { return begin_.back(); }
  [[nodiscard]] Eigen::Index blocks() const { return blocks_before(snapshots()); }
  [[nodiscard]] int ranks() const { return static_cast<int>(begin_.size()) - 1; }

  /// The first snapshot of a share.
  [[nodiscard]] Eigen::Index begin(int rank) const { return begin_[static_cast<std::size_t>(rank)]; }
  /// How many of its snapshots are its head; 0 for rank 0.
  [[nodiscard]] Eigen::Index head(int rank) const;
  /// Where that goes.
  [[nodiscard]] int head_owner(int rank) const;

  /// The first block that is the rank's, and the one after its last.
  [[nodiscard]] Eigen::Index first_block(int rank) const;
  [[nodiscard]] Eigen::Index end_block(int rank) const;

 private:
  [[nodiscard]] Eigen::Index blocks_before(Eigen::Index snapshot) const { return (snapshot + size_ - 1) / size_; }

  std::vector<Eigen::Index> begin_;  ///< by rank, and the end
  Eigen::Index size_;
};

/// Two triangles that become one, on the rank of the first.
struct Join {
  int into = 0, from = 0;                      ///< ranks
  std::size_t into_place = 0, from_place = 0;  ///< among what BlockStream::take() gave there
};

/// How the triangles of all ranks become one at the first place of rank 0: every rank does its part of these in this
/// order. Triangles of different ranks are joined side by side.
[[nodiscard]] std::vector<Join> joins_of(const Shares& shares);

}  // namespace slipmode::pod
