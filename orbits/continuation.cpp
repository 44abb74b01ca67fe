#include <slipmode/orbits/continuation.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/internal/branch_solver.hpp"
#include "orbits/internal/branch_walk.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

void check(const PeriodicOrbit& orbit, double parameter, const ContinuationOptions& options) {
  const double low = std::min(options.from, options.to), high = std::max(options.from, options.to);
  if (!(high > low && std::isfinite(high) && std::isfinite(low)))
    throw InvalidInput(fmt::format("the range of a continuation needs two different finite ends, not {} and {}",
                                   options.from, options.to));
  if (!(parameter >= low && parameter <= high))
    throw InvalidInput(
        fmt::format("the continuation starts at {}, outside its range {} … {}", parameter, options.from, options.to));
  if (!(options.step > 0 && options.min_step > 0 && options.max_step >= options.min_step && options.max_points >= 1))
    throw InvalidInput("continuation steps must be positive, max_step ≥ min_step, max_points ≥ 1");
  if (orbit.monodromy.size() == 0)
    throw InvalidInput("continuation starts from an orbit that was found, with monodromy");
}

/// The second way's points behind the first's start, in order along the branch.
Branch joined(Branch backward, Branch forward) {
  Branch out;
  const std::size_t count = backward.points.size();
  const double whole = count > 0 ? backward.points.back().arclength : 0.0;
  for (std::size_t k = count; k-- > 1;) {
    out.points.push_back(std::move(backward.points[k]));
    out.points.back().arclength = whole - out.points.back().arclength;
  }
  for (std::size_t k = backward.special.size(); k-- > 0;) {
    out.special.push_back(std::move(backward.special[k]));
    out.special.back().before = count - 2 - std::min(out.special.back().before, count - 2);
  }
  const std::size_t offset = out.points.size();
  for (BranchPoint& point : forward.points) {
    point.arclength += whole;
    out.points.push_back(std::move(point));
  }
  for (SpecialPoint& special : forward.special) {
    special.before += offset;
    out.special.push_back(std::move(special));
  }
  out.end = forward.end;
  out.reason = "one way: " + backward.reason + "; other way: " + forward.reason;
  return out;
}

}  // namespace

const char* to_string(SpecialKind kind) {
  switch (kind) {
    case SpecialKind::kFold:
      return "fold";
    case SpecialKind::kSymmetryBreaking:
      return "symmetry breaking";
    case SpecialKind::kPeriodDoubling:
      return "period doubling";
    case SpecialKind::kNeimarkSacker:
      return "Neimark-Sacker";
    case SpecialKind::kGrazing:
      return "grazing";
    case SpecialKind::kStickChange:
      return "stick gained or lost";
    case SpecialKind::kWordChange:
      return "word change";
    case SpecialKind::kNonSmoothFold:
      return "non-smooth fold";
  }
  return "unknown";
}

const char* to_string(BranchEnd end) {
  switch (end) {
    case BranchEnd::kRange:
      return "range";
    case BranchEnd::kMaxPoints:
      return "points";
    case BranchEnd::kMerged:
      return "merged";
    case BranchEnd::kClosed:
      return "closed";
    case BranchEnd::kLost:
      return "lost";
  }
  return "unknown";
}

Branch continue_orbit(const dynamics::SystemFamily& family, const PeriodicOrbit& orbit, double parameter,
                      const ContinuationOptions& options) {
  check(orbit, parameter, options);
  ContinuationOptions own = options;
  own.shooting.half_period = orbit.symmetric;  // regular where the symmetry breaks
  const BranchSolver solver(family, orbit, parameter, own);
  const int direction = options.direction < 0 ? -1 : 1;
  Branch first = walk_branch(solver, own, orbit, parameter, direction);
  if (!options.both_ways) return first;
  return joined(walk_branch(solver, own, orbit, parameter, -direction), std::move(first));
}

}  // namespace slipmode::orbits
