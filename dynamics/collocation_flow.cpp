#include "dynamics/collocation_flow.hpp"

#include "core/errors.hpp"
#include "core/v8.hpp"
#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// A step that ends at its last node gains from the Radau nodes' superconvergence; one that ends inside does not.
constexpr double kEndNodeGain = 3e-2;
/// The step is doubled when the error of the doubled one, eighth order, is foreseen to pass with this margin.
constexpr double kGrowth = 1.0 / (256.0 * 8.0);
/// Largest product of the law's slope, the mobility and the step that is tried.
constexpr double kLargestGrowth = 1.2;
/// An event's time is final when the next correction is below this share of the step.
constexpr double kNegligibleShift = 1e-15;
/// A stick force starts at its limit when it is this close (relative).
constexpr double kAtLimit = 1e-10;
/// Right after sliding has begun, a guard that vanishes within this share of a step is an error of interpolation.
constexpr double kEarly = 1.0 / 64.0;
/// Halvings tried to show that a stick force stays below its limit.
constexpr int kHalvings = 2;
/// Shifts below this share of the step are made by two terms of Taylor's series.
constexpr double kShortShift = 1e-7;
/// A step spans at most this phase of a shaker, so that all quadratures resolve it.
constexpr double kLargestDrivePhase = 2.0;
constexpr int kRefinements = 20;

/// How many times to halve a step whose eighth-order error is too large by this factor: at least once.
int halvings(double excess) {
  int exponent = 0;
  std::frexp(excess, &exponent);
  return std::clamp(1 + exponent / kNodes, 1, 4);
}

/// Level of the largest step over which the polynomial of degree 7 through the nodes follows the drive's velocity to
/// within `tolerance` of its amplitude: |V − p| ≤ (ωh/2)⁸ / (2⁷ 8!).
int coarsest_level(const friction::Drive& drive, const StepTables& tables, double tolerance) {
  if (drive.shaker() == nullptr) return 0;
  const double phase = std::min(kLargestDrivePhase, 2.0 * std::pow(tolerance * 128.0 * 40320.0, 1.0 / kNodes));
  int level = 0;
  while (level + 1 < StepTables::kLevels && tables.step(level) * drive.shaker()->omega() > phase) ++level;
  return level;
}

}  // namespace

CollocationFlow::CollocationFlow(const HybridSystem& system, const StepTables& tables, HybridPoint start,
                                 const FlowOptions& options)
    : tables_(tables),
      model_(tables.model()),
      resolver_(system, model_, options),
      options_(options),
      nc_(model_.contacts),
      begin_(start.time),
      point_(std::move(start)),
      x_begin_(point_.x),
      coarsest_(coarsest_level(system.drive(), tables, options.tolerance)),
      newton_change_(std::min(1e-3, std::sqrt(kNewtonShare * options.tolerance))),
      start_level_(static_cast<std::size_t>(nc_) + 1, std::max(3, coarsest_)) {
  for (auto* v : {&free_, &velocity_, &forces_, &drive_nodes_, &bristle_nodes_})
    *v = Eigen::VectorXd::Zero(kNodes * nc_);
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  for (std::size_t c = 0; c < laws().size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    steep_speed_.push_back(
        std::log(laws()[c].alpha * laws()[c].drop * model_.mobility(i, i) * tables_.step(0) / kLargestGrowth) /
        laws()[c].alpha);
  }
  for (int c = 0; c < nc_; ++c) {
    any_bristle_ |= bristled(c);
    bristle_at_.push_back(system.internal_begin(c));
  }
  if (any_bristle_ && point_.internal.size() == 0) point_.internal = Eigen::VectorXd::Zero(system.internal_size());
  internal_begin_ = point_.internal;
  if (any_bristle_) start_bristles();
  resolver_.start(point_);
  if (any_bristle_) refresh_bristles();
  restart_steps();
}

