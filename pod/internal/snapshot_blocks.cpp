#include "pod/internal/snapshot_blocks.hpp"

#include <algorithm>
#include <utility>

namespace slipmode::pod {

namespace {

constexpr Eigen::Index kGroup = 256;  // snapshots reduced at once: wide enough for matrix products, small beside n²

}  // namespace

Eigen::Index block_size(Eigen::Index dofs) {
  constexpr Eigen::Index kLeast = 4096;
  return kGroup * ((std::max(kLeast, 2 * dofs) + kGroup - 1) / kGroup);
}

std::optional<BlockRange> BlockRange::joined_with(const BlockRange& right) const {
  if (right.level != level || right.index != index + 1 || index % 2 != 0) return std::nullopt;
  return BlockRange{.level = level + 1, .index = index / 2};
}

BlockStream::BlockStream(Eigen::Index dofs, bool remove_mean, Eigen::Index first_block)
    : remove_mean_(remove_mean), next_block_(first_block), group_(dofs, kGroup) {}

void BlockStream::add(const Eigen::Ref<const Eigen::MatrixXd>& snapshots) {
  for (Eigen::Index taken = 0; taken < snapshots.cols();) {
    if (!open_) {
      Eigen::VectorXd origin = Eigen::VectorXd::Zero(group_.rows());
      if (remove_mean_) origin = snapshots.col(taken);
      open_ = empty_triangle(origin);
    }
    const Eigen::Index count = std::min(kGroup - waiting_, snapshots.cols() - taken);
    group_.middleCols(waiting_, count) = snapshots.middleCols(taken, count).colwise() - open_->origin;
    waiting_ += count;
    taken += count;
    if (waiting_ == kGroup) absorb_group();
  }
}

void BlockStream::absorb_group() {
  absorb(*open_, group_.leftCols(waiting_), remove_mean_);
  waiting_ = 0;
  if (open_->count == block_size(group_.rows())) close_block();
}

void BlockStream::close_block() {
  joined_.push_back({{.index = next_block_++}, *std::exchange(open_, std::nullopt)});
  while (joined_.size() > 1) {
    JoinedBlocks& left = *(joined_.end() - 2);
    const auto both = left.range.joined_with(joined_.back().range);
    if (!both) return;
    join(left.sum, joined_.back().sum);
    left.range = *both;
    joined_.pop_back();
  }
}

std::vector<JoinedBlocks> BlockStream::take() {
  if (waiting_ > 0) absorb_group();
  if (open_) close_block();
  return std::move(joined_);
}

SnapshotTriangle joined(std::vector<JoinedBlocks> ranges) {
  for (; ranges.size() > 1; ranges.pop_back()) join((ranges.end() - 2)->sum, ranges.back().sum);
  return std::move(ranges.front().sum);
}

}  // namespace slipmode::pod
