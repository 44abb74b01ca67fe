// What BranchSolver does on curves of special points.
#include "orbits/branches/internal/branch_solver.hpp"

#include <slipmode/core/decompositions.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

/// A stop met more slowly than this, of the top speed, has multipliers go like a square root that no difference
/// follows.
constexpr double kSlowTouch = 5e-4;
/// A self-excited orbit whose path is this short, in units of its size with its steady part, is all but at rest.
constexpr double kAtRest = 1e-3;
/// Share of a touch's depth that a difference may change.
constexpr double kOfTouch = 0.02;

}  // namespace

void BranchSolver::add_condition(BranchEvaluation& out) const {
  const auto condition = condition_near(out);
  out.condition = condition(out);
  double h = condition_step(out.J.leftCols(scale_.size()));
  // A touch of scaled speed v goes about v²/2 deep: differences are to keep it.
  const double touch = slowest_touch(out.shooting.events) / scale_[out.problem->system().size()];
  if (condition_->kind != SpecialKind::kGrazing) h = std::min(h, kOfTouch * touch * touch);
  const Eigen::RowVectorXd row =
      condition_row(out.J, out.r, out.condition, h, [&](const Eigen::VectorXd& step) -> std::optional<double> {
        const BranchUnknowns beside = moved(out, step, 0.0);
        if (!in_range(beside)) return std::nullopt;
        BranchEvaluation there = closing(beside, false);
        return condition(there);
      });
  append(row, out.condition, out.J, out.r);
}

std::function<double(BranchEvaluation&)> BranchSolver::condition_near(const BranchEvaluation& at) const {
  const SpecialKind kind = condition_->kind;
  const Eigen::Index n = scale_.size();
  const bool halves = half_period();
  if (kind == SpecialKind::kGrazing)
    return [this](BranchEvaluation& there) {
      const Touch touch = touch_near(*there.problem, there.at.point, *condition_, there.at.touch);
      there.at.touch = touch.share;
      return touch.clearance / scale_[0] - kUntouched;
    };
  if (kind == SpecialKind::kNeimarkSacker)
    return [n, halves, pair = critical_pair(multipliers_of(at.J, n, halves), {})](const BranchEvaluation& there) {
      return critical_pair(multipliers_of(there.J, n, halves), pair).product - 1.0;
    };
  return [kind, n, halves, least = least_singular_value_near(critical_matrix(kind, at.J, n, halves))](
             const BranchEvaluation& there) { return least(critical_matrix(kind, there.J, n, halves)); };
}

std::string BranchSolver::curve_end(const BranchEvaluation& at, const PeriodicOrbit& orbit) const {
  if (!on_curve()) return {};
  if (period_unknown() && at.problem->period_columns(at.shooting).front().norm() < kAtRest)
    return "the orbit shrinks to a state of rest: a Hopf point, where orbits begin";
  if (condition_->kind == SpecialKind::kGrazing) return {};
  if (condition_->kind == SpecialKind::kNeimarkSacker) {
    std::string met = resonance_met(critical_pair(multipliers_of(at.J, scale_.size(), half_period()), {}));
    if (!met.empty()) return met;
  }
  const double touch = slowest_touch(orbit.events) / scale_[orbit.start.q.size()];
  if (touch < kSlowTouch)
    return fmt::format("a stop is met at {:.1e} of the top speed: the curve joins one of grazings", touch);
  return {};
}

std::optional<PeriodicOrbit> BranchSolver::orbit_ahead(const BranchEvaluation& at, const Eigen::VectorXd& way) const {
  BranchUnknowns guess = moved(at, way, 0.0);
  if (!on_curve() || !in_range(guess)) return std::nullopt;
  const BranchSolver plain(family_, describe(at), guess.parameter, guess.other, options_, std::nullopt);
  const std::optional<Corrected> closed = plain.correct(guess, plain.parameter_row());
  if (!closed) return std::nullopt;
  return plain.describe(closed->at);
}

}  // namespace slipmode::orbits
