#include "orbits/branches/internal/branch_solver.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/orbits/gap_motion.hpp>
#include "orbits/internal/describe_orbit.hpp"

#include <fmt/format.h>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

namespace slipmode::orbits {
namespace {

constexpr int kMaxCorrections = 20;
constexpr double kTrustRadius = 0.2;  // in units of the orbit's size
/// What a pass leaves of a relative error, before Φ stretches it: a residual that stalls below this × ‖Φ‖ is zero.
constexpr double kRoundingOfPass = 1e-12;
/// Step of the difference in the parameter, of its range, where Φ stretches nothing. Second derivatives grow like ‖Φ‖²,
/// what rounding leaves like ‖Φ‖: the step is divided by √‖Φ‖.
constexpr double kDifferenceStep = 1e-6;

/// Springs' forces that reach this much further to one side, of their largest, need not be moved.
constexpr double kMiddle = 1e-6;
/// Stretches of springs below this share of a family's largest are rounding.
constexpr double kStretched = 1e-9;
/// Of an orbit, to tell how far forces reach: their largest values to 1e-4.
constexpr int kProbes = 256;

/// Middles of the ranges of rows.
Eigen::VectorXd middles(const Eigen::MatrixXd& values) {
  return 0.5 * (values.rowwise().maxCoeff() + values.rowwise().minCoeff());
}

/// What takes an orbit along its family to where the springs that never slide reach as far to either side, and beyond
/// that contacts move about zero; stacked. Empty where it is there, or no such spring makes the family.
Eigen::VectorXd way_to_middle(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit) {
  std::vector<Eigen::Index> held, own_states;
  for (Eigen::Index c = 0; c < std::ssize(system.contacts()); ++c) {
    const auto i = static_cast<std::size_t>(c);
    const bool moves = std::ranges::any_of(orbit.events, [&](const dynamics::Event& e) { return e.contact == c; });
    const bool springs = friction::spring_stiffness(system.contacts()[i].law) > 0.0;
    if (!springs || moves || orbit.start.modes[i] != dynamics::ContactMode::kStick) continue;
    held.push_back(c);
    own_states.push_back(2 * system.size() + system.internal_begin(static_cast<int>(c)));
  }
  if (held.empty()) return {};
  dynamics::SimulateOptions options{.duration = orbit.period, .sample = orbit.period / kProbes, .keep_events = false};
  options.output = dynamics::SimulateOptions::Output::kContacts;
  options.flow.audit = false;
  const dynamics::Trajectory run = dynamics::simulate(system, orbit.start, options);
  Eigen::MatrixXd stretch = run.lambda(held, Eigen::all), directions(system.size(), std::ssize(system.contacts()));
  for (Eigen::Index c = 0; c < directions.cols(); ++c)
    directions.col(c) = system.contacts()[static_cast<std::size_t>(c)].direction;
  for (Eigen::Index k = 0; k < stretch.rows(); ++k)
    stretch.row(k) /= friction::spring_stiffness(system.contacts()[static_cast<std::size_t>(held[k])].law);
  const Eigen::VectorXd off = middles(stretch), aside = middles(run.contact_q);
  if (off.cwiseAbs().maxCoeff() <= kMiddle * stretch.cwiseAbs().maxCoeff() &&
      aside.cwiseAbs().maxCoeff() <= kMiddle * run.contact_q.cwiseAbs().maxCoeff())
    return {};
  const Eigen::MatrixXd stretched = orbit.family(own_states, Eigen::all),
                        moved = directions.transpose() * orbit.family.topRows(system.size());
  // The family is found to rounding of the orbit: a structure that moves as a whole stretches springs by 1e-16 or so.
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(stretched, Eigen::ComputeThinU | Eigen::ComputeFullV);
  svd.setThreshold(kStretched);
  const Eigen::VectorXd shift = -svd.solve(off);
  const Eigen::MatrixXd open = svd.matrixV().rightCols(orbit.family.cols() - svd.rank());
  if (open.cols() == 0) return orbit.family * shift;
  const Eigen::MatrixXd rest = moved * open;
  return orbit.family * (shift - open * rest.completeOrthogonalDecomposition().solve(aside + moved * shift));
}

/// time / period without whole periods.
double share_of(double time, double period) { return time / period - std::floor(time / period); }

/// What takes an orbit that meets no stop, one of a family of shifts, to where stops leave most room; stacked. Aside, a
/// branch would creep along the stop that is met first. Empty where it is there, or there is no such family.
Eigen::VectorXd way_to_most_room(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit) {
  if (!orbit.events.empty()) return {};
  const std::optional<GapMotion> gap = GapMotion::of(system);
  if (!gap || gap->continuum() != GapMotion::Continuum::kShift || !(gap->room(gap->middle()).least > 0.0)) return {};
  const dynamics::State middle{.q = gap->middle().head(system.size()), .v = gap->middle().tail(system.size())};
  const double period = system.drive().period().value();
  const Eigen::VectorXd start = stacked(orbit.start);
  Eigen::VectorXd way = stacked(advanced(system, middle, period * share_of(orbit.start.time, period))) - start;
  if (way.norm() <= kMiddle * start.norm()) return {};
  return way;
}

}  // namespace

BranchSolver::BranchSolver(dynamics::SystemFamily family, const PeriodicOrbit& orbit, double parameter,
                           const ContinuationOptions& options)
    : BranchSolver([own = std::move(family)](double, double at) { return own(at); }, orbit, parameter, 0.0, options,
                   std::nullopt) {}

BranchSolver::BranchSolver(dynamics::PlaneFamily family, const SpecialPoint& special, double parameter,
                           const KeyRange& other, const ContinuationOptions& options)
    : BranchSolver(std::move(family), special.orbit, parameter, special.parameter, options,
                   condition_of(special, other)) {}

BranchSolver::BranchSolver(dynamics::PlaneFamily family, const PeriodicOrbit& orbit, double parameter, double other,
                           const ContinuationOptions& options, const std::optional<CurveCondition>& condition)
    : family_(std::move(family)),
      options_(options),
      kind_(orbit.kind),
      condition_(condition),
      range_(std::abs(options.to - options.from)) {
  options_.shooting.order = orbit.order;
  options_.shooting.segment_guesses.clear();
  const dynamics::HybridSystem system = family_(other, parameter);
  if (orbit.start.q.size() != system.size())
    throw InvalidInput(fmt::format("the orbit has {} displacements, the family's system {} degrees of freedom",
                                   orbit.start.q.size(), system.size()));
  const BranchUnknowns first = unknowns_of(orbit, parameter, other);
  ShootingProblem problem(system, options_.shooting, kind_);
  static_cast<void>(problem.evaluate(first.point));
  scale_ = problem.scale();
  if (condition_ && condition_->kind == SpecialKind::kGrazing) condition_ = grazed(problem, first.point, *condition_);
}

BranchUnknowns BranchSolver::unknowns_of(const PeriodicOrbit& orbit, double parameter, double other) const {
  BranchUnknowns out{{{orbit.start}, orbit.period}, parameter, 0.0, other};
  if (condition_) out.touch = condition_->touch;
  const dynamics::HybridSystem system = system_at(out);
  if (kind_ == OrbitKind::kDriven) out.phase = share_of(orbit.start.time, orbit.period / orbit.order);
  const double covered = options_.shooting.half_period ? 0.5 : 1.0;
  const double length = covered * orbit.period / options_.shooting.segments;
  for (int k = 1; k < options_.shooting.segments; ++k)
    out.point.nodes.push_back(advanced(system, out.point.nodes.back(), length));
  set_times(out, system);
  return out;
}

void BranchSolver::set_times(BranchUnknowns& at, const dynamics::HybridSystem& system) const {
  const auto drive_period = system.drive().period();
  if (!drive_period) return;
  at.point.period = options_.shooting.order * *drive_period;
  const double covered = options_.shooting.half_period ? 0.5 : 1.0;
  const double length = covered * at.point.period / static_cast<double>(at.point.nodes.size());
  for (std::size_t k = 0; k < at.point.nodes.size(); ++k)
    at.point.nodes[k].time = at.phase * *drive_period + length * static_cast<double>(k);
}

BranchEvaluation BranchSolver::evaluate(const BranchUnknowns& at) const {
  if (!in_range(at))
    throw NumericalFailure(fmt::format("the parameter {:.9g} is outside the range of the branch", at.parameter),
                           at.point.nodes[0].time, stacked(at.point.nodes[0]), 0.0);
  BranchEvaluation out = closing(at, true);
  if (condition_) add_condition(out);
  return out;
}

BranchEvaluation BranchSolver::closing(const BranchUnknowns& at, bool with_parameters) const {
  const dynamics::HybridSystem system = system_at(at);
  BranchEvaluation out{at, {}, std::make_shared<ShootingProblem>(system, options_.shooting, kind_), {}, {}, {}};
  set_times(out.at, system);
  out.problem->use_scale(scale_);
  for (dynamics::State& node : out.at.point.nodes) put_on_constraint(out.problem->system(), node);
  out.shooting = out.problem->evaluate(out.at.point);
  out.columns.assign(out.at.point.nodes.size(), Eigen::MatrixXd(scale_.size(), 0));
  const auto append = [&out](const auto& columns) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      Eigen::MatrixXd both(columns[k].rows(), out.columns[k].cols() + 1);
      both << out.columns[k], columns[k];
      out.columns[k] = std::move(both);
    }
  };
  if (period_unknown()) append(out.problem->period_columns(out.shooting));
  if (with_parameters)
    for (const BranchKey<BranchUnknowns>& key : keys()) append(parameter_columns(out.at, out.shooting, key));
  const CondensedShooting condensed = out.problem->condense(out.shooting, out.columns);
  const Eigen::Index n = scale_.size(), extra = condensed.columns.cols(), phase = period_unknown() ? 1 : 0;
  out.J = Eigen::MatrixXd::Zero(n + phase, n + extra);
  out.J.topLeftCorner(n, n) = condensed.matrix;
  out.J.topRightCorner(n, extra) = condensed.columns;
  if (phase > 0) out.J.row(n).head(n) = out.shooting.rate.back().transpose().normalized();
  out.r = Eigen::VectorXd::Zero(n + phase);
  out.r.head(n) = condensed.rest;
  return out;
}

