#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/orbits/attractor.hpp>
#include <slipmode/orbits/close_returns.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slipmode::orbits {

/// Where Newton's method begins in the search for one orbit.
struct Candidate {
  dynamics::State state = {};  ///< in the model's own coordinates
  double period = 0.0;         ///< [s]
  Eigen::Index length = 0;     ///< passages of the section per period, as the guess has it
  double distance = 0.0;       ///< of the close return, in the attractor's metric; 0 for a transferred orbit
  std::string origin = {};     ///< in words: "passage 2628", "orbit 3 of the other model"
  /// States at equal parts of the period for multiple shooting; empty: simulated from `state`.
  std::vector<dynamics::State> nodes = {};
};

/// One periodic orbit of a skeleton.
struct SkeletonOrbit {
  PeriodicOrbit orbit;
  Eigen::Index length = 0;      ///< passages of the section per period: slips of the section contact on a belt
  std::size_t candidate = 0;    ///< the first candidate that led here
  int hits = 0;                 ///< candidates that led here
  Eigen::MatrixXd points = {};  ///< (q; q̇) at its passages, lifted [2n x length]
  Eigen::MatrixXd path = {};    ///< (q; q̇) at `samples` equal parts of each interval between passages, from the first
  Eigen::VectorXd intervals = {};  ///< time from each passage to the next [length, s]
  /// Share of the attractor's samples within `radius` of the path.
  double share = 0.0;
  /// Largest distance of a passage of the orbit to the nearest of the attractor's, in its metric: how far it is off.
  double off_attractor = 0.0;
};

/// A candidate that became no orbit.
struct Refusal {
  std::size_t candidate = 0;
  std::string reason;
};

struct SkeletonOptions {
  ReturnOptions returns = {.max_length = 12, .threshold = 0.5, .per_length = 16, .apart = 0.5};
  /// Of multiple shooting, all candidates: tolerance, iterations, flow. Period, order, segments are set for each.
  ShootingOptions shooting = {.tolerance = 5e-11};
  /// Passages per shooting segment, ≥ 1. Few are needed where multipliers are large; elsewhere long segments converge
  /// from further away.
  Eigen::Index passages_per_segment = 12;
  /// Orbits whose passages are nearer than this, in the attractor's metric, are one orbit, > 0.
  double same = 1e-6;
  double radius = 0.4;  ///< of SkeletonOrbit::share, in the attractor's metric, > 0
  int samples = 64;     ///< of the path between passages, ≥ 1
  ParallelOptions parallel = {};
};

/// The periodic orbits an attractor is strung on.
struct Skeleton {
  std::vector<SkeletonOrbit> orbits;  ///< by period, then by leading multiplier
  std::vector<Candidate> candidates;  ///< close returns first, then those handed in
  std::vector<Refusal> refusals;      ///< by candidate
  double radius = 0.0;                ///< SkeletonOptions::radius
  bool interrupted = false;           ///< not every candidate was tried
};

/// Candidates from close returns of the attractor's passages, nearest first within each length.
[[nodiscard]] std::vector<Candidate> close_return_candidates(const Attractor& attractor, const ReturnOptions& options);

/// Refines close returns of an attractor to true periodic orbits, stable or not, by multiple shooting.
///
/// A multiple of a shorter orbit is recognised and replaced by that orbit; orbits found twice, up to phase, are listed
/// once. Candidates are refined side by side; the result does not depend on the number of threads.
/// @param more  candidates beside the close returns, as transferred_candidates gives them
/// @throws InvalidInput  for options out of range, an attractor of another system
/// Source: S4 section 3.5.4, whose approximate orbits are the candidates here.
[[nodiscard]] Skeleton find_skeleton(const dynamics::HybridSystem& system, const Attractor& attractor,
                                     const SkeletonOptions& options, const std::vector<Candidate>& more = {});

/// A skeleton with the orbits that further candidates lead to; those known keep their place by period.
/// @param known  of the same system and attractor, found with the same radius and number of samples
/// @throws InvalidInput  as find_skeleton
[[nodiscard]] Skeleton extended_skeleton(const dynamics::HybridSystem& system, const Attractor& attractor,
                                         Skeleton known, const SkeletonOptions& options,
                                         const std::vector<Candidate>& more);

}  // namespace slipmode::orbits
