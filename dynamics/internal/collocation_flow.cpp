#include "dynamics/internal/collocation_flow.hpp"

#include <slipmode/core/errors.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::dynamics {
namespace {

/// Share of a step that is not left for a step of its own.
constexpr double kSliver = 1e-6;
/// A step that ends at its last node gains from the Radau nodes' superconvergence; one that ends inside does not.
constexpr double kEndNodeGain = 3e-2;
/// The step is doubled when the error of the doubled one, eighth order, is foreseen to pass with this margin.
constexpr double kGrowth = 1.0 / (256.0 * 8.0);
/// Largest product of the law's slope, the mobility and the step that is tried.
constexpr double kGrowthPerStep = 1.2;
/// The same product at the start of a slip, where Newton has to tell the slow start, which grows by e to this power,
/// from sliding that has left it behind.
constexpr double kGrowthAtStart = 10.0;
/// Halvings of a step to prove that it passes over no event.
constexpr int kProofHalvings = 3;
/// A step spans at most this phase of a shaker, so that all quadratures resolve it.
constexpr double kLargestDrivePhase = 2.0;

/// Of a force that is larger than friction by more than this, errors are held against the force.
constexpr double kLeastForceShare = 1e-4;
/// Of a step at once.
constexpr int kMostHalvings = 4;
/// Where rounding may be this share of a stick's largest force, states say more of it than what the step solved for.
constexpr double kUntold = 1e-11;

/// How many times to halve a step whose eighth-order error is too large by this factor: at least once.
int halvings(double excess) {
  int exponent = 0;
  std::frexp(excess, &exponent);
  constexpr int order = kNodes;
  return std::clamp(1 + exponent / order, 1, kMostHalvings);
}

/// The largest ωh for which the polynomial of degree 7 through a step's nodes follows e^{iωt} to within `tolerance`:
/// |V − p| ≤ (ωh/2)⁸ / (2⁷ 8!).
double largest_phase(double tolerance) {
  return std::min(kLargestDrivePhase, 2.0 * std::pow(tolerance * 128.0 * 40320.0, 1.0 / kNodes));
}

/// Level of the largest step that follows a motion of this frequency.
int coarsest_level(double omega, const StepTables& tables, double tolerance) {
  const double phase = largest_phase(tolerance);
  int level = 0;
  while (level + 1 < StepTables::kLevels && tables.step(level) * omega > phase) ++level;
  return level;
}

/// The largest force, of a load that varies under its constant part; 0 where it is not known.
double usual_limit(const EventResolver& resolver, int c) {
  const ContactForces& law = resolver.laws()[static_cast<std::size_t>(c)];
  return (law.varies ? law.under(std::abs(resolver.load_form(c).constant)) : law).most();
}

/// Level of the largest step that follows the drive's velocity, or each harmonic of its force to a share of the least
/// friction limit, as contacts' forces are followed.
int coarsest_level(const StepTables& tables, const EventResolver& resolver, double tolerance) {
  if (const friction::Shaker* shaker = resolver.drive().shaker())
    return coarsest_level(shaker->omega(), tables, tolerance);
  const friction::Force* force = resolver.drive().force();
  if (force == nullptr) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (int c = 0; c < static_cast<int>(resolver.laws().size()); ++c)
    if (const double limit = usual_limit(resolver, c); limit > 0.0) least = std::min(least, limit);
  int level = 0;
  for (const friction::ForceHarmonic& h : force->harmonics) {
    const double share = std::clamp(least / std::abs(h.amplitude), kLeastForceShare, 1.0);
    level = std::max(level, coarsest_level(h.order * force->omega, tables, share * tolerance));
  }
  return level;
}

}  // namespace

