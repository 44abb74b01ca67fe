#pragma once

#include <Eigen/Core>
#include <vector>

namespace slipmode::orbits {

/// Points i and i + length of a sequence lie close together: a stretch near a periodic orbit.
struct CloseReturn {
  Eigen::Index begin = 0;   ///< i
  Eigen::Index length = 0;  ///< p, in points of the sequence
  double distance = 0.0;    ///< |x(i + p) − x(i)|, in the unit of the points
};

struct ReturnOptions {
  Eigen::Index min_length = 1;  ///< ≥ 1
  Eigen::Index max_length = 12;
  double threshold = 0.3;        ///< largest distance of a return, > 0, in the unit of the points
  Eigen::Index per_length = 40;  ///< nearest returns kept of each length, ≥ 1
  /// Section points: of two stretches of one length that lie nearer to each other than this all along, whatever their
  /// phase, only the one that closes better is kept, ≥ 0.
  double apart = 0.0;
};

/// Close returns of section points: pairs (i, i + p) below the threshold, nearest first. Of a stretch that follows one
/// orbit for several passages only the nearest counts: returns of one length begin more than that length apart. A
/// return that a divisor q of its length explains, |x(i + q) − x(i)| ≤ |x(i + p) − x(i)|, is left out. Sorted by
/// length, then by distance.
///
/// Points should be scaled (Metric::scaled). Cost O(d T P) and, of returns below the threshold, O(returns ·
/// per_length).
/// @param points  one column per passage, in order [d x T]
/// @throws InvalidInput  for options out of range, values not finite, fewer than two points
/// Source: S4 section 3.5.4 for sections in place of a dense record.
[[nodiscard]] std::vector<CloseReturn> section_returns(const Eigen::MatrixXd& points, const ReturnOptions& options);

/// Close returns of a densely sampled path, as measured data give: S4's (m, ε) recurrent points. From each point i the
/// path is followed until it has left the ball of the threshold's radius and comes back first; the nearest point of
/// that visit is the return. Of consecutive i whose returns belong together (lengths differ by one at most from one i
/// to the next) the nearest is kept. Sorted by length, then by distance; per_length counts returns of the very same
/// length.
/// @param points  one column per instant [d x T], as diagnostics::delay_vectors gives them
/// @throws InvalidInput  as section_returns
/// Source: S4 section 3.5.4; Lathrop & Kostelich, Phys. Rev. A 40 (1989) 4028.
[[nodiscard]] std::vector<CloseReturn> path_returns(const Eigen::MatrixXd& points, const ReturnOptions& options);

/// The threshold of S4 section 3.5.4: half the mean distance of consecutive points.
/// @throws InvalidInput  for fewer than two points
[[nodiscard]] double half_mean_step(const Eigen::MatrixXd& points);

}  // namespace slipmode::orbits
