#include "dynamics/internal/collocation_flow.hpp"

#include <slipmode/friction/characteristic.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// An event's time is final when the next correction is below this share of the step.
constexpr double kNegligibleShift = 1e-15;
/// Events that are less than this share of a step apart come in either order.
constexpr double kEitherOrder = 1e-12;
/// Right after sliding has begun, a guard that vanishes within this share of a step is an error of interpolation.
constexpr double kEarly = 1.0 / 64.0;
/// A step that starts with more than this share of its largest speed does not start at rest.
constexpr double kOwnStart = 0.1;
/// A guard's Bernstein form rounds by this share of the terms that are summed at the nodes.
constexpr double kFormRounds = 1e-12;
/// A stick's form below this share of its limit stays below, whatever a step's forces round by.
constexpr double kFarBelow = 0.999;
/// Halvings tried to show that a stick force stays below its limit.
constexpr int kMarginHalvings = 2;
constexpr int kRefinements = 20;

}  // namespace

CollocationFlow::FirstGuards CollocationFlow::first_guards() {
  FirstGuards out;
  const auto consider = [&](const BernsteinPolynomial& p, int c) {
    if (const auto root = first_root(p)) out.add({root->at, c, root->touching});
  };
  const RadauTables& t = nodes_;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = laws()[i];
    told_by_states_[i] = false;
    if (elaborate(c)) {
      if (held(point_.modes, c)) tell_by_states(c);
      search_own_guards(c, out);
      continue;
    }
    if (!law.sticks() && !bristled(c)) continue;
    BernsteinPolynomial p;
    double* guard = guard_forms_.data() + kNodes * c;
    if (point_.modes[i] == ContactMode::kStick) {
      double most = kernels_.force_guard(t.bernstein7.data(), forces_.data() + kNodes * c, guard);
      if (most < law.static_limit * kFarBelow) continue;
      tell_by_states(c);
      if (told_by_states_[i]) most = kernels_.force_guard(t.bernstein7.data(), told_forces(c).data(), guard);
      if (most < law.static_limit * (1.0 - kAtLimit)) continue;
      p.degree = kNodes - 1;
      for (const double sign : {1.0, -1.0}) {
        std::array<double, kNodes> margin;
        for (std::size_t k = 0; k < kNodes; ++k) margin[k] = law.static_limit - sign * guard[k];
        margin[0] = or_at_limit(margin[0], law);
        if (stays_above(margin, 0.0, kMarginHalvings)) continue;
        std::ranges::copy(margin, p.coefficient.begin());
        consider(p, c);
      }
      continue;
    }
    const double sign = sign_of(point_.modes[i]);
    int multiplicity = point_.multiplicity[i];
    if ((multiplicity > 0 || bristled(c)) && unmoved(c)) {
      guard_start_(c) = guard_least_(c) = 0.0;
      guard_forms_.segment<kNodes>(kNodes * c).setZero();
      continue;
    }
    double start = std::max(0.0, sign * (drive().velocity(begin_) - resolver_.contact_velocity(c, x_begin_.data())));
    // A speed that was called rounding may be one: beside it, a start at zero would be a jump.
    if (multiplicity > 0 && start > kOwnStart * fastest_at_nodes(c)) multiplicity = 0;
    if (multiplicity > 0) start = 0.0;
    double least = kernels_.speed_guard(t.bernstein8.data(), t.bernstein8_start.data(), start, sign,
                                        drive_nodes_.data() + kNodes * c, velocity_.data() + kNodes * c, guard);
    guard_start_(c) = start;
    guard_least_(c) = std::min(start, least);
    if (multiplicity == 2) least = *std::min_element(guard + 1, guard + kNodes);  // the first is zero: see below
    if (least > 0.0) continue;
    p.degree = kNodes;
    p.coefficient[0] = start;
    std::copy_n(guard, kNodes, p.coefficient.begin() + 1);
    // Zero by the order of contact, whatever rounding says.
    std::fill_n(p.coefficient.begin(), multiplicity, 0.0);
    consider(p, c);
  }
  return out;
}

bool CollocationFlow::unmoved(int c) const {
  // So soon after its start that sliding has no speed beyond rounding, and its sign means nothing. Where all is at
  // rest, that is of what forces in balance would make of it in the step.
  const double share = bristled(c) ? kUnmoved : kFormRounds;
  return fastest_at_nodes(c) <= share * (velocity_scale(c, x_begin_) + balanced(c) * tables_.step(step_level_));
}

double CollocationFlow::balanced(int c) const {
  return model_.acceleration_row.col(c).cwiseAbs().dot(x_begin_.cwiseAbs()) +
         model_.mobility.row(c).cwiseAbs().dot(point_.force.cwiseAbs());
}

double CollocationFlow::fastest_at_nodes(int c) const {
  return (drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c)).cwiseAbs().maxCoeff();
}

double CollocationFlow::velocity_scale(int c, const Eigen::VectorXd& x) const {
  // Rounding of the time changes V.
  const double scale = std::abs(drive().velocity(begin_)) + std::abs(drive().acceleration(begin_) * begin_) +
                       model_.velocity_row.col(c).cwiseAbs().dot(x.cwiseAbs());
  if (!bristled(c)) return scale;
  // Where a bristle is at rest, speeds are what forces in balance leave: those of the structure, and of the contacts.
  const double way = model_.displacement_row.col(c).cwiseAbs().dot(x.cwiseAbs());
  const auto reach = (model_.mobility(c, c) * model_.mobility.diagonal()).cwiseSqrt();
  return scale + model_.fastest * way + reach.dot(point_.force.cwiseAbs()) * acting_;
}