CollocationFlow::CollocationFlow(const HybridSystem& system, const StepTables& tables, HybridPoint start,
                                 const FlowOptions& options)
    : tables_(tables),
      model_(tables.model()),
      resolver_(system, model_, options),
      options_(options),
      within_(tables, options.audit),
      nc_(model_.contacts),
      given_(tables.acted_on().given),
      acting_(tables.acting_time(system.drive().omega())),
      begin_(start.time),
      point_(std::move(start)),
      x_begin_(point_.x),
      coarsest_(coarsest_level(tables, resolver_, options.tolerance)),
      newton_change_(std::min(1e-3, std::sqrt(kNewtonShare * options.tolerance))),
      start_level_(static_cast<std::size_t>(nc_) + 1, std::max(3, coarsest_)) {
  for (auto* v : {&free_, &velocity_, &drive_nodes_, &bristle_nodes_, &guard_forms_, &free_way_, &moved_})
    *v = Eigen::VectorXd::Zero(kNodes * nc_);
  way_nodes_ = Eigen::VectorXd::Zero(kNodes);
  forces_ = Eigen::VectorXd::Zero(kNodes * (nc_ + given_));
  told_ = Eigen::VectorXd::Zero(kNodes * nc_);
  told_by_states_.assign(static_cast<std::size_t>(nc_), false);
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  for (std::size_t c = 0; c < laws().size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    steep_speed_.push_back(
        std::log(laws()[c].alpha * laws()[c].drop * model_.mobility(i, i) * tables_.step(0) / kGrowthPerStep) /
        laws()[c].alpha);
    steep_fall_.push_back(std::numbers::ln2 / laws()[c].alpha);
    const double growth = laws()[c].onset_slope() * model_.mobility(i, i) * tables_.step(0);
    slow_start_level_.push_back(growth > kGrowthAtStart ? std::ilogb(growth / kGrowthAtStart) + 1 : 0);
    const double limit = usual_limit(resolver_, static_cast<int>(c));
    over_limit_.push_back(limit > 0.0 ? 1.0 / limit : 0.0);
    if (limit > 0.0) least_limit_ = std::min(least_limit_, limit);
    elaborate_.push_back(laws()[c].is_elaborate());
  }
  own_forces_.resize(laws().size());
  for (int c = 0; c < nc_; ++c) {
    any_bristle_ |= bristled(c);
    any_elaborate_ |= elaborate(c);
    own_at_.push_back(system.internal_begin(c));
  }
  if (point_.internal.size() == 0) point_.internal = Eigen::VectorXd::Zero(system.internal_size());
  internal_begin_ = point_.internal;
  const std::vector<ContactMode> given = point_.modes;
  if (any_bristle_) start_bristles();
  resolver_.start(point_);
  events_ = resolver_.events();
  if (any_bristle_) {
    refresh_bristles();
    record_reversals(given);
  }
  statistics_.events = static_cast<std::int64_t>(events_.size());
  guard_start_ = guard_least_ = Eigen::VectorXd::Zero(nc_);
  prepare_proof();
  step_modes_ = point_.modes;
  internal_begin_ = point_.internal;
  if (any_elaborate_) set_own_forces();
  single_ = nc_ == 1 && !any_bristle_ && !any_elaborate_ && laws()[0].characteristic == nullptr;
  restart_steps();
}

