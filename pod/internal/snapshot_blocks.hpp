#pragma once

#include "pod/internal/snapshot_triangle.hpp"

#include <optional>
#include <vector>

// Snapshots are cut into blocks of a size that depends on the degrees of freedom alone. Each block becomes a triangle,
// snapshot after snapshot, and triangles are joined two by two, as the numbers of the blocks say. So the result's bytes
// depend on the snapshots and their order only: not on how they arrive, nor on which process has which block.

namespace slipmode::pod {

/// Snapshots in a block: at least 4096, and 2 n, so that joining costs a sixth of the blocks themselves.
[[nodiscard]] Eigen::Index block_size(Eigen::Index dofs);

/// The blocks index · 2^level … (index + 1) · 2^level − 1.
struct BlockRange {
  Eigen::Index level = 0, index = 0;

  /// What is joined with `right`, its neighbour, as soon as both are there; nothing where they are no pair.
  [[nodiscard]] std::optional<BlockRange> joined_with(const BlockRange& right) const;
};

/// Snapshots of several blocks as one triangle.
struct JoinedBlocks {
  BlockRange range;
  SnapshotTriangle sum;
};

/// Makes triangles of consecutive snapshots, from the beginning of a block on. Pairs are joined as soon as they are
/// there: of B blocks at most log2 B + 2 triangles are held.
class BlockStream {
 public:
  /// @param dofs         n ≥ 1
  /// @param remove_mean  false: the mean stays in
  /// @param first_block  number of the first one
  BlockStream(Eigen::Index dofs, bool remove_mean, Eigen::Index first_block = 0);

  /// @param snapshots  n x b [m], finite
  void add(const Eigen::Ref<const Eigen::MatrixXd>& snapshots);

  /// What is left to join: in order, no two of them a pair. The last block may be shorter. Ends the stream.
  [[nodiscard]] std::vector<JoinedBlocks> take();

 private:
  void absorb_group();
  void close_block();

  bool remove_mean_;
  Eigen::Index next_block_;
  std::vector<JoinedBlocks> joined_;
  std::optional<SnapshotTriangle> open_;  ///< the block that snapshots are added to
  Eigen::MatrixXd group_;                 ///< of snapshots that are absorbed together, `waiting_` so far
  Eigen::Index waiting_ = 0;
};

/// All of some ranges as one: those that are no pairs are joined from the last to the first.
/// @param ranges  as BlockStream::take() gives them, at least one
[[nodiscard]] SnapshotTriangle joined(std::vector<JoinedBlocks> ranges);

}  // namespace slipmode::pod
