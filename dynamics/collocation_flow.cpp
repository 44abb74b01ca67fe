#include "dynamics/collocation_flow.hpp"

#include "core/errors.hpp"
#include "core/v8.hpp"
#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::dynamics {
namespace {

/// A step that ends at its last node gains from the Radau nodes' superconvergence; one that ends inside does not.
constexpr double kEndNodeGain = 1e-3;
/// A trial step may follow the law past zero relative velocity this far (in units of 1/α): beyond, e^{−αv} runs away.
constexpr double kLargestOvershoot = 0.7;
/// The step is doubled when the error of the doubled one, eighth order, is foreseen to pass with this margin.
constexpr double kGrowth = 1.0 / (256.0 * 8.0);
/// Largest product of the law's slope, the mobility and the step that is tried.
constexpr double kLargestGrowth = 1.2;
/// An event's time is final when the next correction is below this share of the step.
constexpr double kNegligibleShift = 1e-15;
constexpr int kNewtonLimit = 12;
/// Newton stops at a change of this size (in units of the law's velocity scale): the next one would be its square.
constexpr double kNewtonChange = 2e-6;
/// Sliding slower than this share of the velocities at play is no sliding.
constexpr double kAtRest = 1e-13;

/// How many times to halve a step whose eighth-order error is too large by this factor: at least once.
int halvings(double excess) {
  int exponent = 0;
  std::frexp(excess, &exponent);
  return std::clamp(1 + exponent / kNodes, 1, 4);
}

double sign_of(ContactMode mode) { return static_cast<double>(static_cast<int>(mode)); }

}  // namespace

CollocationFlow::CollocationFlow(const HybridSystem& system, const StepTables& tables, Eigen::VectorXd x, double time,
                                 std::vector<ContactMode> modes, const FlowOptions& options, bool dense)
    : tables_(tables),
      model_(tables.model()),
      belt_(system.drive()),
      options_(options),
      dense_(dense),
      nc_(model_.contacts),
      time_(time),
      begin_(time),
      x_(std::move(x)),
      x_begin_(x_),
      x_end_(x_),
      modes_(std::move(modes)),
      multiplicity_(static_cast<std::size_t>(nc_), 0),
      force_now_(Eigen::VectorXd::Zero(nc_)),
      start_level_(static_cast<std::size_t>(nc_) + 1, 3) {
  for (const auto& contact : system.contacts()) laws_.push_back(contact_forces(contact));
  for (auto* v : {&free_, &velocity_, &forces_, &belt_nodes_, &slope_}) *v = Eigen::VectorXd::Zero(kNodes * nc_);
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    steep_speed_.push_back(
        std::log(laws_[c].alpha * laws_[c].drop * model_.mobility(i, i) * tables_.step(0) / kLargestGrowth) /
        laws_[c].alpha);
  }
  std::vector<bool> at_rest(static_cast<std::size_t>(nc_));
  for (std::size_t c = 0; c < at_rest.size(); ++c) at_rest[c] = modes_[c] == ContactMode::kStick;
  start_modes(resolve(instant(x_), modes_, at_rest, -1));
}

double CollocationFlow::contact_velocity(int c, const double* x) const {
  return dot_padded(model_.velocity_row.col(c).data(), x, 2 * model_.np);
}

Instant CollocationFlow::instant(const Eigen::VectorXd& x) const {
  return {model_, laws_, x.data(), time_, belt_.velocity(time_), belt_.acceleration(time_)};
}

void CollocationFlow::free_velocities(const Collocation& table) {
  for (int c = 0; c < nc_; ++c) {
    const double* free = table.free.data() + kNodes * 2 * model_.np * c;
    V8 sum = load8(table.load.data() + kNodes * c);
    sum += node_sums(free, x_begin_.data(), model_.n);
    sum += node_sums(free + kNodes * model_.np, x_begin_.data() + model_.np, model_.n);
    store8(free_.data() + kNodes * c, sum);
  }
}