std::vector<Eigen::VectorXd> BranchSolver::parameter_columns(const BranchUnknowns& at, const ShootingEvaluation& here,
                                                             const BranchKey<BranchUnknowns>& key) const {
  double stretch = 1.0;
  for (const Eigen::MatrixXd& transfer : here.transfer) stretch = std::max(stretch, transfer.norm());
  const double h = kDifferenceStep * key.range() / std::sqrt(stretch), own = at.*key.value;
  const bool grazes = condition_ && condition_->kind == SpecialKind::kGrazing;
  double cleared = 0.0;  // on the side of the last call
  const auto ends_at = [&](double value) {
    BranchUnknowns moved_to = at;
    moved_to.*key.value = value;
    const dynamics::HybridSystem system = system_at(moved_to);
    set_times(moved_to, system);
    ShootingProblem problem(system, options_.shooting, kind_);
    problem.use_scale(scale_);
    if (grazes) cleared = touch_near(problem, moved_to.point, *condition_, at.touch).clearance;
    return problem.ends_of(moved_to.point);
  };
  // At the ends of the range the family need not go further.
  const double high = std::min(own + h, key.high), low = std::max(own - h, key.low);
  const bool has_above = high - own > 0.1 * h, has_below = own - low > 0.1 * h;
  const ShootingProblem::Ends above = ends_at(high);
  const double cleared_above = cleared;
  const ShootingProblem::Ends below = ends_at(low);
  const bool clearer_above = cleared_above > cleared;
  const bool same_above = above.events == here.events.size(), same_below = below.events == here.events.size();
  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index k = 0; k < above.states.cols(); ++k) {
    const Eigen::VectorXd end = stacked(here.ends[static_cast<std::size_t>(k)]).cwiseQuotient(scale_);
    const Eigen::VectorXd up = (above.states.col(k) - end) * (key.range() / std::max(high - own, 1e-300));
    const Eigen::VectorXd down = (end - below.states.col(k)) * (key.range() / std::max(own - low, 1e-300));
    // Where an event comes or goes within the step one side is of another motion: the one with the events of this is
    // right; of a touch the clear one.
    const bool differs = same_above != same_below;
    const bool jumps = grazes || differs || (up - down).norm() > 0.1 * std::max(up.norm(), down.norm());
    const bool up_is_right = grazes ? clearer_above : differs ? same_above : up.norm() < down.norm();
    const bool take_up = !has_below || (has_above && jumps && up_is_right);
    const bool take_down = !has_above || (has_below && jumps && !take_up);
    columns.emplace_back(take_up ? up : take_down ? down : Eigen::VectorXd(0.5 * (up + down)));
  }
  return columns;
}

