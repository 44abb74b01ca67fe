#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/shooting.hpp>
#include "orbits/internal/shooting_problem.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::orbits {

/// The least-squares system of one Newton step, scaled: ‖J d + r‖ → min.
struct NewtonSystem {
  Eigen::MatrixXd J;
  Eigen::VectorXd r;
};

/// How Newton's method went.
template <class Evaluation>
struct Descent {
  Evaluation best = {};
  bool begun = false;  ///< `best` is an evaluation
  std::vector<double> residuals = {};
  int iterations = 0;
  double smallest_singular = 1.0;  ///< over the largest, at the best point
  ShootingStatus status = ShootingStatus::kConverged;
  std::string failure = {};  ///< of the flow
};

/// Damped Newton from a point: steps within a trust region, in units of the motion's size, kept only when they lower
/// the residual.
/// @tparam Problem  Point; Evaluation with `norm` and `largest` residual; evaluate(point), linearised(evaluation),
///                  moved(evaluation, step, share of the residual the step closes) or nothing where that may not be
/// @throws InvalidInput  as evaluate(from)
template <class Problem>
Descent<typename Problem::Evaluation> descend(Problem& problem, const typename Problem::Point& from, double tolerance,
                                              int max_iterations) {
  using Evaluation = typename Problem::Evaluation;
  Descent<Evaluation> d;
  const auto try_evaluate = [&](const typename Problem::Point& point) -> std::optional<Evaluation> {
    try {
      return problem.evaluate(point);
    } catch (const NumericalFailure& failure) {
      d.failure = failure.what();
    } catch (const InvalidInput& refused) {
      if (!d.begun) throw;  // the caller's guess or system
      d.failure = refused.what();
    }
    return std::nullopt;
  };
  if (auto first = try_evaluate(from)) {
    d.best = std::move(*first);
    d.begun = true;
  } else {
    d.status = ShootingStatus::kFlowFailed;
    return d;
  }
  d.residuals = {d.best.largest};
  double radius = 1.0;
  while (d.best.largest > tolerance) {
    if (d.iterations == max_iterations) {
      d.status = ShootingStatus::kIterations;
      return d;
    }
    const NewtonSystem& system = problem.linearised(d.best);
    std::optional<Evaluation> accepted;
    while (!accepted) {
      const BoundedLeastSquares solved = bounded_least_squares(system.J, system.r, radius);
      d.smallest_singular = solved.smallest;
      const double length = solved.step.norm();
      const double norm = system.r.norm();
      const double share = norm > 0 ? 1.0 - solved.predicted / norm : 1.0;
      if (const auto trial = problem.moved(d.best, solved.step, share)) accepted = try_evaluate(*trial);
      if (accepted && accepted->norm <= (1.0 - 1e-4 * share) * d.best.norm && accepted->norm < d.best.norm) {
        if (length > 0.5 * radius || radius < 1.0) radius = std::max(radius, 2.0 * length);
        break;
      }
      accepted.reset();
      radius = 0.25 * std::min(radius, length);
      if (radius < 1e-13 || !(length > 0)) {
        d.status = ShootingStatus::kStalled;
        return d;
      }
    }
    d.best = std::move(*accepted);
    d.residuals.push_back(d.best.largest);
    ++d.iterations;
  }
  return d;
}

}  // namespace slipmode::orbits
