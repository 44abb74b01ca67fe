#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/branches/continuation.hpp>
#include "orbits/branches/internal/branch_solver.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::orbits {
namespace {

constexpr int kHalvings = 8;

/// The orbit a distance off the special one along its critical direction, at whatever parameter it closes.
std::optional<BranchPoint> orbit_beside(const BranchSolver& solver, const PeriodicOrbit& base, double parameter,
                                        const Eigen::VectorXd& direction, double distance) {
  BranchUnknowns guess = solver.unknowns_of(base, parameter);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(solver.parameter_row().size());
  row.head(direction.size()) = direction.cwiseQuotient(solver.scale());
  row.normalize();
  const BranchEvaluation at = solver.evaluate(guess);
  guess = solver.moved(at, distance * row, 0.0);
  const auto corrected = solver.correct(guess, row);
  if (!corrected) return std::nullopt;
  return BranchPoint{corrected->at.at.parameter, solver.describe(corrected->at), 0.0};
}

}  // namespace

std::vector<BranchPoint> switch_branch(const dynamics::SystemFamily& family, const SpecialPoint& special,
                                       const ContinuationOptions& options, double distance) {
  const bool doubling = special.kind == SpecialKind::kPeriodDoubling;
  if (!doubling && special.kind != SpecialKind::kSymmetryBreaking)
    throw InvalidInput(fmt::format("branches are switched at a symmetry breaking or a period doubling, not at a {}",
                                   to_string(special.kind)));
  if (special.parameter < std::min(options.from, options.to) || special.parameter > std::max(options.from, options.to))
    throw InvalidInput(fmt::format("the {} at {:.9g} is outside the range {} … {}", to_string(special.kind),
                                   special.parameter, options.from, options.to));
  PeriodicOrbit base = special.orbit;
  ContinuationOptions own = options;
  own.shooting.half_period = false;
  if (doubling) {
    base.period *= 2.0;
    if (base.kind == OrbitKind::kDriven) base.order *= 2;
  }
  const BranchSolver solver(family, base, special.parameter, own);
  const bool both = !doubling;  // the mirror image; the other side of a doubling is the same orbit half a period on
  for (int k = 0; k < kHalvings; ++k, distance *= 0.5) {
    std::vector<BranchPoint> found;
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && !both) break;
      auto beside = orbit_beside(solver, base, special.parameter, side * special.direction, distance);
      const bool left =
          beside && (doubling ? beside->orbit.repeats == 1 || beside->orbit.kind == OrbitKind::kSelfExcited
                              : !beside->orbit.symmetric);
      if (left) found.push_back(std::move(*beside));
    }
    if (found.size() == (both ? 2u : 1u)) return found;
  }
  throw NumericalFailure(
      fmt::format("no orbit was found beside the {} at parameter {:.9g}, down to {:.1e} of the orbit's size; the new "
                  "branch may leave more steeply, or the point not be a true one",
                  to_string(special.kind), special.parameter, distance),
      special.orbit.start.time, stacked(special.orbit.start), distance);
}

}  // namespace slipmode::orbits
