#include "dynamics/closed_form_flow.hpp"

#include "core/errors.hpp"
#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// A guard that cannot be told from zero beyond this share of its scale touches it.
constexpr double kTouching = 1e-12;
/// A guard that may vanish after more than this share of a window is approached before the window is refined.
constexpr double kWorthwhile = 0.05;
/// The part of a proved interval that is used, to leave room for the rounding of its end.
constexpr double kUsed = 1.0 - 1e-5;
/// Phase below which the energy audit uses one short rule.
constexpr double kShortRest = 0.25;
constexpr int kNewtonSteps = 20;
/// The next window is longer when the least value of every guard is this many times what was left out.
constexpr double kSpareToGrow = 32.0;
constexpr int kLargestGrowth = 4;
constexpr int kHalvings = 3;

}  // namespace

ClosedFormFlow::ClosedFormFlow(const HybridSystem& system, HybridPoint start, const FlowOptions& options)
    : system_(system),
      slipping_(system.cache().tables(system, false).model),
      resolver_(system, slipping_, options),
      options_(options),
      nc_(slipping_.contacts),
      point_(std::move(start)),
      exempt_until_(static_cast<std::size_t>(nc_), -std::numeric_limits<double>::infinity()) {
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  resolver_.start(point_);
  enter_regime();
}

bool ClosedFormFlow::has_guard(int c) const { return resolver_.laws()[static_cast<std::size_t>(c)].sticks(); }

void ClosedFormFlow::enter_regime() {
  std::vector<bool> stuck;
  for (const ContactMode mode : point_.modes) stuck.push_back(mode == ContactMode::kStick);
  const auto known = std::find_if(visited_.begin(), visited_.end(), [&](const auto& v) { return v.first == stuck; });
  if (known == visited_.end()) {
    tables_ = &system_.cache().regime(system_, stuck);
    visited_.emplace_back(stuck, tables_);
    ++statistics_.regimes_built;
  } else {
    tables_ = known->second;
  }
  const Regime& r = tables_->regime();
  x_.noalias() = r.from_slipping * point_.x;
  inputs_.resize(r.inputs());
  for (int c = 0; c < nc_; ++c)
    inputs_(c) = r.stuck[static_cast<std::size_t>(c)]
                     ? dot_padded(slipping_.displacement_row.col(c).data(), point_.x.data(), 2 * slipping_.np)
                     : point_.force(c);
  inputs_(r.speed_input()) = resolver_.drive().velocity(point_.time);
  inputs_(r.speed_input() + 1) = resolver_.drive().acceleration(point_.time);
  inputs_(r.speed_input() + 2) = 1.0;
  amplitude_.resize(r.pairs.np);
  measure_amplitudes();
  foresee_starts();
}

void ClosedFormFlow::measure_amplitudes() {
  const Regime& r = tables_->regime();
  const auto np = r.pairs.np;
  for (Eigen::Index i = 0; i < np; i += kLanes) {
    V8 a = load8(x_.data() + i), b = load8(x_.data() + np + i);
    const double* particular = r.particular.data() + i;
    for (Eigen::Index k = 0; k < inputs_.size(); ++k, particular += 2 * np) {
      a -= load8(particular) * inputs_(k);
      b -= load8(particular + np) * inputs_(k);
    }
    a *= load8(r.scale1.data() + i);
    b *= load8(r.scale2.data() + i);
    store8(amplitude_.data() + i, (a < 0.0 ? -a : a) + (b < 0.0 ? -b : b));
  }
}