void CollocationFlow::guess_forces(int level, bool retry) {
  // The last solution continued; a rejected step's own solution; or the force at the start.
  const RadauTables& t = nodes_;
  for (int c = 0; c < nc_; ++c) {
    double* forces = forces_.data() + kNodes * c;
    const RadauTables::Matrix8* matrix = nullptr;
    const int finer = level - step_level_ + 1;
    if (solved_ && retry && finer == 2) matrix = &t.left_half;
    if (solved_ && !retry && finer >= 0 && finer < static_cast<int>(t.following.size()))
      matrix = &t.following[static_cast<std::size_t>(finer)];
    store8(forces, matrix ? matrix8_times(matrix->data(), forces) : broadcast8(force_now_(c)));
  }
}

int CollocationFlow::foreseen_level(int level) const {
  // Sliding slows down ever faster where the law rises steeply: look ahead by a parabola through the last step's
  // velocities and keep α (μ_s − μ_k) N e^{−αv} × mobility × step within what eight nodes resolve. Solved for v once,
  // so that no exponential is needed here.
  if (!solved_) return level;
  const auto& node = nodes_.node;
  const double last_step = tables_.step(step_level_);
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = laws_[i];
    if (law.kind != ContactForces::Kind::kStribeck || modes_[i] == ContactMode::kStick) continue;
    const double sign = sign_of(modes_[i]);
    const auto speed = [&](int j) { return sign * (belt_nodes_(kNodes * c + j) - velocity_(kNodes * c + j)); };
    const double s1 = speed(2), s2 = speed(5), s3 = speed(7);
    const double d12 = (s2 - s1) / (node(5) - node(2)), d23 = (s3 - s2) / (node(7) - node(5));
    const double bend = (d23 - d12) / (node(7) - node(2)), slope = d23 + bend * (node(7) - node(5));
    for (; level + 1 < StepTables::kLevels; ++level) {
      const double ahead = tables_.step(level) / last_step;
      const double foreseen = std::max(0.0, s3 + ahead * (slope + bend * ahead));
      if (foreseen >= steep_speed_[i] - level * (std::numbers::ln2 / law.alpha)) break;
    }
  }
  return level;
}

bool CollocationFlow::solve_forces(const Collocation& table, double h) {
  const double V = belt_.velocity(begin_), a = belt_.acceleration(begin_);
  const V8 node = load8(nodes_.node.data());
  const V8 belt = broadcast8(V) + broadcast8(a * h) * node;
  for (int c = 0; c < nc_; ++c) store8(belt_nodes_.data() + kNodes * c, belt);
  if (nc_ != 1) return solve_coupled(table);

  double* forces = forces_.data();
  if (modes_[0] == ContactMode::kStick) {
    store8(free_.data(), belt - load8(free_.data()));
    store8(forces, matrix8_times(table.kernel_inverse.data(), free_.data()));
    store8(velocity_.data(), belt);
    return true;
  }
  if (laws_[0].is_constant()) {
    store8(forces, broadcast8(sign_of(modes_[0]) * laws_[0].kinetic));
    store8(velocity_.data(), load8(free_.data()) + matrix8_times(table.kernel.data(), forces));
    return true;
  }
  return solve_single_slip(table);
}

bool CollocationFlow::solve_single_slip(const Collocation& table) {
  const ContactForces& law = laws_[0];
  const V8 free = load8(free_.data()), belt = load8(belt_nodes_.data());
  const bool smooth = !law.sticks();
  const double sign = smooth ? 1.0 : sign_of(modes_[0]);
  const double velocity_scale = smooth ? law.epsilon : 1.0 / law.alpha;
  const V8 clip = broadcast8(-kLargestOvershoot * 2);

  alignas(64) double force[kNodes];
  V8 v = free + matrix8_times(table.kernel.data(), forces_.data());
  for (int iteration = 0; iteration < kNewtonLimit; ++iteration) {
    V8 lambda, slope;
    if (smooth) {
      alignas(64) double l[kNodes], d[kNodes], s[kNodes];
      store8(s, belt - v);
      for (int j = 0; j < kNodes; ++j) {
        l[j] = law.smooth(s[j], d[j]);
        d[j] = -d[j];
      }
      lambda = load8(l);
      slope = load8(d);
    } else {
      V8 scaled = law.alpha * sign * (belt - v);  // α times sliding speed
      const auto inside = scaled > clip;
      scaled = inside ? scaled : clip;
      const V8 e = law.drop * exp8(-scaled);
      lambda = sign * (law.kinetic + e);
      slope = inside ? law.alpha * e : V8{};
    }
    store8(force, lambda);
    const V8 residual = free + matrix8_times(table.kernel.data(), force) - v;
    V8 delta;
    if (!solve_newton(table.kernel.data(), slope, residual, delta)) return false;
    v += delta;
    const double change = std::max(max8(delta), -min8(delta));
    if (!(change < 1e12)) return false;
    if (change < kNewtonChange * velocity_scale || change < 1e-14) {
      store8(forces_.data(), lambda + slope * delta);
      store8(velocity_.data(), v);
      return true;
    }
  }
  return false;
}