CollocationFlow::Guarded CollocationFlow::first_guard() const {
  Guarded first{2.0, -1, false};
  const auto consider = [&](const V8& b, double start, int degree, int c, int multiplicity) {
    BernsteinPolynomial p;
    p.degree = degree;
    alignas(64) double lanes[kNodes];
    store8(lanes, b);
    if (degree == kNodes) {
      p.coefficient[0] = start;
      std::copy_n(lanes, kNodes, p.coefficient.begin() + 1);
      for (int k = 0; k < multiplicity; ++k) p.coefficient[static_cast<std::size_t>(k)] = 0.0;
    } else {
      std::copy_n(lanes, kNodes, p.coefficient.begin());
    }
    if (const auto root = first_root(p); root && root->at < first.theta) first = {root->at, c, root->touching};
  };
  const RadauTables& t = nodes_;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = laws()[i];
    if (!law.sticks() && !bristled(c)) continue;
    if (point_.modes[i] == ContactMode::kStick) {
      const V8 b = matrix8_times(t.bernstein7.data(), forces_.data() + kNodes * c);
      for (const double sign : {1.0, -1.0}) {
        V8 margin = law.static_limit - sign * b;
        if (std::abs(margin[0]) <= kAtLimit * law.static_limit) margin[0] = 0.0;  // on the guard: where to, shows next
        if (!stays_above(margin, 0.0, kHalvings)) consider(margin, 0.0, kNodes - 1, c, 0);
      }
      continue;
    }
    const double sign = sign_of(point_.modes[i]);
    alignas(64) double speed[kNodes];
    store8(speed, sign * (load8(drive_nodes_.data() + kNodes * c) - load8(velocity_.data() + kNodes * c)));
    const int multiplicity = point_.multiplicity[i];
    if ((multiplicity > 0 || bristled(c)) && unmoved(c)) continue;
    const double start =
        multiplicity > 0
            ? 0.0
            : std::max(0.0, sign * (drive().velocity(begin_) - resolver_.contact_velocity(c, x_begin_.data())));
    V8 b = matrix8_times(t.bernstein8.data(), speed) + start * load8(t.bernstein8_start.data());
    if (multiplicity == 2)
      b[0] = std::numeric_limits<double>::max();  // zero by the order of contact, whatever rounding says
    if (min8(b) > 0.0) continue;
    consider(b, start, kNodes, c, multiplicity);
  }
  return first;
}

bool CollocationFlow::unmoved(int c) const {
  // So soon after its start that sliding has no speed beyond rounding, and its sign means nothing.
  const V8 speed = load8(drive_nodes_.data() + kNodes * c) - load8(velocity_.data() + kNodes * c);
  return std::max(max8(speed), -min8(speed)) <= kUnmoved * velocity_scale(c, x_begin_);
}

double CollocationFlow::velocity_scale(int c, const Eigen::VectorXd& x) const {
  // Rounding of the time changes V; and where a bristle comes to rest, speeds are what forces in balance leave.
  const double by_time = std::abs(drive().acceleration(begin_) * begin_);
  const double by_way =
      bristled(c) ? model_.fastest * model_.displacement_row.col(c).cwiseAbs().dot(x.cwiseAbs()) : 0.0;
  return std::abs(drive().velocity(begin_)) + by_time + by_way +
         model_.velocity_row.col(c).cwiseAbs().dot(x.cwiseAbs());
}

bool CollocationFlow::too_early(const Guarded& guard) const {
  return guard.contact >= 0 && point_.multiplicity[static_cast<std::size_t>(guard.contact)] > 0 && guard.theta < kEarly;
}

double CollocationFlow::deepest_overshoot() const {
  double deepest = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws()[i].kind != ContactForces::Kind::kStribeck || point_.modes[i] == ContactMode::kStick) continue;
    const V8 speed =
        sign_of(point_.modes[i]) * (load8(drive_nodes_.data() + kNodes * c) - load8(velocity_.data() + kNodes * c));
    deepest = std::max(deepest, -laws()[i].alpha * min8(speed));
  }
  return deepest;
}

