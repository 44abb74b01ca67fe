#pragma once

#include <slipmode/core/parallel.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace slipmode::diagnostics {

/// How pairs are counted. Both give the same numbers.
enum class PairMethod {
  kFaster,    ///< whichever is estimated to take less time
  kTree,      ///< boxes of points in a k-d tree: fast where most pairs are far apart, or very many points close by
  kAllPairs,  ///< one distance after the other, several at once; where every point is a reference, each pair once
};

struct PairOptions {
  Eigen::Index window = 0;      ///< of Theiler: pairs with |i − j| ≤ window do not count
  Eigen::Index references = 0;  ///< points whose neighbours are counted, evenly spaced, at most all; 0: all
  Eigen::Index blocks = 64;     ///< of references, counted apart; ≥ 1
  PairMethod method = PairMethod::kFaster;
  ParallelOptions run = {};
};

/// Ordered pairs by radius.
struct ClosePairs {
  /// Pairs not farther apart than radius k whose reference belongs to block b: reference r of R is point r·n/R, and
  /// block b of B holds references b·R/B … (b + 1)·R/B − 1 [radii x blocks].
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic> counts;
  PairMethod method = PairMethod::kTree;  ///< the one used
};

/// Counts pairs (i, j), i a reference, |i − j| > window, ‖x_i − x_j‖∞ ≤ r, for all radii in one go.
///
/// Distances are differences and maxima alone, which do not depend on the order or the width of operations: the counts
/// are the same by either method, for any number of threads and on any processor.
/// Cost: all pairs O(R n d), half of that where R = n; the tree less, as far as it can count whole boxes. kFaster
/// walks the tree for a few references and weighs what it looked at; that costs no more than a few thousandths.
/// @param points  one column each, in time order, finite [d x n]
/// @param radii   ascending, ≥ 0
/// @throws InvalidInput  for points or radii that do not fit, window < 0, references outside 0 … n, blocks < 1
[[nodiscard]] ClosePairs close_pairs(const Eigen::MatrixXd& points, std::span<const double> radii,
                                     const PairOptions& options);

}  // namespace slipmode::diagnostics
