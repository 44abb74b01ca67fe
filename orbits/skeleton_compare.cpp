#include <slipmode/orbits/skeleton_compare.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace slipmode::orbits {

namespace {

double log_ratio(double reduced, double full) {
  if (reduced == full) return 0.0;
  return std::log(reduced) - std::log(full);
}

}  // namespace

double shape_difference(const SkeletonOrbit& full, const SkeletonOrbit& reduced, const Metric& metric) {
  const Eigen::MatrixXd a = metric.scaled(full.path);
  const Eigen::MatrixXd b = metric.scaled(reduced.path);
  if (a.cols() != b.cols() || full.length != reduced.length || full.length < 1) {
    throw InvalidInput(
        fmt::format("shape difference: expected orbits of one length and sampling, found {} passages "
                    "and {} points against {} and {}",
                    full.length, a.cols(), reduced.length, b.cols()));
  }
  const Eigen::Index step = a.cols() / full.length;
  double smallest = std::numeric_limits<double>::infinity();
  for (Eigen::Index shift = 0; shift < a.cols(); shift += step) {
    const Eigen::Index tail = a.cols() - shift;
    smallest = std::min(smallest, (a.leftCols(tail) - b.rightCols(tail)).squaredNorm() +
                                      (a.rightCols(shift) - b.leftCols(shift)).squaredNorm());
  }
  const double size = (a.colwise() - a.rowwise().mean()).squaredNorm();
  return std::sqrt(smallest / size);
}

SkeletonComparison compare_skeletons(const Skeleton& full, const Skeleton& reduced, const Metric& metric,
                                     const SkeletonCompareOptions& options) {
  if (!(options.max_shape > 0.0) || !(options.max_period > 0.0)) {
    throw InvalidInput(fmt::format("skeleton comparison: expected max_shape > 0 and max_period > 0, found {} and {}",
                                   options.max_shape, options.max_period));
  }
  std::vector<OrbitMatch> pairs;
  for (std::size_t f = 0; f < full.orbits.size(); ++f) {
    for (std::size_t r = 0; r < reduced.orbits.size(); ++r) {
      const SkeletonOrbit& a = full.orbits[f];
      const SkeletonOrbit& b = reduced.orbits[r];
      const double period = (b.orbit.period - a.orbit.period) / a.orbit.period;
      if (a.length != b.length || a.orbit.word != b.orbit.word || std::abs(period) > options.max_period) continue;
      const double shape = shape_difference(a, b, metric);
      if (shape > options.max_shape) continue;
      pairs.push_back({.full = f,
                       .reduced = r,
                       .period = period,
                       .log_multiplier = log_ratio(b.orbit.leading_modulus, a.orbit.leading_modulus),
                       .shape = shape,
                       .share = b.share - a.share});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const OrbitMatch& a, const OrbitMatch& b) {
    return std::tie(a.shape, a.full, a.reduced) < std::tie(b.shape, b.full, b.reduced);
  });
  SkeletonComparison comparison;
  std::vector<char> full_taken(full.orbits.size(), 0), reduced_taken(reduced.orbits.size(), 0);
  for (const OrbitMatch& pair : pairs) {
    if (full_taken[pair.full] != 0 || reduced_taken[pair.reduced] != 0) continue;
    full_taken[pair.full] = reduced_taken[pair.reduced] = 1;
    comparison.matched.push_back(pair);
  }
  std::sort(comparison.matched.begin(), comparison.matched.end(),
            [](const OrbitMatch& a, const OrbitMatch& b) { return a.full < b.full; });
  for (std::size_t f = 0; f < full_taken.size(); ++f) {
    if (full_taken[f] == 0) comparison.missed.push_back(f);
  }
  for (std::size_t r = 0; r < reduced_taken.size(); ++r) {
    if (reduced_taken[r] == 0) comparison.extra.push_back(r);
  }
  return comparison;
}

std::vector<Candidate> transferred_candidates(const dynamics::HybridSystem& from, const Skeleton& skeleton,
                                              const std::function<dynamics::State(const dynamics::State&)>& map,
                                              Eigen::Index passages_per_segment) {
  if (passages_per_segment < 1) {
    throw InvalidInput(
        fmt::format("transferred candidates: expected passages_per_segment >= 1, found {}", passages_per_segment));
  }
  std::vector<Candidate> candidates;
  for (std::size_t k = 0; k < skeleton.orbits.size(); ++k) {
    const SkeletonOrbit& member = skeleton.orbits[k];
    const auto segments = static_cast<int>((member.length + passages_per_segment - 1) / passages_per_segment);
    Candidate candidate{.period = member.orbit.period,
                        .length = member.length,
                        .origin = fmt::format("orbit {} of the other model", k + 1)};
    for (const dynamics::State& node : sample_orbit(from, member.orbit, segments)) {
      candidate.nodes.push_back(map(node));
    }
    candidate.state = candidate.nodes.front();
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

}  // namespace slipmode::orbits