bool CollocationFlow::solve_coupled(const Collocation& table) {
  const Eigen::Index size = kNodes * nc_;
  const auto block = [](auto& vector, int c) { return vector.template segment<kNodes>(kNodes * c); };
  std::vector<bool> stuck(static_cast<std::size_t>(nc_));
  bool any_stuck = false, all_stuck = true, any_nonlinear = false;
  for (std::size_t c = 0; c < stuck.size(); ++c) {
    stuck[c] = modes_[c] == ContactMode::kStick;
    any_stuck |= stuck[c];
    all_stuck &= stuck[c];
    any_nonlinear |= !stuck[c] && !laws_[c].is_constant();
  }
  if (all_stuck) {
    forces_.noalias() = table.kernel_inverse * (belt_nodes_ - free_);
    velocity_ = belt_nodes_;
    return true;
  }
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    block(forces_, c)
        .setConstant(laws_[i].is_constant() && !stuck[i] ? sign_of(modes_[i]) * laws_[i].kinetic : force_now_(c));
  }
  if (!any_stuck && !any_nonlinear) {
    velocity_.noalias() = free_ + table.kernel * forces_;
    return true;
  }

  Eigen::MatrixXd jacobian(size, size);
  Eigen::VectorXd residual(size);
  for (int iteration = 0; iteration < kNewtonLimit; ++iteration) {
    // Sliding contacts: λ − law(v) = 0. Sticking ones: v − v_belt = 0.
    velocity_.noalias() = free_ + table.kernel * forces_;
    double curvature = 0.0;
    for (int c = 0; c < nc_; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const ContactForces& law = laws_[i];
      for (int j = 0; j < kNodes; ++j) {
        const Eigen::Index row = kNodes * c + j;
        if (stuck[i]) {
          residual(row) = belt_nodes_(row) - velocity_(row);
          jacobian.row(row) = table.kernel.row(row);
          continue;
        }
        double lambda, slope;  // dλ/dv
        const double s = belt_nodes_(row) - velocity_(row);
        if (!law.sticks()) {
          lambda = law.smooth(s, slope);
          slope = -slope;
        } else {
          const double sign = sign_of(modes_[i]), scaled = law.alpha * sign * s;
          const bool inside = scaled > -2 * kLargestOvershoot;
          const double e = law.drop * std::exp(inside ? -scaled : 2 * kLargestOvershoot);
          lambda = sign * (law.kinetic + e);
          slope = inside ? law.alpha * e : 0.0;
        }
        residual(row) = lambda - forces_(row);
        jacobian.row(row) = -slope * table.kernel.row(row);
        jacobian(row, row) += 1.0;
      }
    }
    const Eigen::VectorXd delta = jacobian.partialPivLu().solve(residual);
    if (!delta.allFinite()) return false;
    forces_ += delta;
    const Eigen::VectorXd dv = table.kernel * delta;
    velocity_ += dv;
    for (int c = 0; c < nc_; ++c) {
      const ContactForces& law = laws_[static_cast<std::size_t>(c)];
      if (law.kind == ContactForces::Kind::kStribeck || law.kind == ContactForces::Kind::kSmooth) {
        const double rate = law.kind == ContactForces::Kind::kSmooth ? 1.0 / law.epsilon : law.alpha;
        if (!stuck[static_cast<std::size_t>(c)])
          curvature = std::max(curvature, rate * block(dv, c).cwiseAbs().maxCoeff());
      }
    }
    if (!any_nonlinear || curvature < kNewtonChange) return true;
  }
  return false;
}