bool CollocationFlow::step(double t_limit) {
  resolver_.clear();
  events_.clear();
  begin_ = point_.time;
  if (any_elaborate_) set_own_forces();
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
  for (std::size_t c = 0; c < slow_start_level_.size(); ++c)
    if (point_.multiplicity[c] > 0) level = std::max(level, slow_start_level_[c]);
  while (level + 1 < StepTables::kLevels && tables_.step(level + 1) >= remaining) ++level;
  const auto advances = [&](int at) { return begin_ + tables_.step(at) > begin_; };
  FirstGuards guards;
  Guarded& guard = guards.first;
  double h = 0.0, tau = 0.0, error = 0.0, tolerance = 0.0;
  bool proved = false;
  int halved = 0;
  for (bool retry = false;; retry = true, ++statistics_.rejected) {
    if (level >= StepTables::kLevels)
      throw NumericalFailure(
          "the contact forces could not be resolved by any step size at t = " + std::to_string(begin_), begin_,
          x_begin_, error);
    // A step that ends where it begins leads nowhere.
    while (level > 0 && !advances(level)) --level;
    const bool smallest = level + 1 == StepTables::kLevels || !advances(level + 1);
    h = tables_.step(level);
    guess_forces(level, retry);
    if (given_ > 0) give_forces(level);
    solved_ = solve_forces(level);
    step_level_ = level;
    if (any_bristle_ && solved_ && turn_resting_bristles()) solved_ = solve_forces(level);
    if (!solved_) {
      level = smallest ? StepTables::kLevels : level + 1;
      continue;
    }
    error = force_error() * (h / acting_);
    if (error > options_.tolerance) error = std::max(options_.tolerance, error - rounding_of_sticks());
    if (!(error <= options_.tolerance / kEndNodeGain) && !smallest) {
      level += halvings(error * kEndNodeGain / options_.tolerance);
      continue;
    }
    guards = first_guards();
    if (guard.contact >= 0 && bristled(guard.contact)) error = std::max(error, reversal_error(guard));
    // Steps that sum up to all but a sliver of the time leave it to rounding: forces solved in it alone are noise.
    const double whole = remaining > h && remaining - h < kSliver * h ? remaining / 2.0 : h;
    tau = std::min(guard.contact >= 0 ? guard.theta * h : whole, remaining);
    tolerance = options_.tolerance * (tau < h ? 1.0 : 1.0 / kEndNodeGain);
    if (!(error <= tolerance) && !smallest) {
      level += halvings(error / tolerance);
      continue;
    }
    if ((any_bristle_ || any_elaborate_) && tangents_.size() > 0 && !smallest &&
        h * tangent_rate() > largest_phase(options_.tolerance)) {
      ++level;
      continue;
    }
    if (too_early(guard) && !smallest) {
      ++level;
      continue;
    }
    if (guard.contact >= 0 && deepest_overshoot() > kLargestOvershoot) {
      // Of forces so far beyond their law the guard says when, or nothing at all: a few halvings at a time.
      const int most = std::min(level + kMostHalvings, StepTables::kLevels - 1);
      level = smallest ? StepTables::kLevels : level + 1;
      while (level < most && tables_.step(level + 1) > guard.theta * h) ++level;
      continue;
    }
    proved = proves(guard, tau / h);
    if (!proved && halving_proves_ && halved < kProofHalvings && !smallest) {
      ++halved;
      ++level;
      continue;
    }
    break;
  }
  if (any_bristle_ && point_.modes != step_modes_) {
    if (statistics_.steps > 0) {  // turned where the last step ended: an event, and the step is taken after it
      turned_at_ = begin_;
      point_.x = x_begin_;
      solved_ = false;
      record_reversals(step_modes_);
      statistics_.events += static_cast<std::int64_t>(events_.size());
      return true;
    }
    step_modes_ = point_.modes;
  }
  // Whether a guard vanishes before the step is to end is said by its exact time, not by its form.
  bool at_guard = guard.contact >= 0 && guard.theta * h <= remaining + (guard.touching ? 0.0 : kAnnounced * h);
  if (tau < h) {
    within_.begin(x_begin_.data(), forces_.data(), level);
    if (at_guard) {
      tau = guard.theta * h;
      within_.state(tau, point_.x.data());
      refine_first(guards, tau, point_.x);
      at_guard = tau <= remaining;
    }
    if (!at_guard) {  // between nodes a stick is only nearly held
      tau = std::min(tau, remaining);
      within_.state(tau, point_.x.data());
      resolver_.hold(begin_ + tau, point_.modes, point_.x.data());
    }
  } else {
    kernels_.propagate(tables_.propagator(level).arrays(tables_.loaded()), x_begin_.data(), forces_.data(),
                       point_.x.data());
  }
  if (!at_guard) guard = {};  // what lies beyond the step is nothing of its end's
  if (at_guard && point_.modes[static_cast<std::size_t>(guard.contact)] != ContactMode::kStick)
    stop_level_ = error < tolerance * kGrowth ? level - 1 : level;
  point_.time = tau == remaining ? limit : begin_ + tau;
  // A shaker's velocity feels the rounding of the time.
  if (tau == h && drive().shaker() != nullptr) resolver_.hold(point_.time, point_.modes, point_.x.data());
  ++statistics_.steps;
  if (proved) ++statistics_.certified;
  if (!std::isfinite(point_.x(0)) || !std::isfinite(point_.time))
    throw NumericalFailure("the state is no longer finite at t = " + std::to_string(begin_), begin_, x_begin_, error);
  for (int c = 0; c < nc_; ++c)
    if (point_.modes[static_cast<std::size_t>(c)] == ContactMode::kStick)
      statistics_.stick_time[static_cast<std::size_t>(c)] += tau;
  if (options_.audit) account(level, tau);
  if (tangents_.size() > 0) push_tangents(level, tau);

  // What a proof asks for is asked for near a guard; where halving did not bring it, it is not tried again.
  halving_proves_ = provable_ && proved;
  level_ = std::max(coarsest_, (error < tolerance * kGrowth ? level - 1 : level) - halved);
  solved_ = tau == h;
  if (fresh_) {
    start_level_[stuck_count()] = level_;
    if (nc_ == 1 && point_.modes[0] != ContactMode::kStick && !bristled(0) && point_.force(0) != 0.0) {
      first_level_ = level;
      first_shape_ = forces_.head<kNodes>() / point_.force(0);
    }
  }
  fresh_ = false;
  for (int c = 0; c < nc_; ++c)
    if (int& order = point_.multiplicity[static_cast<std::size_t>(c)]; order > 0 && !unmoved(c)) order = 0;
  touched_ = -1;
  if (tau < h) {
    const RadauTables::Vector8 last = nodes_.lagrange(tau / h);
    for (int c = 0; c < nc_; ++c) point_.force(c) = forces_.segment<kNodes>(kNodes * c).dot(last);
  } else {
    for (int c = 0; c < nc_; ++c) point_.force(c) = forces_(kNodes * c + kNodes - 1);
  }
  if (any_bristle_ || any_elaborate_) {
    for (int c = 0; c < nc_; ++c) {
      if (elaborate(c) && !held(point_.modes, c)) point_.force(c) = own_force(c, tau, point_.x.data());
      // As long as its speed is rounding, a bristle's direction means nothing.
      if (bristled(c) && unmoved(c)) point_.multiplicity[static_cast<std::size_t>(c)] = 2;
    }
    point_.internal = internal_within(tau, point_.x.data());
    forces_at(resolver_.instant(point_.time, point_.x.data()), point_.modes, point_.internal, point_.force);
  }
  if (!at_guard && !(corner && point_.time == limit)) return false;

  const int contact = at_guard ? guard.contact : -1;
  const Eigen::VectorXd rate_before = tangents_.size() > 0 ? point_rate() : Eigen::VectorXd();
  if (at_guard && bristled(contact)) {
    settle_bristle(contact, guard.touching);
  } else {
    Reached reached{contact, guard.touching};
    if (at_guard && guard.own) {
      reached.kind = guard.own->kind;
      reached.next = guard.own->next;
      if (guard.touching) touched_ = contact;
    }
    resolver_.settle(point_, reached);
    events_ = resolver_.events();
    if (any_bristle_) {
      refresh_bristles();
      record_reversals(step_modes_);
    }
  }
  statistics_.events += static_cast<std::int64_t>(events_.size());
  if (!guard.touching) {
    restart_steps();
    if (tangents_.size() > 0) salt_tangents(rate_before, guard);
  }
  return true;
}