bool CollocationFlow::step(double t_limit) {
  resolver_.clear();
  events_.clear();
  begin_ = point_.time;
  x_begin_.swap(point_.x);
  internal_begin_ = point_.internal;
  step_modes_ = point_.modes;
  double limit = t_limit;
  bool corner = false;
  if (!drive().is_constant()) {
    if (const auto t = drive().next_corner(begin_); t && *t <= limit) {
      limit = *t;
      corner = true;
    }
  }
  const double remaining = limit - begin_;

  int level = foreseen_level(std::max(level_, coarsest_));
  while (level + 1 < StepTables::kLevels && tables_.step(level + 1) >= remaining) ++level;
  Guarded guard;
  double h = 0.0, tau = 0.0, error = 0.0, tolerance = 0.0;
  for (bool retry = false;; retry = true, ++statistics_.rejected) {
    if (level >= StepTables::kLevels)
      throw NumericalFailure(
          "the contact forces could not be resolved by any step size at t = " + std::to_string(begin_), begin_,
          x_begin_, error);
    h = tables_.step(level);
    const Collocation& table = tables_.collocation(level);
    free_velocities(table);
    guess_forces(level, retry);
    solved_ = solve_forces(table, h);
    step_level_ = level;
    if (any_bristle_ && solved_ && turn_resting_bristles()) solved_ = solve_forces(table, h);
    if (!solved_) {
      ++level;
      continue;
    }
    error = force_error() * h / tables_.step(0);
    const bool smallest = level + 1 == StepTables::kLevels;
    if (!(error <= options_.tolerance / kEndNodeGain) && !smallest) {
      level += halvings(error * kEndNodeGain / options_.tolerance);
      continue;
    }
    guard = first_guard();
    tau = std::min(guard.contact >= 0 ? guard.theta * h : h, remaining);
    tolerance = options_.tolerance * (tau < h ? 1.0 : 1.0 / kEndNodeGain);
    if (!(error <= tolerance) && !smallest) {
      level += halvings(error / tolerance);
      continue;
    }
    if (too_early(guard) && !smallest) {
      ++level;
      continue;
    }
    if (guard.contact >= 0 && deepest_overshoot() > kLargestOvershoot) {
      do ++level;
      while (tables_.step(level + 1) > guard.theta * h);
      continue;
    }
    break;
  }
  const bool at_guard = guard.contact >= 0 && guard.theta * h <= remaining;

  if (tau < h) {
    advance_within(tables_, x_begin_.data(), forces_.data(), level, tau, point_.x.data());
    if (at_guard)
      refine_event(guard, tau, point_.x);
    else
      resolver_.hold(begin_ + tau, point_.modes, point_.x.data());  // between nodes a stick is only nearly held
  } else {
    propagate(tables_.propagator(level), x_begin_.data(), forces_.data(), nc_, model_.np, point_.x.data());
  }
  point_.time = tau == remaining ? limit : begin_ + tau;
  // A shaker's velocity feels the rounding of the time.
  if (tau == h && drive().shaker() != nullptr) resolver_.hold(point_.time, point_.modes, point_.x.data());
  ++statistics_.steps;
  if (!std::isfinite(point_.x(0)) || !std::isfinite(point_.time))
    throw NumericalFailure("the state is no longer finite at t = " + std::to_string(begin_), begin_, x_begin_, error);
  for (int c = 0; c < nc_; ++c)
    if (point_.modes[static_cast<std::size_t>(c)] == ContactMode::kStick)
      statistics_.stick_time[static_cast<std::size_t>(c)] += tau;
  if (options_.audit) account(level, tau);
  if (tangents_.size() > 0) push_tangents(level, tau);

  level_ = error < tolerance * kGrowth && level > coarsest_ ? level - 1 : level;
  solved_ = tau == h;
  if (fresh_) {
    start_level_[stuck_count()] = level_;
    if (nc_ == 1 && point_.modes[0] != ContactMode::kStick && !bristled(0) && point_.force(0) != 0.0) {
      first_level_ = level;
      first_shape_ = forces_ / point_.force(0);
    }
  }
  fresh_ = false;
  std::fill(point_.multiplicity.begin(), point_.multiplicity.end(), 0);
  const RadauTables::Vector8 last = nodes_.lagrange(tau / h);
  for (int c = 0; c < nc_; ++c)
    point_.force(c) = tau < h ? forces_.segment<kNodes>(kNodes * c).dot(last) : forces_(kNodes * c + kNodes - 1);
  if (any_bristle_) {
    for (int c = 0; c < nc_; ++c)  // as long as its speed is rounding, a bristle's direction means nothing
      if (bristled(c) && unmoved(c)) point_.multiplicity[static_cast<std::size_t>(c)] = 2;
    point_.internal = internal_within(tau / h);
    bristle_force_at(point_.time, point_.modes, point_.x.data(), point_.internal, point_.force);
  }
  if (!at_guard && !(corner && point_.time == limit)) return false;

  const int contact = at_guard ? guard.contact : -1;
  const Eigen::VectorXd force_before = tangents_.size() > 0 ? point_.force : Eigen::VectorXd();
  if (at_guard && bristled(contact)) {
    settle_bristle(contact, guard.touching);
  } else {
    resolver_.settle(point_, contact, guard.touching);
    events_ = resolver_.events();
    if (any_bristle_) refresh_bristles();
  }
  statistics_.events += static_cast<std::int64_t>(events_.size());
  if (!guard.touching) {
    restart_steps();
    if (tangents_.size() > 0) salt_tangents(force_before, contact);
  }
  return true;
}