bool CollocationFlow::too_early(const Guarded& guard) const {
  if (guard.contact < 0 || !(guard.theta < kEarly)) return false;
  // A slope that is known says when a guard falls at once.
  return guard.own ? guard.order == 2 || (guard.order == 1 && guard.theta > 0.0)
                   : point_.multiplicity[static_cast<std::size_t>(guard.contact)] > 0;
}

double CollocationFlow::deepest_overshoot() const {
  double deepest = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws()[i].kind != LawKind::kSpeedDependent || point_.modes[i] == ContactMode::kStick) continue;
    const double sign = sign_of(point_.modes[i]);
    const friction::Characteristic* own = laws()[i].characteristic.get();
    for (int j = kNodes * c; j < kNodes * (c + 1); ++j) {
      const double past = sign * (velocity_(j) - drive_nodes_(j));
      if (own == nullptr)
        deepest = std::max(deepest, laws()[i].alpha * past);
      else if (past > 0.0)
        deepest = std::max(deepest, laws()[i].load * std::abs(own->mu(-past) - own->mu(0.0)) * over_scale(c));
    }
  }
  return deepest;
}

void CollocationFlow::refine_event(const Guarded& guard, double& tau, Eigen::VectorXd& x) {
  // Newton on the guard's exact value; the polynomial that announced it was only close.
  if (guard.touching) return;
  const double h = tables_.step(step_level_);
  const int c = guard.contact;
  const auto i = static_cast<std::size_t>(c);
  double previous = 0.0;
  for (int iteration = 0; iteration < kRefinements; ++iteration) {
    const double a = drive_acceleration(begin_, tau), V = drive_velocity(begin_, tau);
    const RadauTables::Vector8 basis = nodes_.lagrange(tau / h);
    double value = 0.0, rate = 0.0, usual_rate = 0.0;
    if (guard.own) {
      const GuardValue now = evaluate(*guard.own, c, tau, x);
      value = now.value;
      rate = now.rate;
      usual_rate = now.size / h;
    } else if (point_.modes[i] == ContactMode::kStick) {
      const auto forces = told_forces(c);
      const double sign = forces.dot(basis) > 0 ? 1.0 : -1.0;
      value = laws()[i].static_limit - sign * stick_force(c, x, tau);
      rate = -sign * forces.dot(nodes_.lagrange_slope(tau / h)) / h;
      usual_rate = forces.cwiseAbs().maxCoeff() / h;
    } else {
      const double sign = sign_of(point_.modes[i]);
      value = sign * (V - resolver_.contact_velocity(c, x.data()));
      rate = sign * (a - contact_acceleration(c, x, tau, basis));
      usual_rate = std::max(model_.mobility(c, c) * laws()[i].most(), balanced(c));
    }
    const double shift = -value / rate;
    if (!(std::abs(shift) < 1e-2 * h) || tau + shift <= 0.0) return;
    if (std::abs(shift) <= kNegligibleShift * h) {
      tau += shift;
      return;
    }
    within_.shift(tau, shift, x.data());
    tau += shift;
    // Newton squares its error; the factor shows in two shifts, and before that is bounded by a usual curvature.
    const double factor =
        previous > 0.0 ? std::abs(shift) / (previous * previous) : std::max(1.0, std::abs(usual_rate / rate)) / h;
    if (factor * shift * shift <= kNegligibleShift * h) return;
    previous = std::abs(shift);
  }
}

void CollocationFlow::refine_first(FirstGuards& guards, double& tau, Eigen::VectorXd& x) {
  refine_event(guards.first, tau, x);
  // Its form announces a guard's zero a little off, and that of a bristle's speed that is rounding by a share of a
  // step.
  const double h = tables_.step(step_level_);
  for (const Guarded& other : guards.others) {
    double before = other.theta * h;
    if (before >= tau + kAnnounced * h || too_early(other)) continue;
    Eigen::VectorXd x_before(x.size());
    within_.state(before, x_before.data());
    refine_event(other, before, x_before);
    if (!(before < tau - kEitherOrder * h)) continue;
    guards.first = other;
    tau = before;
    x.swap(x_before);
  }
}

double CollocationFlow::acceleration_without_contacts(int c, const Eigen::VectorXd& x, double tau) const {
  return kernels_.dot(model_.acceleration_row.col(c).data(), x.data(), 2 * model_.np) + model_.load_acceleration(c) +
         given_acceleration(c, tau);
}

double CollocationFlow::contact_acceleration(int c, const Eigen::VectorXd& x, double tau,
                                             const RadauTables::Vector8& basis) const {
  double acceleration = acceleration_without_contacts(c, x, tau);
  for (int d = 0; d < nc_; ++d) acceleration += model_.mobility(c, d) * forces_.segment<kNodes>(kNodes * d).dot(basis);
  return acceleration;
}

double CollocationFlow::acceleration_at_start(int c) const {
  return acceleration_without_contacts(c, x_begin_, 0.0) + model_.mobility.row(c).dot(point_.force);
}

double CollocationFlow::stick_force(int c, const Eigen::VectorXd& x, double tau) const {
  if (nc_ == 1)
    return (drive_acceleration(begin_, tau) - acceleration_without_contacts(0, x, tau)) / model_.mobility(0, 0);
  return forces_within(tau, x)(c);
}

}  // namespace slipmode::dynamics