double CollocationFlow::force_error() const {
  double worst = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws_[i].kind == ContactForces::Kind::kFree) continue;
    const V8 forces = load8(forces_.data() + kNodes * c);
    const double sixth = std::abs(sum8(forces * load8(nodes_.legendre6.data())));
    const double seventh = std::abs(sum8(forces * load8(nodes_.legendre7.data())));
    // The first coefficient left out, if the sequence keeps falling as it does.
    const double next = seventh * std::min(1.0, seventh / std::max(sixth, 1e-300));
    worst = std::max(worst, next / laws_[i].static_limit);
  }
  return worst;
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
    const ContactForces& law = laws_[i];
    if (!law.sticks()) continue;
    if (modes_[i] == ContactMode::kStick) {
      const V8 b = matrix8_times(t.bernstein7.data(), forces_.data() + kNodes * c);
      if (max8(b) >= law.static_limit) consider(law.static_limit - b, 0.0, kNodes - 1, c, 0);
      if (min8(b) <= -law.static_limit) consider(law.static_limit + b, 0.0, kNodes - 1, c, 0);
      continue;
    }
    const double sign = sign_of(modes_[i]);
    alignas(64) double speed[kNodes];
    store8(speed, sign * (load8(belt_nodes_.data() + kNodes * c) - load8(velocity_.data() + kNodes * c)));
    const int multiplicity = multiplicity_[i];
    const double start =
        multiplicity > 0 ? 0.0 : std::max(0.0, sign * (belt_.velocity(begin_) - contact_velocity(c, x_begin_.data())));
    V8 b = matrix8_times(t.bernstein8.data(), speed) + start * load8(t.bernstein8_start.data());
    if (multiplicity == 2)
      b[0] = std::numeric_limits<double>::max();  // zero by the order of contact, whatever rounding says
    if (min8(b) > 0.0) continue;
    consider(b, start, kNodes, c, multiplicity);
  }
  return first;
}

double CollocationFlow::deepest_overshoot() const {
  double deepest = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws_[i].kind != ContactForces::Kind::kStribeck || modes_[i] == ContactMode::kStick) continue;
    const V8 speed =
        sign_of(modes_[i]) * (load8(belt_nodes_.data() + kNodes * c) - load8(velocity_.data() + kNodes * c));
    deepest = std::max(deepest, -laws_[i].alpha * min8(speed));
  }
  return deepest;
}

bool CollocationFlow::step(double t_limit) {
  events_.clear();
  begin_ = time_;
  x_begin_.swap(x_);
  step_modes_ = modes_;
  step_multiplicity_ = multiplicity_;
  double limit = t_limit;
  bool corner = false;
  if (!belt_.is_constant()) {
    if (const auto t = belt_.next_corner(begin_); t && *t <= limit) {
      limit = *t;
      corner = true;
    }
  }
  const double remaining = limit - begin_;

  int level = foreseen_level(level_);
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
    tolerance = options_.tolerance * (tau < h || dense_ ? 1.0 : 1.0 / kEndNodeGain);
    if (!(error <= tolerance) && !smallest) {
      level += halvings(error / tolerance);
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
    advance_partial(x_begin_.data(), forces_.data(), level, tau, x_.data());
    if (at_guard) refine_event(guard, tau, x_);
  } else {
    advance_full(tables_.propagator(level), x_begin_.data(), forces_.data(), x_.data());
  }
  time_ = tau == remaining ? limit : begin_ + tau;
  ++statistics_.steps;
  if (!std::isfinite(x_(0)) || !std::isfinite(time_))
    throw NumericalFailure("the state is no longer finite at t = " + std::to_string(begin_), begin_, x_begin_, error);
  for (int c = 0; c < nc_; ++c)
    if (modes_[static_cast<std::size_t>(c)] == ContactMode::kStick)
      statistics_.stick_time[static_cast<std::size_t>(c)] += tau;
  if (options_.audit) account(level, tau / h);
  if (tangents_.size() > 0) push_tangents(level, tau);

  level_ = error < tolerance * kGrowth && level > 0 ? level - 1 : level;
  solved_ = tau == h;
  if (fresh_) start_level_[stuck_count()] = level_;
  fresh_ = false;
  std::fill(multiplicity_.begin(), multiplicity_.end(), 0);
  const auto& last = nodes_.lagrange(tau / h);
  for (int c = 0; c < nc_; ++c)
    force_now_(c) = tau < h ? forces_.segment<kNodes>(kNodes * c).dot(last) : forces_(kNodes * c + kNodes - 1);
  if (!at_guard && !(corner && time_ == limit)) return false;
  settle_event(at_guard ? guard.contact : -1, guard.touching);
  return true;
}