void ClosedFormFlow::foresee_starts() {
  // Sliding that starts now has a guard that starts at zero. Taylor's theorem says for how long it is sure to stay
  // positive: g ≥ g′t − M₂t²/2 (or g″t²/2 − M₃t³/6 when g′ vanishes); half of that time is used.
  const Regime& r = tables_->regime();
  const double tiny = 1e-9 / r.rate;
  double shortest = std::numeric_limits<double>::infinity();
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const bool stuck = point_.modes[i] == ContactMode::kStick;
    double sign = sign_of(point_.modes[i]);
    if (!has_guard(c)) continue;
    if (stuck) {
      // A stick force that starts at its limit and leaves it inwards is no release.
      const double force = point_.force(c), limit = resolver_.laws()[i].static_limit;
      if (std::abs(force) < limit * (1.0 - 1e-9)) continue;
      sign = force > 0 ? 1.0 : -1.0;
    } else if (point_.multiplicity[i] == 0) {
      continue;
    }
    // Guard: sign (V − output) sliding, limit − sign · output in stick.
    const double belt_rate = stuck ? 0.0 : inputs_(r.speed_input() + 1);
    const double g1 = sign * (belt_rate - r.row1.col(c).dot(x_) - r.coefficient1.col(c).dot(inputs_));
    const double g2 = -sign * (r.row2.col(c).dot(x_) + r.coefficient2.col(c).dot(inputs_));
    const double third = std::abs(r.polynomial3.col(c).dot(inputs_));
    const double m3 = r.weight3.col(c).dot(amplitude_) + third;
    const double m2 = r.weight2.col(c).dot(amplitude_) + std::abs(r.polynomial2.col(c).dot(inputs_)) + third / r.rate;
    double clear = 0.0;
    if (g1 > 0 && (stuck || point_.multiplicity[i] == 1)) clear = std::min(g1 / m2, 1.0 / r.rate);
    if (!stuck && point_.multiplicity[i] == 2 && g2 > 0) clear = std::min(1.5 * g2 / m3, 1.0 / r.rate);
    if (stuck && clear == 0.0) continue;  // rising through its limit: an event at once
    clear = std::max(clear, tiny);
    exempt_until_[i] = point_.time + clear;
    shortest = std::min(shortest, clear);
  }
  if (shortest < std::numeric_limits<double>::infinity())
    level_ = tables_->level_covering(shortest);
  else
    level_ = std::min(std::max(level_, tables_->level_covering(4.0 / r.rate)), RegimeTables::kLevels - 1);
}

void ClosedFormFlow::judge(const BernsteinPolynomial& guard, double remainder, double tolerance, int contact,
                           Search& found) const {
  found.spare = std::min(found.spare, 1.0);
  Search here;
  here.contact = contact;
  here.spare = found.spare;
  here.resolved = remainder <= tolerance;
  std::optional<FirstRoot> root;
  if (here.resolved) root = first_root(guard);
  if (!root || root->touching) {
    BernsteinPolynomial low = guard;
    for (int k = 0; k < kNodes; ++k) low.coefficient[static_cast<std::size_t>(k)] -= remainder;
    root = first_root(low);
    if (!root) return;
    here.touching = here.resolved;
  }
  here.at = root->at;
  if (!here.resolved) here.refinement = 1 + std::min(8, std::ilogb(remainder / tolerance) / 8);
  here.alone = found.contact < 0;
  if (found.contact < 0 || here.at < found.at) found = here;
  found.alone = here.alone;
}

ClosedFormFlow::Search ClosedFormFlow::search(int level) const {
  const Regime& r = tables_->regime();
  const RegimeWindow& w = tables_->window(level);
  const auto np = r.pairs.np, ni = r.inputs();
  const double h = tables_->length(level);
  const double V = inputs_(r.speed_input()), a = inputs_(r.speed_input() + 1);
  Search found;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (!has_guard(c) || exempt_until_[i] > begin_) continue;
    V8 output = node_sums(w.from_state.data() + 8 * 2 * np * c, x_.data(), 2 * np) +
                node_sums(w.from_inputs.data() + 8 * ni * c, inputs_.data(), ni);
    const double remainder = dot_padded(w.remainder.col(c).data(), amplitude_.data(), np);
    BernsteinPolynomial guard;
    guard.degree = kNodes - 1;
    alignas(64) double lanes[kNodes];
    const auto consider = [&](const V8& values, double tolerance) {
      const double least = min8(values);
      if (least > remainder || stays_above(values, remainder, kHalvings)) {
        found.spare = std::min(found.spare, std::max(least, 0.0) / std::max(remainder, 1e-300));
        return;
      }
      store8(lanes, values);
      std::copy_n(lanes, kNodes, guard.coefficient.begin());
      judge(guard, remainder, tolerance, c, found);
    };
    if (r.stuck[i]) {
      const double limit = resolver_.laws()[i].static_limit;
      consider(limit - output, kTouching * limit);
      consider(limit + output, kTouching * limit);
    } else {
      static constexpr V8 kRamp = {0.0, 1.0 / 7, 2.0 / 7, 3.0 / 7, 4.0 / 7, 5.0 / 7, 6.0 / 7, 1.0};
      const V8 speed = sign_of(point_.modes[i]) * (V + (a * h) * kRamp - output);
      const double scale = std::abs(V) + r.weight.col(c).dot(amplitude_) +
                           slipping_.mobility(c, c) * resolver_.laws()[i].static_limit / r.rate;
      consider(speed, kTouching * scale);
    }
  }
  return found;
}

