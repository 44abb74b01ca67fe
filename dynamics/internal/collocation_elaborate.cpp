// Contacts with springs, stops, tilt or loads that vary: forces linear in the contact's own motion, guards linear in
// motion and force. docs/theory/flow.md, section 4.
#include "dynamics/internal/collocation_flow.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// A guard that cannot be told from zero beyond this share of its scale is not looked at, and starts at zero below the
/// other one; its slope there is zero below the last share of what its terms are
/// and would become in a radian of the fastest mode: at a turning point all of them may vanish.
constexpr double kTouching = 1e-12, kStarting = 1e-11, kFlat = 1e-9;
/// A guard that starts at zero shows where it goes once it is this many times what it may be off by.
constexpr double kShows = 10.0;
/// A time rounds by this share of itself, and of the step it was found in.
constexpr double kOfTime = 1e-15;
/// A place rounds by this share of what is summed.
constexpr double kOfPlace = 64.0 * std::numeric_limits<double>::epsilon();
/// After a grazing the guard is as near to zero as the grazing was located.
constexpr double kGrazed = 1e-6;

}  // namespace

void CollocationFlow::set_own_forces() {
  const std::vector<ContactRole> roles = resolver_.roles(point_.modes);
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (!elaborate(c)) continue;
    own_forces_[i] = {};
    if (held(point_.modes, c)) continue;
    const ContactAnswer answer = contact_answer(laws()[i], resolver_.load_form(c), roles[i]);
    const bool follows = roles[i] == ContactRole::kSprung;
    const double place = resolver_.contact_displacement(c, point_.x.data());
    const double start = follows ? answer.stiffness * point_.internal(own_at_[i])
                                 : resolver_.regime_input(point_, c) - answer.stiffness * place;
    own_forces_[i] = {start, answer.stiffness, answer.damping, place, follows};
  }
}

double CollocationFlow::own_force(int c, double tau, const double* x) const {
  const OwnForce& own = own_forces_[static_cast<std::size_t>(c)];
  if (!own.moves()) return own.constant;
  return own.at(own.follows ? drive_way(begin_, tau) : 0.0, moved(c, tau, x), resolver_.contact_velocity(c, x));
}

double CollocationFlow::rounding_of_stop(int c) const {
  const auto i = static_cast<std::size_t>(c);
  if (over_limit_[i] > 0.0 || !elaborate(c)) return 0.0;
  const OwnForce& own = own_forces_[i];
  return kOfPlace * (std::abs(own.stiffness) * model_.displacement_row.col(c).cwiseAbs() +
                     std::abs(own.damping) * model_.velocity_row.col(c).cwiseAbs())
                        .dot(x_begin_.cwiseAbs());
}

double CollocationFlow::moved(int c, double tau, const double* x) const {
  const double by_state = resolver_.contact_displacement(c, x) - own_forces_[static_cast<std::size_t>(c)].place;
  // Zero at the start: a polynomial of degree 7 times the time.
  const double theta = tau / tables_.step(step_level_);
  const auto at_nodes = moved_.segment<kNodes>(kNodes * c).cwiseQuotient(nodes_.node);
  const double by_nodes = theta * at_nodes.dot(nodes_.lagrange(theta));
  const double rounds =
      kOfPlace * model_.displacement_row.col(c).cwiseAbs().dot(
                     Eigen::Map<const Eigen::VectorXd>(x, 2 * model_.np).cwiseAbs() + x_begin_.cwiseAbs());
  return std::abs(by_nodes - by_state) <= rounds ? by_nodes : by_state;
}