Eigen::VectorXd BranchSolver::tangent(const BranchEvaluation& at, const Eigen::VectorXd& along) const {
  // The smallest singular vectors span tangent and, where orbits come in families, the family too. Of these, the one
  // that changes the parameter is wanted; at a fold, where none does, the last direction decides.
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(at.J, Eigen::ComputeFullV);
  const Eigen::Index unknowns = at.J.cols(), rows = at.J.rows();
  const Eigen::VectorXd& sigma = svd.singularValues();
  Eigen::Index dimension = unknowns - rows;
  while (dimension < unknowns && sigma[unknowns - 1 - dimension] < 1e-9 * sigma[0]) ++dimension;
  const Eigen::MatrixXd null_space = svd.matrixV().rightCols(dimension);
  Eigen::VectorXd direction = null_space.col(dimension - 1);
  if (dimension > 1) {
    const Eigen::VectorXd towards = null_space * (null_space.transpose() * parameter_row());
    direction =
        towards.norm() > 1e-6 ? towards.normalized() : (null_space * (null_space.transpose() * along)).normalized();
  }
  return direction.dot(along) < 0 ? Eigen::VectorXd(-direction) : direction;
}

BranchUnknowns BranchSolver::moved(const BranchEvaluation& from, const Eigen::VectorXd& step, double share) const {
  const Eigen::Index n = scale_.size();
  BranchUnknowns out = from.at;
  out.point = from.problem->moved(from.shooting, step.head(n), from.columns, step.tail(step.size() - n), share);
  for (const BranchKey<BranchUnknowns>& key : keys()) out.*key.value += key.range() * key.row.dot(step);
  return out;
}