bool ClosedFormFlow::approach(int c, double& tau) {
  // Newton on the exact guard, from a time at which it is not yet reached.
  const Regime& r = tables_->regime();
  const auto i = static_cast<std::size_t>(c);
  const double sign = r.stuck[i] ? (r.output(c, x_, inputs_) > 0 ? 1.0 : -1.0) : sign_of(point_.modes[i]);
  const double belt_rate = r.stuck[i] ? 0.0 : inputs_(r.speed_input() + 1);
  const double from = tau;
  double slope = 0.0;
  for (int k = 0; k < kNewtonSteps; ++k) {
    const double value = r.stuck[i] ? resolver_.laws()[i].static_limit - sign * r.output(c, x_, inputs_)
                                    : sign * (inputs_(r.speed_input()) - r.output(c, x_, inputs_));
    slope = sign *
            (belt_rate - dot_padded(r.row1.col(c).data(), x_.data(), x_.size()) - r.coefficient1.col(c).dot(inputs_));
    const double shift = -value / slope;
    if (!(slope < 0.0) || !(std::abs(shift) * r.rate < 2.0) || tau + shift < 0.0) return false;
    tau += shift;
    advance(*tables_, shift, x_, inputs_);
    // Newton squares its error, with a factor of about the guard's curvature by its slope.
    if (std::abs(shift) * r.rate < 1e-15 || shift * shift * curvature(c) < 1e-15 / r.rate * std::abs(slope)) break;
  }
  // The guard falls all the way from `from`: it vanishes here for the first time.
  return tau <= from || (tau - from) * curvature(c) < std::abs(slope);
}

double ClosedFormFlow::curvature(int c) const {
  const Regime& r = tables_->regime();
  return r.weight2.col(c).dot(amplitude_) + std::abs(r.polynomial2.col(c).dot(inputs_begin_)) +
         std::abs(r.polynomial3.col(c).dot(inputs_begin_)) * tables_->length(level_);
}

bool ClosedFormFlow::step(double t_limit) {
  resolver_.clear();
  begin_ = point_.time;
  step_tables_ = tables_;
  double limit = t_limit;
  bool corner = false;
  if (!resolver_.drive().is_constant()) {
    if (const auto t = resolver_.drive().next_corner(begin_); t && *t <= limit) {
      limit = *t;
      corner = true;
    }
  }
  double end = limit;
  for (const double until : exempt_until_)
    if (until > begin_) end = std::min(end, until);
  const double remaining = end - begin_;

  measure_amplitudes();
  Search found;
  double h = 0.0, tau = 0.0;
  for (;;) {
    h = tables_->length(level_);
    found = search(level_);
    const bool finest = level_ + 1 >= RegimeTables::kLevels || !(begin_ + h > begin_);
    if (found.contact < 0 || found.at * h >= remaining) {
      found.contact = -1;
      tau = std::min(h, remaining);
      break;
    }
    tau = found.at * h;
    found.resolved |= finest;
    if (found.resolved || found.at > kWorthwhile) break;
    level_ = std::min(level_ + found.refinement, RegimeTables::kLevels - 1);
    ++statistics_.rejected;
  }
  x_begin_ = x_;
  inputs_begin_ = inputs_;
  if (found.contact >= 0 && !found.touching) {
    // Up to the part that is proved clear; from there Newton, which may prove itself.
    if (!found.resolved) tau *= kUsed;
    advance(*tables_, tau, x_, inputs_);
    double root = tau;
    const bool proved = approach(found.contact, root);
    if (proved ? root <= std::min(h, remaining) && (found.alone || found.resolved) : found.resolved) {
      tau = root;
    } else {
      x_ = x_begin_;
      inputs_ = inputs_begin_;
      advance(*tables_, tau, x_, inputs_);
      found.contact = -1;
      level_ = std::min(level_ + found.refinement, RegimeTables::kLevels - 1);
    }
  } else {
    advance(*tables_, tau, x_, inputs_);
  }
  point_.time = tau == remaining ? end : begin_ + tau;
  ++statistics_.steps;
  if ((x_.size() > 0 && !std::isfinite(x_(0))) || !std::isfinite(point_.time)) {
    lift(tables_->regime(), x_begin_, inputs_begin_, point_.x, point_.force);
    throw NumericalFailure("the state is no longer finite at t = " + std::to_string(begin_), begin_, point_.x,
                           std::numeric_limits<double>::quiet_NaN());
  }
  for (std::size_t c = 0; c < point_.modes.size(); ++c)
    if (point_.modes[c] == ContactMode::kStick) statistics_.stick_time[c] += tau;
  if (options_.audit) account(tau);

  if (found.contact >= 0) return settle(found.contact, found.touching);
  if (found.spare > kSpareToGrow) {
    const int growth = std::clamp(std::ilogb(found.spare) / 8, 1, kLargestGrowth);
    level_ = std::max(0, level_ - growth);
  }
  if (point_.time < limit) return false;
  if (corner) return settle(-1, false);
  lift(tables_->regime(), x_, inputs_, point_.x, point_.force);
  return false;
}

