#include <slipmode/orbits/shooting.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/internal/descent.hpp"
#include "orbits/internal/describe_orbit.hpp"
#include "orbits/internal/shooting_problem.hpp"

#include <fmt/format.h>
#include <cmath>
#include <limits>
#include <optional>

namespace slipmode::orbits {
namespace {

using dynamics::State;

void require(bool condition, const std::string& message) {
  if (!condition) throw InvalidInput(message);
}

/// The period to begin with. Checks what the options say about it.
double period_of(const dynamics::HybridSystem& system, const ShootingOptions& options) {
  require(options.order >= 1, fmt::format("the order of an orbit must be at least 1, not {}", options.order));
  if (const auto drive_period = system.drive().period()) {
    const double period = options.order * *drive_period;
    require(
        options.period == 0.0 || std::abs(options.period - period) <= 1e-9 * period,
        fmt::format("a driven orbit's period is order × the drive's, {} × {:.10g} s; {:.10g} s was given. Leave the "
                    "period out, or choose another order",
                    options.order, *drive_period, options.period));
    return period;
  }
  require(system.drive().is_constant(),
          "a periodic orbit needs a drive that is periodic (shaker, force) or constant (belt without a ramp)");
  require(options.period > 0 && std::isfinite(options.period),
          fmt::format("a self-excited orbit needs a guess of its period > 0 s, not {}; `recurrence_guess` finds one",
                      options.period));
  return options.period;
}

void check(const dynamics::HybridSystem& system, const State& guess, const ShootingOptions& options) {
  require(options.segments >= 1, fmt::format("segments must be at least 1, not {}", options.segments));
  require(options.tolerance > 0, "the tolerance of shooting must be positive");
  require(options.max_iterations >= 1, "max_iterations must be at least 1");
  require(guess.q.size() == system.size() && guess.v.size() == system.size(),
          fmt::format("the guess has {} displacements and {} velocities; the system has {} degrees of freedom",
                      guess.q.size(), guess.v.size(), system.size()));
  require(
      options.segment_guesses.empty() || options.segment_guesses.size() == static_cast<std::size_t>(options.segments),
      fmt::format("{} segment guesses were given for {} segments", options.segment_guesses.size(), options.segments));
  if (!options.half_period) return;
  require(is_symmetric(system),
          "a symmetric orbit (half_period) needs a system that is its own mirror image: no constant load or offset, "
          "contacts that press equally to both sides, odd harmonics only");
  require(
      system.drive().period().has_value() && options.order % 2 == 1,
      fmt::format("a symmetric orbit (half_period) needs a periodic drive and an odd order, not {}", options.order));
}

/// Shooting as `descend` solves it: closing conditions and, where the period is unknown, the phase.
class Closing {
 public:
  using Point = ShootingPoint;
  using Evaluation = ShootingEvaluation;

  Closing(ShootingProblem& problem, double first_period) : problem_(problem), first_period_(first_period) {}

  [[nodiscard]] ShootingEvaluation evaluate(const ShootingPoint& point) { return problem_.evaluate(point); }

  [[nodiscard]] NewtonSystem linearised(const ShootingEvaluation& at) {
    columns_.clear();
    if (problem_.period_unknown()) columns_ = problem_.period_columns(at);
    const CondensedShooting condensed = problem_.condense(at, columns_);
    const Eigen::Index n = condensed.rest.size(), extra = condensed.columns.cols();
    NewtonSystem out{Eigen::MatrixXd::Zero(n + extra, n + extra), Eigen::VectorXd::Zero(n + extra)};
    out.J.topLeftCorner(n, n) = condensed.matrix;
    out.J.topRightCorner(n, extra) = condensed.columns;
    out.r.head(n) = condensed.rest;
    if (extra > 0) out.J.row(n).head(n) = at.rate.back().transpose().normalized();
    return out;
  }