std::vector<CollocationFlow::OwnGuard> CollocationFlow::own_guards(int c, ContactMode mode) const {
  const auto i = static_cast<std::size_t>(c);
  const ContactForces& law = laws()[i];
  const friction::LoadForm& load = resolver_.load_form(c);
  std::vector<OwnGuard> guards;
  if (law.kind == LawKind::kClearance) {
    const double side = side_of(mode);
    for (const StopGuard& own : stop_guards(law.clearance, mode)) {
      OwnGuard guard{
          .kind = GuardKind::kStop, .next = own.next, .constant = own.constant + own.sign * load.offset, .y = own.sign};
      if (own.press) {
        const friction::Stop& stop = side < 0.0 ? *law.clearance.left : *law.clearance.right;
        guard.y = own.sign * side * stop.stiffness;
        guard.v = own.sign * side * stop.damping;
        guard.constant = own.constant + guard.y * load.offset - own.sign * stop.stiffness * stop.gap;
      }
      guards.push_back(guard);
    }
    return guards;
  }
  if (load.varies()) {
    const double sign = mode == ContactMode::kSeparated ? -1.0 : 1.0;
    guards.push_back({.kind = GuardKind::kLoad, .constant = sign * load.constant, .y = sign * load.y});
  }
  if (mode == ContactMode::kSeparated) return guards;
  if (mode == ContactMode::kStick) {
    for (const double side : {-1.0, 1.0}) {
      const double mu = law.static_coefficient(side);
      guards.push_back({.constant = mu * load.constant, .y = mu * load.y, .force = -side});
    }
    return guards;
  }
  // The speed at which the contact point slides: behind a spring it follows the load.
  const double sign = sign_of(mode);
  OwnGuard speed{.v = -sign, .drive = sign};
  if (law.kind == LawKind::kCompliant) speed.v -= law.kinetic_coefficient(sign) * load.y / law.stiffness;
  guards.push_back(speed);
  return guards;
}

BernsteinPolynomial CollocationFlow::interpolant(double start, const RadauTables::Vector8& at_nodes) const {
  BernsteinPolynomial p;
  p.degree = kNodes;
  p.coefficient[0] = start;
  Eigen::Map<RadauTables::Vector8>(p.coefficient.data() + 1) =
      nodes_.bernstein8 * at_nodes + nodes_.bernstein8_start * start;
  return p;
}

RadauTables::Vector8 CollocationFlow::at_nodes(const OwnGuard& guard, int c) const {
  const double y = resolver_.contact_displacement(c, x_begin_.data());
  const auto own = [&](const Eigen::VectorXd& of) { return of.segment<kNodes>(kNodes * c).array(); };
  return (guard.constant + guard.y * (y + own(moved_)) + guard.v * own(velocity_) +
          guard.force * told_forces(c).array() + guard.drive * own(drive_nodes_))
      .matrix();
}

BernsteinPolynomial CollocationFlow::form_of(const OwnGuard& guard, int c) const {
  const double y = resolver_.contact_displacement(c, x_begin_.data()),
               v = resolver_.contact_velocity(c, x_begin_.data()), V = drive_velocity(begin_, 0.0);
  const double force = told_by_states_[static_cast<std::size_t>(c)] ? stick_force(c, x_begin_, 0.0) : point_.force(c);
  return interpolant(guard.value(y, v, force, V), at_nodes(guard, c));
}

double CollocationFlow::moved_by(const OwnGuard& guard, double speed) const {
  return (std::abs(guard.y) * tables_.step(step_level_) + std::abs(guard.v)) * speed;
}

Eigen::VectorXd CollocationFlow::state_ahead() const {
  Eigen::VectorXd end(x_begin_.size());
  kernels_.propagate(tables_.propagator(step_level_).arrays(tables_.loaded()), x_begin_.data(), forces_.data(),
                     end.data());
  return end;
}

