#include "diagnostics/series/internal/close_pairs.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace slipmode::diagnostics {

namespace {

using Eigen::Index;
using Counts = std::vector<std::int64_t>;

PairOptions checked(Index points, PairOptions options) {
  if (options.window < 0 || options.references < 0 || options.references > points || options.blocks < 1) {
    throw InvalidInput(
        fmt::format("close pairs of {} points: expected window >= 0, references from 0 to the number of points and "
                    "blocks >= 1, found {}, {} and {}",
                    points, options.window, options.references, options.blocks));
  }
  if (options.references == 0) options.references = points;
  return options;
}

/// Which points are references, and in which block.
struct References {
  Index points, count, blocks;

  [[nodiscard]] Index begin(Index block) const { return block * count / blocks; }
  [[nodiscard]] Index point(Index r) const { return r * points / count; }
};

Counts by_tree(const NeighbourTree& tree, const Shells& shells, Index window, const References& references,
               Index block) {
  Counts counts(shells.count(), 0);
  for (Index r = references.begin(block); r < references.begin(block + 1); ++r) {
    const Index i = references.point(r);
    tree.add_shells(i, shells, counts);
    for (Index j = std::max<Index>(0, i - window); j <= std::min(tree.size() - 1, i + window); ++j) {
      --counts[tree.shell(i, j, shells)];
    }
  }
  return counts;
}

/// Distances straight from the coordinates, a stretch of points in time order after the other.
class AllPairs {
 public:
  static constexpr Index kStretch = 512;  // their coordinates stay in the first cache while references go by

  AllPairs(const Eigen::MatrixXd& points, const Shells& shells) : shells_(shells) {
    coordinates_.setZero(points.cols() + kLanes, points.rows());
    coordinates_.topRows(points.cols()) = points.transpose();
  }

  /// Adds pairs of point i with points begin … end − 1, at most kStretch of them. @param out_counts  4 per shell
  void add(Index i, Index begin, Index end, Counts& out_counts) const {
    if (begin >= end) return;
    alignas(64) double distances[kStretch + kLanes];
    std::uint32_t scratch[kStretch];
    for (Index j = begin; j < end; j += kLanes) {
      Group distance = Group::Zero();
      for (Index k = 0; k < coordinates_.cols(); ++k) {
        distance = distance.max((coordinates_.col(k).segment<kLanes>(j).array() - coordinates_(i, k)).abs());
      }
      Eigen::Map<Group>(distances + (j - begin)) = distance;
    }
    shells_.add(distances, static_cast<std::size_t>(end - begin), scratch, out_counts.data());
  }

  [[nodiscard]] Counts counts() const { return Counts(4 * shells_.count(), 0); }
  /// Counts by shell from four of each.
  [[nodiscard]] Counts summed(const Counts& four) const {
    Counts sums(shells_.count());
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k] = four[4 * k] + four[4 * k + 1] + four[4 * k + 2] + four[4 * k + 3];
    return sums;
  }

 private:
  static constexpr Index kLanes = 16;
  using Group = Eigen::Array<double, kLanes, 1>;

  Eigen::MatrixXd coordinates_;  // [n + a group to read beyond the end x d]
  const Shells& shells_;
};

/// All pairs of a block of references.
Counts one_sided(const AllPairs& all, Index window, const References& references, Index block) {
  Counts counts = all.counts();
  for (Index begin = 0; begin < references.points; begin += AllPairs::kStretch) {
    const Index end = std::min(begin + AllPairs::kStretch, references.points);
    for (Index r = references.begin(block); r < references.begin(block + 1); ++r) {
      const Index i = references.point(r);
      all.add(i, begin, std::min(end, i - window), counts);
      all.add(i, std::max(begin, i + window + 1), end, counts);
    }
  }
  return all.summed(counts);
}

/// Pairs i < j, i in one block and j in another or the same, when every point is a reference.
Counts tile(const AllPairs& all, Index window, const References& references, Index of_i, Index of_j) {
  Counts counts = all.counts();
  const Index last = references.begin(of_j + 1);
  for (Index begin = references.begin(of_j); begin < last; begin += AllPairs::kStretch) {
    const Index end = std::min(begin + AllPairs::kStretch, last);
    for (Index i = references.begin(of_i); i < references.begin(of_i + 1); ++i) {
      all.add(i, std::max(begin, i + window + 1), end, counts);
    }
  }
  return all.summed(counts);
}

