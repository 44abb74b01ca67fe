#include "dynamics/collocation_flow.hpp"
#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// An event's time is final when the next correction is below this share of the step.
constexpr double kNegligibleShift = 1e-15;
/// A stick force starts at its limit when it is this close (relative).
constexpr double kAtLimit = 1e-10;
/// Right after sliding has begun, a guard that vanishes within this share of a step is an error of interpolation.
constexpr double kEarly = 1.0 / 64.0;
/// Halvings tried to show that a stick force stays below its limit.
constexpr int kMarginHalvings = 2;
/// Shifts below this share of the step are made by two terms of Taylor's series.
constexpr double kShortShift = 1e-7;
constexpr int kRefinements = 20;

}  // namespace

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
        if (!stays_above(margin, 0.0, kMarginHalvings)) consider(margin, 0.0, kNodes - 1, c, 0);
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

}  // namespace slipmode::dynamics