double CollocationFlow::over_scale(int c) const {
  const auto i = static_cast<std::size_t>(c);
  const double most = forces_.segment<kNodes>(kNodes * c).cwiseAbs().maxCoeff();
  if (over_limit_[i] > 0.0) return laws()[i].varies ? 1.0 / std::max(1.0 / over_limit_[i], most) : over_limit_[i];
  if (most == 0.0) return 0.0;
  return 1.0 / (std::isfinite(least_limit_) ? std::max(least_limit_, kLeastForceShare * most) : most);
}

double CollocationFlow::impulse_of_rounding(int c) const {
  constexpr double kRoundsBy = 64.0 * std::numeric_limits<double>::epsilon();
  // Where all is at rest, of what forces in balance would make of it in the step.
  return kRoundsBy * (velocity_scale(c, x_begin_) + balanced(c) * tables_.step(step_level_)) / model_.mobility(c, c);
}

double CollocationFlow::rounding_of_sticks() const {
  double most = 0.0;
  for (int c = 0; c < nc_; ++c)
    if (held(point_.modes, c)) most = std::max(most, impulse_of_rounding(c) * over_scale(c));
  return most / acting_;
}

void CollocationFlow::tell_by_states(int c) {
  const double h = tables_.step(step_level_);
  if (!(impulse_of_rounding(c) * over_scale(c) > kUntold * h)) return;
  within_.begin(x_begin_.data(), forces_.data(), step_level_);
  Eigen::VectorXd x(x_begin_.size());
  for (int j = 0; j < kNodes; ++j) {
    within_.state(h * nodes_.node(j), x.data());
    told_(kNodes * c + j) = stick_force(c, x, h * nodes_.node(j));
  }
  told_by_states_[static_cast<std::size_t>(c)] = true;
}

Eigen::Map<const RadauTables::Vector8> CollocationFlow::told_forces(int c) const {
  const bool by_states = told_by_states_[static_cast<std::size_t>(c)];
  return Eigen::Map<const RadauTables::Vector8>((by_states ? told_ : forces_).data() + kNodes * c);
}

bool CollocationFlow::too_steep(int c, double speed, int level) const {
  const double slope = laws()[static_cast<std::size_t>(c)].slope(1.0, speed);
  return std::abs(slope) * model_.mobility(c, c) * tables_.step(level) > kGrowthPerStep;
}