double CollocationFlow::size_ahead(const OwnGuard& guard, int c) const {
  const Eigen::VectorXd end = state_ahead().cwiseAbs();
  Eigen::VectorXd pushed = Eigen::VectorXd::Zero(x_begin_.size());
  // Forces in balance move by rounding, what they act on and all that hangs on it.
  const auto most = [&](int d) { return forces_.segment<kNodes>(kNodes * d).cwiseAbs().maxCoeff(); };
  for (int d = 0; d < nc_; ++d) pushed += most(d) * model_.input.col(d).cwiseAbs();
  for (int k = 0; k < given_; ++k) pushed += most(nc_ + k) * model_.force_input.col(k).cwiseAbs();
  return std::abs(guard.constant) + std::abs(guard.y) * model_.displacement_row.col(c).cwiseAbs().dot(end) +
         std::abs(guard.v) * model_.velocity_row.col(c).cwiseAbs().dot(end) +
         moved_by(guard, tables_.step(step_level_) * model_.velocity_row.col(c).cwiseAbs().dot(pushed));
}

double CollocationFlow::tolerated(const OwnGuard& guard, int c) const {
  Eigen::VectorXd impulse = Eigen::VectorXd::Zero(x_begin_.size());
  for (int d = 0; d < nc_; ++d) impulse += laws()[static_cast<std::size_t>(d)].most() * model_.input.col(d).cwiseAbs();
  return moved_by(guard, options_.tolerance * acting_ * model_.velocity_row.col(c).cwiseAbs().dot(impulse));
}

bool CollocationFlow::pushed_onto(const OwnGuard& guard, int c, const GuardValue& now, int order) const {
  if (point_.modes[static_cast<std::size_t>(c)] != ContactMode::kGap || order != 2 || !(now.second < 0.0) ||
      touched_ == c)
    return false;
  const double then = evaluate(guard, c, tables_.step(step_level_), state_ahead()).second / now.second;
  return then > 0.5 && then < 2.0;
}

bool CollocationFlow::searched_from_rest(const OwnGuard& guard, int c, const GuardValue& now, int order,
                                         const BernsteinPolynomial& form, FirstGuards& out) const {
  const RadauTables::Vector8 values = at_nodes(guard, c);
  const double t = nodes_.node(0) * tables_.step(step_level_), value = values(0),
               leading = order == 1 ? now.rate * t : now.second * t * t / 2.0;
  const double told = kTouching * std::max(now.size, size_ahead(guard, c)),
               shows = kShows * std::max(told, tolerated(guard, c));
  // A speed that is told leads, also where it turns before it shows at the nodes.
  const bool leads = order == 1 ? std::abs(now.rate) > std::max(model_.fastest, 1.0 / acting_) * told
                                : std::abs(leading) > told && leading / value > 0.5 && leading / value < 2.0;
  if (leads) return false;
  if (!(values.cwiseAbs().maxCoeff() > shows)) return !pushed_onto(guard, c, now, order);
  Guarded found{0.0, c, false, guard, 2};  // too early for it: to be halved
  if (std::abs(leading) <= shows) {
    const auto showing = std::find_if(values.begin(), values.end(), [&](double v) { return std::abs(v) > shows; });
    if (*showing < 0.0) {
      // Falls through zero where the step begins, unless it is known to rise there first: a shorter step tells.
      if (leading <= 0.0) found.order = 1;
    } else if (std::all_of(showing, values.end(), [&](double v) { return v >= -shows; })) {
      return true;
    } else {
      const double from = nodes_.node(showing - values.begin());
      const auto root = first_root(part(form, from, 1.0));
      if (!root) return true;
      found.theta = from + root->at * (1.0 - from);
      found.touching = root->touching;
    }
  }
  out.add(found);
  return true;
}