Eigen::VectorXd BranchSolver::newton_step(const BranchEvaluation& at, const BranchUnknowns& guess,
                                          const Eigen::VectorXd& row) const {
  Eigen::MatrixXd J(at.J.rows() + 1, at.J.cols());
  J << at.J, row.transpose();
  Eigen::VectorXd r(J.rows());
  r << at.r, row.dot(difference(at.at, guess));
  return bounded_least_squares(J, r, kTrustRadius).step;
}

BranchEvaluation BranchSolver::polished(BranchEvaluation at, const BranchUnknowns& guess,
                                        const Eigen::VectorXd& row) const {
  BranchEvaluation next = evaluate(moved(at, newton_step(at, guess, row), 1.0));
  if (next.norm() < at.norm()) at = std::move(next);
  return at;
}

std::optional<BranchEvaluation> BranchSolver::shortened(const BranchEvaluation& from,
                                                        const Eigen::VectorXd& step) const {
  constexpr int kShares = 5;
  for (int k = 0; k < kShares; ++k) {
    const double share = std::ldexp(1.0, -k);
    BranchEvaluation next = evaluate(moved(from, share * step, share));
    if (next.norm() <= (1.0 - 0.1 * share) * from.norm()) return next;
    const bool at_rounding = next.largest() <= kRoundingOfPass * std::max(1.0, next.J.norm());
    if (at_rounding) return next;
  }
  return std::nullopt;
}

std::optional<BranchSolver::Corrected> BranchSolver::correct(const BranchUnknowns& guess,
                                                             const Eigen::VectorXd& row) const {
  try {
    Corrected out{evaluate(guess), 0};
    while (out.at.largest() > options_.shooting.tolerance) {
      if (out.iterations++ == kMaxCorrections) return std::nullopt;
      std::optional<BranchEvaluation> next = shortened(out.at, newton_step(out.at, guess, row));
      if (!next) return std::nullopt;
      const bool stalls = next->norm() > 0.3 * out.at.norm();
      out.at = std::move(*next);
      if (stalls && out.at.largest() <= kRoundingOfPass * std::max(1.0, out.at.J.norm())) return out;
    }
    return out;
  } catch (const NumericalFailure&) {
    return std::nullopt;  // the flow failed on the way: a shorter step may not
  }
}

BranchEvaluation BranchSolver::shifted(const BranchEvaluation& at, double share) const {
  BranchUnknowns later = at.at;
  const dynamics::HybridSystem system = system_at(at.at);
  for (dynamics::State& node : later.point.nodes)
    node = advanced(system, runnable(system, node), share * at.at.point.period);
  if (kind_ == OrbitKind::kDriven) later.phase = share_of(later.phase + share * options_.shooting.order, 1.0);
  later.touch = share_of(later.touch - share, 1.0);
  return evaluate(later);
}