bool ClosedFormFlow::settle(int contact, bool touching) {
  lift(tables_->regime(), x_, inputs_, point_.x, point_.force);
  const double window_end = begin_ + tables_->length(level_);
  resolver_.settle(point_, contact, touching);
  statistics_.events += static_cast<std::int64_t>(resolver_.events().size());
  std::fill(exempt_until_.begin(), exempt_until_.end(), -std::numeric_limits<double>::infinity());
  if (touching)
    exempt_until_[static_cast<std::size_t>(contact)] = std::max(window_end, std::nextafter(point_.time, 1e300));
  else
    enter_regime();
  return true;
}

void ClosedFormFlow::lift(const Regime& r, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
                          Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  out_x.noalias() = r.to_slipping * x;
  out_x.noalias() += r.inputs_slipping * inputs;
  out_force.resize(nc_);
  for (int c = 0; c < nc_; ++c)
    out_force(c) = r.stuck[static_cast<std::size_t>(c)] ? r.output(c, x, inputs) : inputs(c);
}

void ClosedFormFlow::evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  const Regime& r = step_tables_->regime();
  Eigen::VectorXd x = x_begin_, inputs = inputs_begin_;
  advance(*step_tables_, std::max(0.0, t - begin_), x, inputs);
  lift(r, x, inputs, out_x, out_force);
}

void ClosedFormFlow::account(double tau) {
  const RegimeTables& tables = *tables_;
  const Regime& r = tables.regime();
  double contact = 0.0, drive = 0.0, viscous = 0.0;
  const auto add = [&](double weight, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) {
    const double V = inputs(r.speed_input());
    for (int c = 0; c < nc_; ++c) {
      const double output = r.output(c, x, inputs);
      const bool held = r.stuck[static_cast<std::size_t>(c)];
      const double force = held ? output : inputs(c);
      contact += weight * force * (held ? V : output);
      drive += weight * force * V;
    }
    viscous += weight * r.viscous_power(x, V);
  };
  const auto move_to = [&](const RegimeStep& s, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
                           Eigen::VectorXd& out_x, Eigen::VectorXd& out_inputs) {
    apply(s, x.data(), inputs, out_x.data());
    out_inputs = inputs;
    r.advance_inputs(out_inputs, s.h);
  };
  Eigen::VectorXd x = x_begin_, inputs = inputs_begin_, at_x(x.size()), at_inputs(inputs.size());
  for (int level = RegimeTables::kAuditLevel; level < RegimeTables::kLevels && r.rate * tau > kShortRest;) {
    const double h = tables.length(level);
    if (h > tau) {
      ++level;
      continue;
    }
    const RegimeAudit& audit = tables.audit(level);
    for (Eigen::Index j = 0; j < audit.rule.node.size(); ++j) {
      move_to(audit.point[static_cast<std::size_t>(j)], x, inputs, at_x, at_inputs);
      add(h * audit.rule.weight(j), at_x, at_inputs);
    }
    move_to(tables.step(level), x, inputs, at_x, at_inputs);
    x.swap(at_x);
    inputs.swap(at_inputs);
    tau -= h;
  }
  static const GaussRule rule = gauss_rule(5);
  if (tau > 0.0)
    for (Eigen::Index j = 0; j < rule.node.size(); ++j) {
      at_x = x;
      at_inputs = inputs;
      advance(tables, rule.node(j) * tau, at_x, at_inputs);
      add(rule.weight(j) * tau, at_x, at_inputs);
    }
  work_.add(contact, drive, viscous);
}

}  // namespace slipmode::dynamics
