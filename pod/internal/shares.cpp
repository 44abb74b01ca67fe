#include "pod/internal/shares.hpp"

#include <algorithm>
#include <optional>

namespace slipmode::pod {

namespace {

/// A triangle somewhere.
struct Held {
  BlockRange range;
  int rank = 0;
  std::size_t place = 0;
};

/// Puts a triangle behind the others; pairs become one.
template <class Report>
void push(std::vector<Held>& held, const Held& next, const Report& joined) {
  held.push_back(next);
  while (held.size() > 1) {
    Held& left = *(held.end() - 2);
    const auto both = left.range.joined_with(held.back().range);
    if (!both) return;
    joined(left, held.back());
    left.range = *both;
    held.pop_back();
  }
}

}  // namespace

Shares::Shares(const std::vector<Eigen::Index>& counts, Eigen::Index block_size) : begin_(1, 0), size_(block_size) {
  for (const Eigen::Index count : counts) begin_.push_back(begin_.back() + count);
}

Eigen::Index Shares::head(int rank) const {
  if (rank == 0) return 0;
  const Eigen::Index first = begin(rank), end = begin(rank + 1);
  return std::min(end, size_ * std::max<Eigen::Index>(1, blocks_before(first))) - first;
}

int Shares::head_owner(int rank) const {
  const Eigen::Index block_begin = begin(rank) / size_ * size_;
  if (block_begin == 0) return 0;
  return static_cast<int>(std::upper_bound(begin_.begin(), begin_.end(), block_begin) - begin_.begin()) - 1;
}

Eigen::Index Shares::first_block(int rank) const {
  return rank == 0 ? 0 : std::max<Eigen::Index>(1, blocks_before(begin(rank)));
}

Eigen::Index Shares::end_block(int rank) const {
  return std::max(first_block(rank), std::max<Eigen::Index>(1, blocks_before(begin(rank + 1))));
}

std::vector<Join> joins_of(const Shares& shares) {
  std::vector<Join> joins;
  const auto join = [&](const Held& left, const Held& right) {
    joins.push_back({.into = left.rank, .from = right.rank, .into_place = left.place, .from_place = right.place});
  };
  std::vector<Held> all;
  for (int rank = 0; rank < shares.ranks(); ++rank) {
    std::vector<Held> own;
    for (Eigen::Index block = shares.first_block(rank); block < shares.end_block(rank); ++block)
      push(own, {.range = {.index = block}, .rank = rank}, [](const Held&, const Held&) {});
    for (std::size_t place = 0; place < own.size(); ++place) {
      own[place].place = place;
      push(all, own[place], join);
    }
  }
  for (; all.size() > 1; all.pop_back()) join(*(all.end() - 2), all.back());
  return joins;
}

}  // namespace slipmode::pod