std::optional<BranchEvaluation> BranchSolver::middle_of_family(const BranchEvaluation& at,
                                                               const PeriodicOrbit& orbit) const {
  if (orbit.family.cols() == 0 || half_period() || on_curve()) return std::nullopt;
  Eigen::VectorXd way = way_to_middle(at.problem->system(), orbit);
  if (way.size() == 0) way = way_to_most_room(at.problem->system(), orbit);
  if (way.size() == 0) return std::nullopt;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(parameter_row().size());
  step.head(way.size()) = way.cwiseQuotient(scale_);
  std::optional<Corrected> middle = correct(moved(at, step, 0.0), parameter_row());
  if (!middle) return std::nullopt;
  return std::move(middle->at);
}

PeriodicOrbit BranchSolver::in_the_middle(const PeriodicOrbit& orbit, double parameter) const {
  const std::optional<Corrected> closed = correct(unknowns_of(orbit, parameter), parameter_row());
  if (!closed) return orbit;
  const std::optional<BranchEvaluation> middle = middle_of_family(closed->at, orbit);
  return middle ? describe(*middle) : orbit;
}

Eigen::VectorXd BranchSolver::difference(const BranchUnknowns& b, const BranchUnknowns& a) const {
  const Eigen::Index n = scale_.size();
  Eigen::VectorXd out(parameter_row().size());
  out.head(n) = (stacked(b.point.nodes[0]) - stacked(a.point.nodes[0])).cwiseQuotient(scale_);
  if (period_unknown()) out[n] = std::log(b.point.period / a.point.period);
  for (const BranchKey<BranchUnknowns>& key : keys())
    out[out.size() - (key.value == &BranchUnknowns::parameter ? 1 : 2)] = (b.*key.value - a.*key.value) / key.range();
  return out;
}

BranchSolver::Simpler BranchSolver::simpler_beside(SpecialKind kind, const BranchEvaluation& near,
                                                   const PeriodicOrbit& orbit, const Eigen::VectorXd& apart) const {
  const bool doubled = kind == SpecialKind::kPeriodDoubling;
  ContinuationOptions own = options_;
  own.shooting.half_period = !doubled;
  PeriodicOrbit simpler = orbit;
  if (doubled) {
    simpler.period *= 0.5;
    if (kind_ == OrbitKind::kDriven) simpler.order /= 2;
  }
  const double half = doubled ? 0.5 : -0.5;
  simpler.start.modes.clear();
  simpler.start = with_coordinates(simpler.start, stacked(simpler.start) + half * scale_.cwiseProduct(apart));
  BranchSolver solver(family_, simpler, near.at.parameter, near.at.other, own, std::nullopt);
  BranchUnknowns guess = solver.unknowns_of(simpler, near.at.parameter);
  return {std::move(solver), std::move(guess)};
}

Eigen::MatrixXd BranchSolver::half_map(const BranchEvaluation& at) const {
  if (!half_period()) return {};
  const Eigen::Index n = scale_.size();
  return scale_.asDiagonal() * (Eigen::MatrixXd::Identity(n, n) - at.J.topLeftCorner(n, n)) *
         scale_.cwiseInverse().asDiagonal();
}

Eigen::VectorXd BranchSolver::skew(const BranchEvaluation& at) const {
  const Eigen::VectorXd& half = at.shooting.half_state;
  if (half.size() == 0) return {};
  return half + at.problem->scaled(stacked(at.at.point.nodes[0]));
}

Eigen::VectorXd BranchSolver::halves_apart(const BranchEvaluation& at) const {
  const bool may_be_doubled = period_unknown() || options_.shooting.order % 2 == 0;
  if (!may_be_doubled || half_period() || on_curve()) return {};
  const dynamics::State& start = at.at.point.nodes[0];
  const dynamics::HybridSystem& system = at.problem->system();
  return at.problem->scaled(stacked(advanced(system, runnable(system, start), 0.5 * at.at.point.period)) -
                            stacked(start));
}

PeriodicOrbit BranchSolver::describe(const BranchEvaluation& at) const {
  return describe_orbit(*at.problem, at.shooting, options_.shooting);
}

Eigen::VectorXd BranchSolver::parameter_row() const {
  const Eigen::Index size = scale_.size() + (period_unknown() ? 2 : 1) + (on_curve() ? 1 : 0);
  return Eigen::VectorXd::Unit(size, size - 1);
}

std::vector<BranchKey<BranchUnknowns>> BranchSolver::keys() const {
  return branch_keys<BranchUnknowns>(options_, condition_, parameter_row());
}

}  // namespace slipmode::orbits