void CollocationFlow::refine_event(const Guarded& guard, double& tau, Eigen::VectorXd& x) const {
  // Newton on the guard's exact value; the polynomial that announced it was only close.
  if (guard.touching) return;
  const double h = tables_.step(step_level_);
  const int c = guard.contact;
  const auto i = static_cast<std::size_t>(c);
  double previous = 0.0;
  for (int iteration = 0; iteration < kRefinements; ++iteration) {
    const double a = drive_acceleration(begin_, tau), V = drive_velocity(begin_, tau);
    const RadauTables::Vector8 basis = nodes_.lagrange(tau / h);
    double value, rate, usual_rate;
    if (point_.modes[i] == ContactMode::kStick) {
      const double sign = forces_.segment<kNodes>(kNodes * c).dot(basis) > 0 ? 1.0 : -1.0;
      value = laws()[i].static_limit - sign * stick_force(c, x, tau, basis);
      rate = -sign * forces_.segment<kNodes>(kNodes * c).dot(nodes_.lagrange_slope(tau / h)) / h;
      usual_rate = laws()[i].static_limit / h;
    } else {
      const double sign = sign_of(point_.modes[i]);
      value = sign * (V - resolver_.contact_velocity(c, x.data()));
      double acceleration =
          dot_padded(model_.acceleration_row.col(c).data(), x.data(), 2 * model_.np) + model_.load_acceleration(c);
      for (int d = 0; d < nc_; ++d)
        acceleration += model_.mobility(c, d) * forces_.segment<kNodes>(kNodes * d).dot(basis);
      rate = sign * (a - acceleration);
      usual_rate = model_.mobility(c, c) * laws()[i].static_limit;
    }
    const double shift = -value / rate;
    if (!(std::abs(shift) < 1e-2 * h) || tau + shift <= 0.0) return;
    tau += shift;
    if (std::abs(shift) <= kNegligibleShift * h) return;
    if (std::abs(shift) < kShortShift * h)
      nudge(basis, shift, x);
    else
      advance_within(tables_, x_begin_.data(), forces_.data(), step_level_, tau, x.data());
    // Newton squares its error; the factor shows in two shifts, and before that is bounded by a usual curvature.
    const double factor = previous > 0.0 ? std::abs(shift) / (previous * previous) : std::abs(usual_rate / rate) / h;
    if (factor * shift * shift <= kNegligibleShift * h) return;
    previous = std::abs(shift);
  }
}

void CollocationFlow::nudge(const RadauTables::Vector8& basis, double shift, Eigen::VectorXd& x) const {
  // Two terms of Taylor's series: the third is below rounding for so short a shift.
  const ModalModel& m = model_;
  const auto np = m.np;
  for (Eigen::Index i = 0; i < np; i += kLanes) {
    const V8 g11 = load8(m.g11.data() + i), g12 = load8(m.g12.data() + i);
    const V8 g21 = load8(m.g21.data() + i), g22 = load8(m.g22.data() + i);
    const V8 x1 = load8(x.data() + i), x2 = load8(x.data() + np + i);
    V8 rate1 = g11 * x1 + g12 * x2 + load8(m.load.data() + i);
    V8 rate2 = g21 * x1 + g22 * x2 + load8(m.load.data() + np + i);
    for (int c = 0; c < nc_; ++c) {
      const double force = forces_.segment<kNodes>(kNodes * c).dot(basis);
      rate1 += load8(m.input.col(c).data() + i) * force;
      rate2 += load8(m.input.col(c).data() + np + i) * force;
    }
    const double half = shift * shift / 2.0;
    store8(x.data() + i, x1 + rate1 * shift + (g11 * rate1 + g12 * rate2) * half);
    store8(x.data() + np + i, x2 + rate2 * shift + (g21 * rate1 + g22 * rate2) * half);
  }
}

double CollocationFlow::stick_force(int c, const Eigen::VectorXd& x, double tau,
                                    const RadauTables::Vector8& basis) const {
  const double a = drive_acceleration(begin_, tau);
  if (nc_ == 1)
    return (a - dot_padded(model_.acceleration_row.data(), x.data(), 2 * model_.np) - model_.load_acceleration(0)) /
           model_.mobility(0, 0);
  Eigen::VectorXd force(nc_);
  std::vector<bool> stuck(point_.modes.size());
  for (int d = 0; d < nc_; ++d) {
    stuck[static_cast<std::size_t>(d)] = point_.modes[static_cast<std::size_t>(d)] == ContactMode::kStick;
    force(d) = forces_.segment<kNodes>(kNodes * d).dot(basis);
  }
  stick_forces({model_, laws(), x.data(), begin_ + tau, drive_velocity(begin_, tau), a}, stuck, force);
  return force(c);
}