void CollocationFlow::advance_full(const Propagator& p, const double* x, const double* forces, double* out_x) const {
  propagate(p, x, forces, nc_, model_.np, out_x);
}

void CollocationFlow::advance_partial(const double* x, const double* forces, int level, double tau,
                                      double* out_x) const {
  advance_within(tables_, x, forces, level, tau, out_x);
}

void CollocationFlow::refine_event(const Guarded& guard, double& tau, Eigen::VectorXd& x) const {
  // Newton on the guard's exact value; the polynomial that announced it was only close.
  if (guard.touching) return;
  const double h = tables_.step(step_level_);
  const int c = guard.contact;
  const auto i = static_cast<std::size_t>(c);
  for (int iteration = 0; iteration < 3; ++iteration) {
    const double a = belt_.acceleration(begin_), V = belt_.velocity(begin_) + a * tau;
    const RadauTables::Vector8 basis = nodes_.lagrange(tau / h);
    double value, rate;
    if (modes_[i] == ContactMode::kStick) {
      const double sign = forces_.segment<kNodes>(kNodes * c).dot(basis) > 0 ? 1.0 : -1.0;
      value = laws_[i].static_limit - sign * stick_force(c, x, tau, basis);
      rate = -sign * forces_.segment<kNodes>(kNodes * c).dot(nodes_.lagrange_slope(tau / h)) / h;
    } else {
      const double sign = sign_of(modes_[i]);
      value = sign * (V - contact_velocity(c, x.data()));
      double acceleration =
          dot_padded(model_.acceleration_row.col(c).data(), x.data(), 2 * model_.np) + model_.load_acceleration(c);
      for (int d = 0; d < nc_; ++d)
        acceleration += model_.mobility(c, d) * forces_.segment<kNodes>(kNodes * d).dot(basis);
      rate = sign * (a - acceleration);
    }
    const double shift = -value / rate;
    if (!(std::abs(shift) < 1e-2 * h) || tau + shift <= 0.0) return;
    tau += shift;
    if (std::abs(shift) <= kNegligibleShift * h) return;
    advance_partial(x_begin_.data(), forces_.data(), step_level_, tau, x.data());
    if (shift * shift <= kNegligibleShift * h * h) return;  // Newton's next shift would be negligible
  }
}

double CollocationFlow::stick_force(int c, const Eigen::VectorXd& x, double tau,
                                    const RadauTables::Vector8& basis) const {
  const double a = belt_.acceleration(begin_);
  if (nc_ == 1)
    return (a - dot_padded(model_.acceleration_row.data(), x.data(), 2 * model_.np) - model_.load_acceleration(0)) /
           model_.mobility(0, 0);
  Eigen::VectorXd force(nc_);
  std::vector<bool> stuck(modes_.size());
  for (int d = 0; d < nc_; ++d) {
    stuck[static_cast<std::size_t>(d)] = modes_[static_cast<std::size_t>(d)] == ContactMode::kStick;
    force(d) = forces_.segment<kNodes>(kNodes * d).dot(basis);
  }
  stick_forces({model_, laws_, x.data(), begin_ + tau, belt_.velocity(begin_) + a * tau, a}, stuck, force);
  return force(c);
}

