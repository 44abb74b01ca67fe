#pragma once

#include <slipmode/orbits/skeleton.hpp>

#include <optional>

/// Inside of skeleton.cpp and skeleton_compare.cpp: what is made of an orbit once it is found.
namespace slipmode::orbits::detail {

/// Where an orbit crosses the section.
struct Passages {
  Eigen::MatrixXd points;   ///< (q; q̇), lifted [2n x p]
  Eigen::VectorXd offsets;  ///< time after the orbit's start, ascending, in [0, T) [p, s]
};

/// @param phase  a time at which a stroboscopic section is taken [s]
[[nodiscard]] Passages passages_of(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit,
                                   const Section& section, double phase, const std::optional<pod::Basis>& basis);

/// The smallest cyclic shift that maps points onto themselves within a distance; their number when none does.
/// @param points  scaled, in order [d x p]
[[nodiscard]] Eigen::Index least_length(const Eigen::MatrixXd& points, double same);

/// The smallest, over cyclic shifts, of the largest distance between points of two sequences of one length.
[[nodiscard]] double cyclic_distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// The path between passages: `samples` points at equal parts of each interval, from the first passage on.
[[nodiscard]] Eigen::MatrixXd path_of(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit,
                                      const Passages& passages, int samples, const std::optional<pod::Basis>& basis);

/// Times from each passage to the next [p, s].
[[nodiscard]] Eigen::VectorXd intervals_of(const Passages& passages, double period);

/// Share of points within a radius of the closed polygon through a path. Cost O(d S K).
/// @param points, path  scaled [d x S], [d x K]
[[nodiscard]] double share_near(const Eigen::MatrixXd& points, const Eigen::MatrixXd& path, double radius);

/// The largest distance of one of `points` to the nearest of `others`.
[[nodiscard]] double farthest(const Eigen::MatrixXd& points, const Eigen::MatrixXd& others);

}  // namespace slipmode::orbits::detail