void CollocationFlow::account(int level, double tau) {
  if (tau >= tables_.step(level))
    return account_whole(level, x_begin_.data(), forces_.data(), velocity_.data(), begin_);
  double t = begin_;
  Eigen::VectorXd x = x_begin_, next(x.size()), velocity(kNodes * nc_);
  walk_pieces(
      tables_, forces_.data(), level, tau,
      [&](int piece, const double* forces) {
        const Collocation& table = tables_.collocation(piece);
        velocity.noalias() = table.kernel * Eigen::Map<const Eigen::VectorXd>(forces, kNodes * nc_);
        for (int c = 0; c < nc_; ++c)
          velocity.segment<kNodes>(kNodes * c) +=
              table.free.middleCols(2 * model_.np * c, 2 * model_.np) * x + table.load.col(c);
        account_whole(piece, x.data(), forces, velocity.data(), t);
        propagate(tables_.propagator(piece), x.data(), forces, nc_, model_.np, next.data());
        x.swap(next);
        t += tables_.step(piece);
      },
      [&](int piece, const double* forces, double rest) { account_rest(piece, x.data(), forces, t, rest); });
}

void CollocationFlow::account_whole(int level, const double* x, const double* forces, const double* velocities,
                                    double begin) {
  const double length = tables_.step(level);
  const RadauTables::Vector8 drive_speed = drive_velocities(begin, length);
  double contact = 0.0, driven = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const Eigen::Map<const RadauTables::Vector8> force(forces + kNodes * c), speed(velocities + kNodes * c);
    const RadauTables::Vector8 weighted = length * nodes_.weight.cwiseProduct(force);
    contact += weighted.dot(speed);
    driven += weighted.dot(drive_speed);
  }
  work_.add(contact, driven, viscous_loss(tables_, level, x, forces));
}

void CollocationFlow::account_rest(int level, const double* x, const double* forces, double begin, double rest) {
  // Five points suffice for what a Taylor series covers.
  static const GaussRule rule = gauss_rule(5);
  Eigen::VectorXd at(x_begin_.size());
  double contact = 0.0, driven = 0.0, viscous = 0.0;
  for (Eigen::Index k = 0; k < rule.node.size(); ++k) {
    const double tau = rule.node(k) * rest, weight = rule.weight(k) * rest, t = begin + tau;
    advance_within(tables_, x, forces, level, tau, at.data());
    const RadauTables::Vector8 basis = nodes_.lagrange(tau / tables_.step(level));
    for (int c = 0; c < nc_; ++c) {
      const double force = Eigen::Map<const RadauTables::Vector8>(forces + kNodes * c).dot(basis);
      contact += weight * force * resolver_.contact_velocity(c, at.data());
      driven += weight * force * drive().velocity(t);
    }
    viscous += weight * model_.viscous_power(at);
  }
  work_.add(contact, driven, viscous);
}

double CollocationFlow::drive_velocity(double begin, double tau) const {
  const double V = drive().velocity(begin), a = drive().acceleration(begin);
  if (drive().shaker() == nullptr) return V + a * tau;
  // From the phase at the beginning: begin + tau would round the time, and make a staircase of a short step.
  const double omega = drive().shaker()->omega();
  return V * std::cos(omega * tau) + a / omega * std::sin(omega * tau);
}

double CollocationFlow::drive_acceleration(double begin, double tau) const {
  return drive().acceleration(drive().shaker() != nullptr ? begin + tau : begin);
}

RadauTables::Vector8 CollocationFlow::drive_velocities(double begin, double h) const {
  const double V = drive().velocity(begin), a = drive().acceleration(begin);
  if (drive().shaker() == nullptr) return (V + a * h * nodes_.node.array()).matrix();
  const double omega = drive().shaker()->omega();
  const auto phase = (omega * h) * nodes_.node.array();
  return (V * phase.cos() + a / omega * phase.sin()).matrix();
}

void CollocationFlow::restart_steps() {
  level_ = start_level_[stuck_count()];
  solved_ = false;
  fresh_ = true;
}

std::size_t CollocationFlow::stuck_count() const {
  return static_cast<std::size_t>(std::count(point_.modes.begin(), point_.modes.end(), ContactMode::kStick));
}

void CollocationFlow::evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  const double h = tables_.step(step_level_), tau = std::clamp(t - begin_, 0.0, h);
  out_x.resize(2 * model_.np);
  advance_within(tables_, x_begin_.data(), forces_.data(), step_level_, tau, out_x.data());
  resolver_.hold(t, step_modes_, out_x.data());
  if (any_bristle_) {
    out_force.resize(nc_);
    bristle_force_at(t, step_modes_, out_x.data(), internal_within(tau / h), out_force);
  } else {
    out_force = resolver_.forces(t, step_modes_, out_x.data());
  }
}

}  // namespace slipmode::dynamics
