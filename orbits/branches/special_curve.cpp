#include <slipmode/orbits/branches/special_curve.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/branches/internal/balance_branch_solver.hpp"
#include "orbits/branches/internal/branch_solver.hpp"
#include "orbits/branches/internal/branch_walk.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::orbits {
namespace {

/// Folds and losses of symmetry may end on a grazing, which they near as a square root does: steps below this, of which
/// there would be thousands, lead nowhere else.
constexpr double kLeastCurveStep = 1e-6;

void check_special(const SpecialPoint& special, const KeyRange& over) {
  const std::string what = fmt::format("the {} at {:.9g}", to_string(special.kind), special.parameter);
  if (!can_be_followed(special.kind))
    throw InvalidInput(what +
                       ": followed over two keys are folds, period doublings, symmetry breakings, Neimark-Sacker "
                       "points and grazings");
  if (!special.balance && special.orbit.monodromy.size() == 0)
    throw InvalidInput(what + ": no orbit with monodromy comes with it");
  const auto [low, high] = std::minmax(over.from, over.to);
  if (!(special.parameter >= low && special.parameter <= high))
    throw InvalidInput(fmt::format("{} is outside its range {} … {}", what, over.from, over.to));
  if (special.kind == SpecialKind::kSymmetryBreaking && !special.orbit.symmetric)
    throw InvalidInput(what + ": the symmetric orbit beside it was not found; start from the symmetric branch");
  const bool shifts =
      special.kind == SpecialKind::kSymmetryBreaking ? special.orbit.crossings == 0 : !special.orbit.symmetric;
  const bool family = special.balance ? special.balance->family : special.orbit.family.cols() > 0;
  if (family && shifts)
    throw InvalidInput(what + " belongs to a family of orbits, of which none is told from the others");
}

/// From its special point both ways.
template <class Solver>
Branch walk_curve(const Solver& solver, const SpecialPoint& special, double along, const ContinuationOptions& options) {
  const BranchPoint first{
      .parameter = along, .orbit = special.orbit, .balance = special.balance, .other = special.parameter};
  const std::string met = solver.curve_end(solver.evaluate(solver.unknowns_of(first)), special.orbit);
  if (!met.empty())
    throw InvalidInput(fmt::format("the {} at {:.9g}: {}", to_string(special.kind), special.parameter, met));
  return walk_branch(solver, options, first);
}

}  // namespace

bool can_be_followed(SpecialKind kind) {
  switch (kind) {
    case SpecialKind::kFold:
    case SpecialKind::kSymmetryBreaking:
    case SpecialKind::kPeriodDoubling:
    case SpecialKind::kNeimarkSacker:
    case SpecialKind::kGrazing:
    case SpecialKind::kNonSmoothFold:
      return true;
    case SpecialKind::kStickChange:
    case SpecialKind::kWordChange:
    case SpecialKind::kHopf:
    case SpecialKind::kCusp:
      return false;
  }
  return false;
}

Branch continue_special(const dynamics::PlaneFamily& family, const SpecialPoint& special, double along,
                        const KeyRange& over, const ContinuationOptions& options) {
  check_continuation(along, options);
  check_special(special, over);
  ContinuationOptions own = options;
  own.both_ways = true;
  own.arclength = true;
  own.min_step = std::max(own.min_step, kLeastCurveStep);
  own.shooting.half_period = special.orbit.symmetric;
  if (special.balance) return walk_curve(BalanceBranchSolver(family, special, along, over, own), special, along, own);
  return walk_curve(BranchSolver(family, special, along, over, own), special, along, own);
}

}  // namespace slipmode::orbits