void CollocationFlow::account(int level, double theta) {
  const double h = tables_.step(level), length = theta * h;
  const bool whole = theta >= 1.0;
  const RadauTables& t = nodes_;
  double contact = 0.0, drive = 0.0;
  Eigen::Matrix<double, kNodes, kNodes> to_part;  // node values of the step → node values of the part walked
  Eigen::Matrix<double, kNodes, kNodes + 1> velocity_part;  // same for velocities, through the value at 0 too
  if (!whole) {
    for (int j = 0; j < kNodes; ++j) {
      const double at = theta * t.node(j);
      to_part.row(j) = t.lagrange(at).transpose();
      double start = 1.0;
      for (int k = 0; k < kNodes; ++k) start *= (at - t.node(k)) / -t.node(k);
      velocity_part(j, 0) = start;
      for (int k = 0; k < kNodes; ++k) velocity_part(j, k + 1) = to_part(j, k) * at / t.node(k);
    }
  }
  const double V = belt_.velocity(begin_), a = belt_.acceleration(begin_);
  for (int c = 0; c < nc_; ++c) {
    RadauTables::Vector8 force = forces_.segment<kNodes>(kNodes * c), speed = velocity_.segment<kNodes>(kNodes * c);
    if (!whole) {
      force = to_part * force;
      if (step_modes_[static_cast<std::size_t>(c)] == ContactMode::kStick)
        speed = V + a * length * t.node.array();
      else
        speed = velocity_part.col(0) * contact_velocity(c, x_begin_.data()) +
                velocity_part.rightCols<kNodes>() * velocity_.segment<kNodes>(kNodes * c);
    }
    const RadauTables::Vector8 weighted = length * t.weight.cwiseProduct(force);
    contact += weighted.dot(speed);
    drive += V * weighted.sum() + a * length * weighted.dot(t.node);
  }
  const double viscous =
      viscous_loss(tables_, level, x_begin_.data(), forces_.data(), theta, whole ? nullptr : velocity_part.data());
  work_.contact_work += contact;
  work_.drive_work += drive;
  work_.viscous_loss += viscous;
  work_.exchanged += std::abs(contact) + viscous;
}

void CollocationFlow::record(int contact, EventKind kind, ContactMode before) {
  Event e{time_, contact, kind, before, before, 0.0, 0.0, 0.0};
  if (contact >= 0) {
    e.after = modes_[static_cast<std::size_t>(contact)];
    e.displacement = dot_padded(model_.displacement_row.col(contact).data(), x_.data(), 2 * model_.np) +
                     model_.contact_offset(contact);
    e.velocity = contact_velocity(contact, x_.data());
    e.force = force_now_(contact);
  }
  events_.push_back(e);
  ++statistics_.events;
}

void CollocationFlow::record_change(int contact, ContactMode before) {
  const ContactMode after = modes_[static_cast<std::size_t>(contact)];
  record(contact,
         after == before                 ? EventKind::kGrazing
         : before == ContactMode::kStick ? EventKind::kRelease
         : after == ContactMode::kStick  ? EventKind::kStick
                                         : EventKind::kReversal,
         before);
}

void CollocationFlow::settle_event(int contact, bool touching) {
  if (contact >= 0 && touching) {
    const auto i = static_cast<std::size_t>(contact);
    record(contact, EventKind::kGrazing, modes_[i]);
    multiplicity_[i] = modes_[i] == ContactMode::kStick ? 0 : 2;
  } else if (nc_ == 1 && contact == 0) {
    settle_single();
  } else {
    settle_coupled(contact);
  }
  guard_against_zeno();
}

void CollocationFlow::settle_single() {
  const ContactMode before = modes_[0];
  const double force_before = force_now_(0), gap = belt_.velocity(time_) - contact_velocity(0, x_.data());
  const double impulse = gap / model_.mobility(0, 0);
  const double* input = model_.input.data();
  for (Eigen::Index i = 0; i < 2 * model_.np; i += kLanes)
    store8(x_.data() + i, load8(x_.data() + i) + impulse * load8(input + i));
  const SingleResolution next =
      resolve_single(instant(x_), before == ContactMode::kStick, force_before > 0 ? 1.0 : -1.0);
  modes_[0] = next.mode;
  multiplicity_[0] = next.multiplicity;
  force_now_(0) = next.force;
  restart_steps();
  if (tangents_.size() > 0) salt_tangents(Eigen::VectorXd::Constant(1, force_before), force_now_, {before}, 0);
  record_change(0, before);
}