/// Block by block, each pair once.
std::vector<Counts> by_tiles(const AllPairs& all, const Shells& shells, const PairOptions& options,
                             const References& references) {
  std::vector<std::pair<Index, Index>> tiles;
  for (Index i = 0; i < references.blocks; ++i) {
    for (Index j = i; j < references.blocks; ++j) tiles.emplace_back(i, j);
  }
  std::vector<Counts> of_tiles(tiles.size());
  rethrow_first(parallel_for(tiles.size(), options.run, [&](std::size_t t) {
    of_tiles[t] = tile(all, options.window, references, tiles[t].first, tiles[t].second);
  }));
  std::vector<Counts> blocks(static_cast<std::size_t>(references.blocks), Counts(shells.count(), 0));
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    for (const Index block : {tiles[t].first, tiles[t].second}) {  // once as (i, j), once as (j, i)
      Counts& out = blocks[static_cast<std::size_t>(block)];
      std::transform(out.begin(), out.end(), of_tiles[t].begin(), out.begin(), std::plus<>());
    }
  }
  return blocks;
}

/// Whether the tree takes less time, by what it looks at for a few references.
bool tree_is_faster(const NeighbourTree& tree, const Shells& shells, const References& references) {
  constexpr Index kSample = 32;
  // Nanoseconds, measured in 2 to 10 dimensions with vectors of four numbers. Only their ratios count.
  const auto d = static_cast<double>(tree.points().rows());
  const double box = 5.0 + 6.0 * d, point = 1.8 + 0.05 * d, pair = 1.2 + 0.115 * d;
  NeighbourTree::Work work;
  Counts unused(shells.count(), 0);
  const Index sample = std::min(kSample, references.count);
  for (Index s = 0; s < sample; ++s) {
    const NeighbourTree::Work one = tree.add_shells(s * references.points / sample, shells, unused);
    work.boxes += one.boxes;
    work.points += one.points;
  }
  const double pairs = static_cast<double>(sample * references.points);
  const double of_all = references.count == references.points ? 0.5 * pairs : pairs;
  return box * static_cast<double>(work.boxes) + point * static_cast<double>(work.points) < pair * of_all;
}

}  // namespace

ClosePairs close_pairs(const Eigen::MatrixXd& points, std::span<const double> radii, const PairOptions& options) {
  const PairOptions settings = checked(points.cols(), options);
  const References references{points.cols(), settings.references, settings.blocks};
  const NeighbourTree tree(points, Norm::kMaximum);
  const Shells shells = tree.shells(radii);
  ClosePairs out;
  out.method = settings.method;
  if (out.method == PairMethod::kFaster) {
    out.method = tree_is_faster(tree, shells, references) ? PairMethod::kTree : PairMethod::kAllPairs;
  }

  std::vector<Counts> blocks(static_cast<std::size_t>(references.blocks));
  const auto each_block = [&](const auto& count) {
    rethrow_first(
        parallel_for(blocks.size(), settings.run, [&](std::size_t b) { blocks[b] = count(static_cast<Index>(b)); }));
  };
  if (out.method == PairMethod::kTree) {
    each_block([&](Index b) { return by_tree(tree, shells, settings.window, references, b); });
  } else {
    const AllPairs all(points, shells);
    if (references.count == references.points) {
      blocks = by_tiles(all, shells, settings, references);
    } else {
      each_block([&](Index b) { return one_sided(all, settings.window, references, b); });
    }
  }

  out.counts.resize(static_cast<Index>(radii.size()), references.blocks);
  for (Index b = 0; b < references.blocks; ++b) {
    std::int64_t sum = 0;
    for (Index k = 0; k < out.counts.rows(); ++k) {
      sum += blocks[static_cast<std::size_t>(b)][static_cast<std::size_t>(k)];
      out.counts(k, b) = sum;
    }
  }
  return out;
}

}  // namespace slipmode::diagnostics