  [[nodiscard]] std::optional<ShootingPoint> moved(const ShootingEvaluation& at, const Eigen::VectorXd& step,
                                                   double share) const {
    const Eigen::Index n = problem_.scale().size();
    ShootingPoint trial = problem_.moved(at, step.head(n), columns_, step.tail(step.size() - n), share);
    if (trial.period > 0.05 * first_period_ && trial.period < 20.0 * first_period_) return trial;
    return std::nullopt;
  }

 private:
  ShootingProblem& problem_;
  double first_period_;
  std::vector<Eigen::MatrixXd> columns_;
};

using ShootingDescent = Descent<ShootingEvaluation>;

ShootingDescent descend(ShootingProblem& problem, const ShootingPoint& from, const ShootingOptions& options) {
  Closing closing(problem, from.period);
  ShootingDescent d = descend(closing, from, options.tolerance, options.max_iterations);
  if (!d.begun) d.best.point = from;
  return d;
}

/// Everything is at rest at the converged point: an equilibrium, a solution for any period.
bool is_equilibrium(const ShootingProblem& problem, const ShootingEvaluation& at) {
  if (!problem.period_unknown()) return false;
  double fastest = 0.0;
  for (const Eigen::MatrixXd& rate : problem.period_columns(at)) fastest = std::max(fastest, rate.norm());
  return fastest < 1e-6;
}

std::string advice(const ShootingDescent& d, const ShootingOptions& options) {
  const std::string where =
      fmt::format("residual {:.2e} after {} Newton steps (from {:.2e}, asked {:.0e})", d.best.largest, d.iterations,
                  d.residuals.empty() ? NAN : d.residuals.front(), options.tolerance);
  switch (d.status) {
    case ShootingStatus::kConverged:
      return {};
    case ShootingStatus::kSingular:
      return fmt::format(
          "no orbit found: {}; the closing conditions are singular there (smallest singular value {:.1e} of the "
          "largest), as at a fold or where a symmetric orbit loses its symmetry. Try the half period of a symmetric "
          "orbit (--symmetric), another parameter, or continuation past the fold",
          where, d.smallest_singular);
    case ShootingStatus::kStalled:
      if (d.best.largest < 1e-8)
        return fmt::format(
            "no orbit found to the tolerance asked: {}; an orbit that stretches deviations as much as this one leaves "
            "more "
            "than that of rounding. Use more segments, or a larger tolerance",
            where);
      return fmt::format(
          "no orbit found: {}; no shorter step lowers it. Simulate longer before shooting, use more segments, another "
          "order or period, or see whether a contact only grazes",
          where);
    case ShootingStatus::kIterations:
      return fmt::format(
          "no orbit found: {}; it was still falling. Allow more iterations (--iterations, max_iterations), or start "
          "nearer",
          where);
    case ShootingStatus::kFlowFailed:
      return "no orbit found: the flow failed from the guess: " + d.failure;
    case ShootingStatus::kPeriodLost:
      return fmt::format("no orbit found: {}; the search ended at an equilibrium. Start from a simulated oscillation",
                         where);
  }
  return {};
}

ShootingResult unconverged(const ShootingProblem& problem, const ShootingDescent& d, const ShootingOptions& options) {
  ShootingResult result;
  result.status = d.status;
  result.message = advice(d, options);
  result.orbit.start = d.best.point.nodes[0];
  result.orbit.period = d.best.point.period;
  result.orbit.kind = problem.kind();
  result.orbit.order = options.order;
  result.orbit.residual = d.best.largest;
  result.orbit.residuals = d.residuals;
  result.orbit.iterations = d.iterations;
  return result;
}

/// The point with its origin `shift` later on the same trajectory.
ShootingPoint shifted(const ShootingProblem& problem, ShootingPoint point, double shift) {
  for (State& node : point.nodes) node = advanced(problem.system(), runnable(problem.system(), node), shift);
  return point;
}

/// How far the origin is to be moved: off guards when driven, to the middle of the longest stretch when self-excited.
double wanted_shift(const ShootingProblem& problem, const ShootingEvaluation& at) {
  const double start = at.point.nodes[0].time, covered = problem.covered() * at.point.period;
  if (problem.period_unknown()) return middle_of_longest_stretch(start, covered, at.events);
  const bool near = distance_to_events(start, covered, at.events) < 1e-6 * at.point.period;
  return near ? middle_of_longest_stretch(start, covered, at.events) : 0.0;
}

}  // namespace

const char* to_string(ShootingStatus status) {
  switch (status) {
    case ShootingStatus::kConverged:
      return "converged";
    case ShootingStatus::kSingular:
      return "singular";
    case ShootingStatus::kStalled:
      return "stalled";
    case ShootingStatus::kIterations:
      return "iterations";
    case ShootingStatus::kFlowFailed:
      return "flow failed";
    case ShootingStatus::kPeriodLost:
      return "equilibrium";
  }
  return "unknown";
}

ShootingResult shoot(const dynamics::HybridSystem& system, const State& guess, const ShootingOptions& options) {
  check(system, guess, options);
  const double period = period_of(system, options);
  const OrbitKind kind = system.drive().period() ? OrbitKind::kDriven : OrbitKind::kSelfExcited;
  State start = options.segment_guesses.empty() ? guess : options.segment_guesses.front();
  if (start.internal.size() != system.internal_size()) start = advanced(system, start, 0.0);

  ShootingProblem problem(system, options, kind);
  ShootingPoint point = problem.initial_point(start, period);
  if (kind == OrbitKind::kSelfExcited) {  // a phase between events is worth one pass
    try {
      const ShootingEvaluation first = problem.evaluate(point);
      point = shifted(problem, std::move(point), wanted_shift(problem, first));
    } catch (const NumericalFailure&) {  // met again, and reported, by the search
    }
  }
  ShootingDescent d = descend(problem, point, options);
  int iterations = d.iterations;
  std::vector<double> residuals = d.residuals;
  for (int turn = 0; turn < 2 && d.begun; ++turn) {
    // A start on a guard spoils the derivative, so the search is taken up again a little later on the trajectory; a
    // self-excited orbit gets its origin from its events.
    const double shift = wanted_shift(problem, d.best);
    if (!(std::abs(shift) > 1e-9 * d.best.point.period)) break;
    d = descend(problem, shifted(problem, d.best.point, shift), options);
    iterations += d.iterations;
    residuals.insert(residuals.end(), d.residuals.begin() + 1, d.residuals.end());
  }
  d.iterations = iterations;
  d.residuals = std::move(residuals);
  const bool searched_in_vain = d.status == ShootingStatus::kStalled || d.status == ShootingStatus::kIterations;
  if (searched_in_vain && d.smallest_singular < 1e-5) d.status = ShootingStatus::kSingular;
  if (d.begun && is_equilibrium(problem, d.best)) d.status = ShootingStatus::kPeriodLost;
  if (d.status != ShootingStatus::kConverged) return unconverged(problem, d, options);
  ShootingResult result;
  result.orbit = describe_orbit(problem, d.best, options);
  if (kind == OrbitKind::kSelfExcited && result.orbit.repeats > 1) {
    ShootingOptions shorter = options;
    shorter.period = result.orbit.period / result.orbit.repeats;
    shorter.segment_guesses.clear();
    return shoot(system, result.orbit.start, shorter);
  }
  result.orbit.iterations = d.iterations;
  result.orbit.residuals = std::move(d.residuals);
  return result;
}

PeriodicOrbit find_orbit(const dynamics::HybridSystem& system, const State& guess, const ShootingOptions& options) {
  ShootingResult result = shoot(system, guess, options);
  if (!result.converged())
    throw NumericalFailure(result.message, result.orbit.start.time, stacked(result.orbit.start), result.orbit.residual);
  return std::move(result.orbit);
}

}  // namespace slipmode::orbits