void CollocationFlow::settle_coupled(int contact) {
  // Contacts at rest on the belt, to be decided together: the sticking ones, the one whose guard was reached, and any
  // other whose sliding speed is zero to rounding.
  const double V = belt_.velocity(time_);
  std::vector<bool> at_rest(modes_.size());
  std::vector<Eigen::Index> resting;
  for (std::size_t c = 0; c < modes_.size(); ++c) {
    const auto i = static_cast<int>(c);
    if (!laws_[c].sticks()) continue;
    const double speed = std::abs(V - contact_velocity(i, x_.data()));
    const double scale = model_.velocity_row.col(i).cwiseAbs().dot(x_.cwiseAbs()) + std::abs(V);
    at_rest[c] = modes_[c] == ContactMode::kStick || i == contact || speed <= kAtRest * scale;
    if (at_rest[c]) resting.push_back(i);
  }
  if (!resting.empty()) {
    Eigen::VectorXd gap(static_cast<Eigen::Index>(resting.size()));
    for (Eigen::Index k = 0; k < gap.size(); ++k)
      gap(k) = V - contact_velocity(static_cast<int>(resting[static_cast<std::size_t>(k)]), x_.data());
    x_ += Eigen::MatrixXd(model_.input(Eigen::all, resting)) *
          Eigen::MatrixXd(model_.mobility(resting, resting)).ldlt().solve(gap);
  }

  const bool released = contact >= 0 && modes_[static_cast<std::size_t>(contact)] == ContactMode::kStick;
  const std::vector<ContactMode> before = modes_;
  const Eigen::VectorXd force_before = force_now_;
  start_modes(resolve(instant(x_), modes_, at_rest, released ? contact : -1));
  if (tangents_.size() > 0) salt_tangents(force_before, force_now_, before, contact);

  if (contact < 0) record(-1, EventKind::kDriveCorner, ContactMode::kStick);
  for (std::size_t c = 0; c < modes_.size(); ++c)
    if (modes_[c] != before[c] || static_cast<int>(c) == contact) record_change(static_cast<int>(c), before[c]);
}

void CollocationFlow::guard_against_zeno() {
  recent_events_.push_back(time_);
  const auto window = static_cast<std::size_t>(options_.max_events_per_window);
  if (recent_events_.size() <= window) return;
  const double since = recent_events_[recent_events_.size() - 1 - window];
  if (time_ - since < options_.zeno_window)
    throw NumericalFailure("Zeno: more than " + std::to_string(window) + " events within " +
                               std::to_string(options_.zeno_window) + " before t = " + std::to_string(time_),
                           time_, x_, time_ - since);
  if (recent_events_.size() > 8 * window)
    recent_events_.erase(recent_events_.begin(), recent_events_.end() - static_cast<std::ptrdiff_t>(window));
}

void CollocationFlow::start_modes(const Resolution& resolution) {
  modes_ = resolution.modes;
  multiplicity_ = resolution.multiplicity;
  force_now_ = resolution.force;
  restart_steps();
}

void CollocationFlow::restart_steps() {
  level_ = start_level_[stuck_count()];
  solved_ = false;
  fresh_ = true;
}

std::size_t CollocationFlow::stuck_count() const {
  return static_cast<std::size_t>(std::count(modes_.begin(), modes_.end(), ContactMode::kStick));
}

void CollocationFlow::evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  const double h = tables_.step(step_level_), tau = std::clamp(t - begin_, 0.0, h);
  out_x.resize(2 * model_.np);
  out_force.resize(nc_);
  advance_partial(x_begin_.data(), forces_.data(), step_level_, tau, out_x.data());
  const auto basis = nodes_.lagrange(tau / h);
  for (int c = 0; c < nc_; ++c) out_force(c) = forces_.segment<kNodes>(kNodes * c).dot(basis);
}

}  // namespace slipmode::dynamics
