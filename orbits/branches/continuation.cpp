#include <slipmode/orbits/branches/continuation.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/branches/internal/branch_solver.hpp"
#include "orbits/branches/internal/branch_walk.hpp"

namespace slipmode::orbits {

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
    case SpecialKind::kHopf:
      return "Hopf";
    case SpecialKind::kCusp:
      return "cusp";
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
    case BranchEnd::kInterrupted:
      return "interrupted";
  }
  return "unknown";
}

Branch continue_orbit(const dynamics::SystemFamily& family, const PeriodicOrbit& orbit, double parameter,
                      const ContinuationOptions& options) {
  check_continuation(parameter, options);
  if (orbit.monodromy.size() == 0)
    throw InvalidInput("continuation starts from an orbit that was found, with monodromy");
  ContinuationOptions own = options;
  own.shooting.half_period = false;
  const PeriodicOrbit first =
      orbit.family.cols() > 0 ? BranchSolver(family, orbit, parameter, own).in_the_middle(orbit, parameter) : orbit;
  own.shooting.half_period = first.symmetric;  // regular where the symmetry breaks
  return walk_branch(BranchSolver(family, first, parameter, own), own, {parameter, first});
}

}  // namespace slipmode::orbits