void CollocationFlow::search_own_guards(int c, FirstGuards& out) const {
  const auto i = static_cast<std::size_t>(c);
  for (const OwnGuard& guard : own_guards(c, point_.modes[i])) {
    BernsteinPolynomial p = form_of(guard, c);
    const double start = p.coefficient[0];
    Eigen::Map<RadauTables::Vector8> form(p.coefficient.data() + 1);
    const GuardValue now = evaluate(guard, c, 0.0, x_begin_);
    if (start > kStarting * now.size && form.minCoeff() > 0.0) continue;
    const int order = start_order(guard, c, now);
    const bool known = order == 2 && now.second != 0.0 && touched_ != c;
    // At rest on its limit; also where rounding of forces in balance alone moves it, as beside a contact that sticks.
    // Where neither slope nor curvature can be told, for as long as it would start at zero: rounding would say where
    // to.
    const double h = tables_.step(step_level_), most = std::max(std::abs(start), form.cwiseAbs().maxCoeff());
    const double pushed = moved_by(guard, h * balanced(c));
    if (most <= (order == 2 && !known ? kStarting : kTouching) * std::max(now.size, pushed) &&
        !pushed_onto(guard, c, now, order))
      continue;
    if (order > 0 && touched_ != c && guard.kind == GuardKind::kStop &&
        searched_from_rest(guard, c, now, order, p, out))
      continue;
    const bool rises = order == 1 ? now.rate > 0.0 : known && now.second > 0.0;
    if (rises && (std::abs(now.rate) + std::abs(now.second) * h) * h <= kStarting * now.size)
      continue;  // by less than its form rounds by
    if (order == 1) form(0) = now.rate * h / kNodes;
    if (known) form(1) = now.second * h * h / (kNodes * (kNodes - 1));
    std::fill_n(p.coefficient.begin(), order, 0.0);
    const auto* leading = std::find_if(p.coefficient.begin(), p.coefficient.end(), [](double b) { return b != 0.0; });
    if (leading == p.coefficient.end()) continue;
    const auto reached = [&](double theta, bool touching) {
      out.add({theta, c, touching, guard, theta == 0.0 && known ? 1 : order});
    };
    if (*leading < 0.0)  // falls through zero where the step begins
      reached(0.0, false);
    else if (const auto root = first_root(p))
      reached(root->at, root->touching);
  }
}

int CollocationFlow::start_order(const OwnGuard& guard, int c, const GuardValue& now) const {
  const auto i = static_cast<std::size_t>(c);
  if (guard.drive != 0.0 && laws()[i].kind == LawKind::kConstant && point_.multiplicity[i] > 0)
    return point_.multiplicity[i];
  const bool touched = touched_ == c && std::abs(now.value) <= kGrazed * now.size;
  // An event's time is rounded, and what changes fast is that far from zero.
  const double clock = kOfTime * (std::abs(begin_) + tables_.step(step_level_));
  if (!touched && std::abs(now.value) > std::max(kStarting * now.size, clock * std::abs(now.rate))) return 0;
  if (touched || std::abs(now.rate) <= kFlat * now.rate_size) return 2;
  // What falls to zero from where it can be told has yet to reach it.
  return now.rate < 0.0 && now.value > kTouching * now.size ? 0 : 1;
}

