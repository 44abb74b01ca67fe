// What BalanceBranchSolver does on curves of special points.
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/balance/hill.hpp>
#include "orbits/balance/internal/trigonometric.hpp"
#include "orbits/branches/internal/balance_branch_solver.hpp"
#include "orbits/branches/internal/balance_touch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

/// Where a contact turns back before a stop, all of them.
std::vector<Touch> touches(const Harmonics& displacement, double gap, int side) {
  const TrigonometricPolynomial y = polynomial_of(displacement), slope = derivative(y);
  std::vector<Touch> out;
  for (const double theta : zeros(slope))
    if (side * slope.at(theta).slope < 0.0)
      out.push_back({gap - side * y.at(theta).y, theta / (2.0 * std::numbers::pi)});
  return out;
}

}  // namespace

CurveCondition grazed(const dynamics::HybridSystem& system, const Balance& balance, const CurveCondition& like) {
  double size = 0.0;
  for (const Harmonics& y : balance.displacement) size = std::max(size, y.amplitude().sum());
  return nearest_touch(system.contacts().size(), size, like, [&](std::size_t c, int side) {
    const std::optional<double> gap = gap_towards(system.contacts()[c], side);
    return gap ? touches(balance.displacement[c], *gap, side) : std::vector<Touch>{};
  });
}

Touch touch_near(const dynamics::HybridSystem& system, const Balance& balance, const CurveCondition& condition,
                 double share) {
  const double gap = *gap_towards(system.contacts()[condition.contact], condition.side);
  const std::vector<Touch> all = touches(balance.displacement[condition.contact], gap, condition.side);
  if (all.empty()) throw NumericalFailure("the contact that grazes its stop does not move any more", 0.0, {}, 0.0);
  return *std::ranges::min_element(all, {}, [&](const Touch& touch) { return shares_apart(touch.share, share); });
}

void BalanceBranchSolver::add_condition(BalanceBranchEvaluation& out) const {
  const auto condition = condition_near(out);
  const double here = condition(out);
  const double h = condition_step(out.J.leftCols(std::ssize(solved_)));
  const Eigen::RowVectorXd row =
      condition_row(out.J, out.r, here, h, [&](const Eigen::VectorXd& step) -> std::optional<double> {
        const BalanceUnknowns beside = moved(out, step, 0.0);
        if (!in_range(beside)) return std::nullopt;
        BalanceBranchEvaluation there = balanced(beside, false);
        return condition(there);
      });
  append(row, here, out.J, out.r);
}

std::function<double(BalanceBranchEvaluation&)> BalanceBranchSolver::condition_near(
    const BalanceBranchEvaluation& at) const {
  switch (condition_->kind) {
    case SpecialKind::kGrazing:
      return [this](BalanceBranchEvaluation& there) {
        const Touch touch = touch_near(there.own->system, *balance_of(there), *condition_, there.at.touch);
        there.at.touch = touch.share;
        return touch.clearance / size_ - kUntouched;
      };
    case SpecialKind::kNeimarkSacker:
      return [this, pair = critical_pair(multipliers_at(at), {})](const BalanceBranchEvaluation& there) {
        return critical_pair(multipliers_at(there), pair).product - 1.0;
      };
    case SpecialKind::kPeriodDoubling:
      return
          [this](const BalanceBranchEvaluation& there) { return (1.0 + multipliers_at(there).array()).prod().real(); };
    case SpecialKind::kSymmetryBreaking:
      return [this, least = least_singular_value_near(even_block(at))](const BalanceBranchEvaluation& there) {
        return least(even_block(there));
      };
    default:  // folds: check_special lets no other pass
      return [least = least_singular_value_near(at.J.leftCols(at.J.rows()))](const BalanceBranchEvaluation& there) {
        return least(there.J.leftCols(there.J.rows()));
      };
  }
}

Eigen::MatrixXd BalanceBranchSolver::even_block(const BalanceBranchEvaluation& at) const {
  return scaled_block(at.balance.jacobian, even_);
}

Eigen::VectorXcd BalanceBranchSolver::multipliers_at(const BalanceBranchEvaluation& at) const {
  return hill_multipliers(at.own->system, *balance_of(at), {.half_period = symmetric_});
}

std::string BalanceBranchSolver::curve_end(const BalanceBranchEvaluation& /*at*/, const PeriodicOrbit& orbit) const {
  if (!on_curve() || condition_->kind != SpecialKind::kNeimarkSacker) return {};
  const MultiplierPair pair = critical_pair(symmetric_ ? orbit.half_multipliers : orbit.multipliers, {});
  if (!pair.complex()) return resonance_met(pair);
  if (symmetric_ || 0.5 * pair.sum > std::cos(0.99 * kHillsBand * std::numbers::pi)) return {};
  return "the pair of multipliers nears -1, a strong resonance, where truncation no longer tells one from the other: "
         "follow it further by shooting";
}

}  // namespace slipmode::orbits