double CollocationFlow::drive_velocity(double begin, double tau) const {
  const double V = drive().velocity(begin), a = drive().acceleration(begin);
  if (drive().shaker() == nullptr) return V + a * tau;
  // From the phase at the beginning: begin + tau would round the time, and make a staircase of a short step.
  const double omega = drive().shaker()->omega();
  return V * std::cos(omega * tau) + a / omega * std::sin(omega * tau);
}

double CollocationFlow::drive_way(double begin, double tau) const {
  const double V = drive().velocity(begin), a = drive().acceleration(begin);
  if (drive().shaker() == nullptr) return (V + 0.5 * a * tau) * tau;
  const double half = 0.5 * drive().shaker()->omega(), sine = std::sin(half * tau);
  return (V * std::cos(half * tau) + 0.5 * a / half * sine) * sine / half;
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

void CollocationFlow::give_forces(int level) {
  const friction::Force* force = drive().force();
  forces_.tail(kNodes * given_).setZero();
  if (force == nullptr) return;
  turned_.resize(StepTables::kLevels);
  Eigen::MatrixXd& turned = turned_[static_cast<std::size_t>(level)];
  if (turned.size() == 0) {
    turned.resize(2 * kNodes, static_cast<Eigen::Index>(force->harmonics.size()));
    for (Eigen::Index k = 0; k < turned.cols(); ++k) {
      const double omega = force->harmonics[static_cast<std::size_t>(k)].order * force->omega;
      const auto phase = (omega * tables_.step(level)) * nodes_.node.array();
      turned.col(k) << phase.cos(), phase.sin();
    }
  }
  for (Eigen::Index k = 0; k < turned.cols(); ++k) {
    const friction::ForceHarmonic& h = force->harmonics[static_cast<std::size_t>(k)];
    const double phase = h.order * force->omega * begin_ + h.phase;
    forces_.segment<kNodes>(kNodes * (nc_ + h.direction)) +=
        h.amplitude * std::sin(phase) * turned.col(k).head<kNodes>() +
        h.amplitude * std::cos(phase) * turned.col(k).tail<kNodes>();
  }
}

Eigen::VectorXd CollocationFlow::given_force(double tau, int derivative) const {
  // From the phase at the beginning, as drive_velocity.
  Eigen::VectorXd out = Eigen::VectorXd::Zero(given_);
  if (const friction::Force* force = drive().force())
    for (const friction::ForceHarmonic& h : force->harmonics) {
      const double omega = h.order * force->omega, begin = omega * begin_ + h.phase,
                   turned = omega * tau + derivative * (std::numbers::pi / 2.0);
      out(h.direction) += h.amplitude * std::pow(omega, derivative) *
                          (std::sin(begin) * std::cos(turned) + std::cos(begin) * std::sin(turned));
    }
  return out;
}

double CollocationFlow::given_acceleration(int c, double tau) const {
  return given_ > 0 ? model_.force_acceleration.row(c).dot(given_force(tau)) : 0.0;
}

void CollocationFlow::restart_steps() {
  level_ = start_level_[stuck_count()];
  solved_ = false;
  fresh_ = true;
}

std::size_t CollocationFlow::stuck_count() const {
  return static_cast<std::size_t>(std::count(point_.modes.begin(), point_.modes.end(), ContactMode::kStick));
}

void CollocationFlow::evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) {
  const double h = tables_.step(step_level_), tau = std::clamp(t - begin_, 0.0, h);
  out_x.resize(2 * model_.np);
  within_.begin(x_begin_.data(), forces_.data(), step_level_);
  within_.state(tau, out_x.data());
  resolver_.hold(t, step_modes_, out_x.data());
  out_force = forces_within(tau, out_x);
}

Eigen::VectorXd CollocationFlow::forces_within(double tau, const Eigen::VectorXd& x) const {
  Eigen::VectorXd force(nc_);
  for (int c = 0; c < nc_; ++c)
    if (elaborate(c) && !held(step_modes_, c)) force(c) = own_force(c, tau, x.data());
  Instant now{model_, laws(), x.data(), begin_ + tau, drive_velocity(begin_, tau), drive_acceleration(begin_, tau)};
  now.force = given_force(tau);
  forces_at(now, step_modes_, internal_within(tau, x.data()), force);
  return force;
}

}  // namespace slipmode::dynamics