CollocationFlow::GuardValue CollocationFlow::evaluate(const OwnGuard& guard, int c, double tau,
                                                      const Eigen::VectorXd& x) const {
  const OwnForce& own = own_forces_[static_cast<std::size_t>(c)];
  const double h = tables_.step(step_level_), V = drive_velocity(begin_, tau), a = drive_acceleration(begin_, tau),
               y = resolver_.contact_displacement(c, x.data()), v = resolver_.contact_velocity(c, x.data());
  const RadauTables::Vector8 basis = nodes_.lagrange(tau / h);
  // Where a step begins forces are known; their polynomial is as good as its degree.
  const double acceleration = tau == 0.0 ? acceleration_at_start(c) : contact_acceleration(c, x, tau, basis);
  const auto row_size = [&](const Eigen::MatrixXd& rows) { return rows.col(c).cwiseAbs().dot(x.cwiseAbs()); };
  // A stop is the ground's: what the drive does is no measure of it.
  const bool driven = laws()[static_cast<std::size_t>(c)].kind != LawKind::kClearance;
  const double drive_speed = driven ? drive().velocity_scale(begin_) : 0.0;
  const double speeds = row_size(model_.velocity_row) + drive_speed,
               accelerations = row_size(model_.acceleration_row) + (driven ? std::abs(a) : 0.0) +
                               model_.mobility.row(c).cwiseAbs().dot(point_.force.cwiseAbs());
  double force = 0.0, force_rate = 0.0, force_rate_size = 0.0;
  if (guard.force != 0.0) {
    if (held(step_modes_, c)) {
      force = stick_force(c, x, tau);
      force_rate = told_forces(c).dot(nodes_.lagrange_slope(tau / h)) / h;
    } else {
      force = own_force(c, tau, x.data());
      force_rate = own.rate(V, v, acceleration);
      // Where it turns, as where its contact has ceased to slide, speeds round by what accelerations make of them.
      force_rate_size =
          std::abs(own.stiffness) * (speeds + 0.25 * acting_ * accelerations) + std::abs(own.damping) * accelerations;
    }
  }
  // Where a motion passes its origin, places round by what speeds make of them.
  const double places = row_size(model_.displacement_row) + 0.25 * acting_ * speeds;
  const double size = std::abs(guard.constant) + std::abs(guard.y) * places +
                      std::abs(guard.v) * row_size(model_.velocity_row) + std::abs(guard.force * force) +
                      std::abs(guard.drive) * drive_speed;
  double second = 0.0;
  const bool linear = guard.force != 0.0 && !held(step_modes_, c);
  if (guard.v == 0.0 && guard.drive == 0.0 && (guard.force == 0.0 || (linear && own.damping == 0.0))) {
    const double by_force = linear ? guard.force * own.stiffness : 0.0, by_place = guard.y - by_force;
    second = by_place * acceleration + (own.follows ? by_force * a : 0.0);
    if (std::abs(second) <= kFlat * (std::abs(by_place) + std::abs(by_force)) * accelerations) second = 0.0;
  }
  return {.value = guard.value(y, v, force, V),
          .rate = guard.y * v + guard.v * acceleration + guard.force * force_rate + guard.drive * a,
          .second = second,
          .size = size,
          .rate_size = std::max(model_.fastest, 1.0 / acting_) * size + std::abs(guard.y) * speeds +
                       (std::abs(guard.v) + std::abs(guard.drive)) * accelerations +
                       std::abs(guard.force) * force_rate_size};
}

Eigen::RowVectorXd CollocationFlow::own_force_gradient(int c) const {
  const auto i = static_cast<std::size_t>(c);
  const OwnForce& own = own_forces_[i];
  const Eigen::Index size = 2 * model_.np;
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(size + point_.internal.size());
  if (own.follows)
    gradient(size + own_at_[i]) = own.stiffness;
  else
    gradient.head(size) = -own.stiffness * model_.displacement_row.col(c) - own.damping * model_.velocity_row.col(c);
  return gradient;
}

Eigen::RowVectorXd CollocationFlow::gradient(const OwnGuard& guard, int c) const {
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(2 * model_.np + point_.internal.size());
  gradient.head(2 * model_.np) = guard.y * model_.displacement_row.col(c) + guard.v * model_.velocity_row.col(c);
  if (guard.force == 0.0) return gradient;
  return gradient + guard.force * (held(step_modes_, c) ? held_force_gradient(c) : own_force_gradient(c));
}

void CollocationFlow::slave_stretches() {
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws()[i].kind != LawKind::kCompliant || point_.modes[i] == ContactMode::kStick) continue;
    auto row = tangents_.row(2 * model_.np + own_at_[i]);
    if (point_.modes[i] == ContactMode::kSeparated)
      row.setZero();
    else
      row = (resolver_.slide_stretch_gradient(point_, c) * tangents_).eval();
  }
}

}  // namespace slipmode::dynamics
