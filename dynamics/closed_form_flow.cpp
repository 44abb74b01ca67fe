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
/// A guard below this share of its scale when a regime begins starts at zero …
constexpr double kStarting = 1e-9;
/// … and with zero slope, if that is below this share of its scale times the fastest rate.
constexpr double kSimpleStart = 1e-9;
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
      point_(std::move(start)) {
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  for (int c = 0; c < nc_; ++c) {
    const friction::Contact& contact = system.contacts()[static_cast<std::size_t>(c)];
    if (resolver_.laws()[static_cast<std::size_t>(c)].stiffness > 0.0) compliant_.push_back(c);
    if (contact.normal_load.oscillator) {
      const Eigen::Index end = system.internal_begin(c) + friction::internal_states(contact);
      oscillator_states_.insert(oscillator_states_.end(), {end - 2, end - 1});
    }
  }
  resolver_.start(point_);
  enter_regime();
}

void ClosedFormFlow::restart(HybridPoint start) {
  point_ = std::move(start);
  resolver_.forget();
  carries_ = false;
  work_ = {};
  statistics_ = {};
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  level_ = 0;
  resolver_.start(point_);
  enter_regime();
}

void ClosedFormFlow::enter_regime() {
  const std::vector<ContactRole> roles = resolver_.roles(point_.modes);
  const auto known = std::find_if(visited_.begin(), visited_.end(), [&](const auto& v) { return v.roles == roles; });
  if (known == visited_.end()) {
    const RegimeTables& tables = system_.cache().regime(system_, roles);
    visited_.push_back({roles, &tables, nullptr, nullptr, nullptr});
    Visited& now = visited_.back();
    if (resolver_.drive().belt() == nullptr) {
      now.overlay = std::make_unique<DriveOverlay>(tables.regime(), resolver_.drive());
      if (options_.audit) now.forms = AuditForms::make(tables.regime(), *now.overlay);
    }
    regime_ = &now;
    ++statistics_.regimes_built;
  } else {
    regime_ = &*known;
  }
  tables_ = regime_->tables;
  const Regime& r = tables_->regime();
  const DriveOverlay* overlay = regime_->overlay.get();
  const DrivePhase phase = overlay ? phase_at(point_.time) : DrivePhase{};

  inputs_ = Eigen::VectorXd::Zero(r.inputs());
  for (int c = 0; c < nc_; ++c) inputs_(c) = resolver_.regime_input(point_, c);
  if (!overlay) {
    inputs_(r.speed_input()) = resolver_.drive().velocity(point_.time);
    inputs_(r.speed_input() + 1) = resolver_.drive().acceleration(point_.time);
  }
  inputs_(r.speed_input() + 2) = 1.0;
  x_.noalias() = r.from_slipping * point_.x;
  if (!oscillator_states_.empty())
    x_.noalias() += r.from_oscillators * Eigen::VectorXd(point_.internal(oscillator_states_));
  if (overlay) {
    for (Eigen::Index c = 0; c < nc_; ++c) inputs_(c) -= overlay->inputs.at(c, phase);
    overlay->state.add(phase, -1.0, x_);
  }
  if (regime_->forms) regime_->forms->begin(point_.time, x_, inputs_);
  amplitude_.resize(r.pairs.np);
  measure_amplitudes();
  set_guards();
  foresee_starts();
}

void ClosedFormFlow::set_guards() {
  guards_.clear();
  const std::vector<RegimeOutput>& outputs = tables_->regime().outputs;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const int c = outputs[k].contact;
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = resolver_.laws()[i];
    Guard guard{static_cast<Eigen::Index>(k), c};
    switch (outputs[k].kind) {
      case RegimeOutput::Kind::kSpeed:
        guard.sign = sign_of(point_.modes[i]);
        break;
      case RegimeOutput::Kind::kForce:
        guard.constant = law.limit(-1.0);
        guards_.push_back(guard);
        guard.constant = law.limit(1.0);
        guard.sign = -1.0;
        break;
      case RegimeOutput::Kind::kLoad:
        guard.kind = GuardKind::kLoad;
        guard.sign = point_.modes[i] == ContactMode::kSeparated ? -1.0 : 1.0;
        break;
      case RegimeOutput::Kind::kExcess:
      case RegimeOutput::Kind::kReserve:
        break;
      case RegimeOutput::Kind::kDisplacement:
      case RegimeOutput::Kind::kPress:
        add_clearance_guards(guard, outputs[k].kind);
        continue;
    }
    guards_.push_back(guard);
  }
}

void ClosedFormFlow::add_clearance_guards(const Guard& of_output, RegimeOutput::Kind kind) {
  const auto i = static_cast<std::size_t>(of_output.contact);
  const friction::Clearance& law = resolver_.laws()[i].clearance;
  const ContactMode mode = point_.modes[i];
  const auto add = [&](double sign, double constant, ContactMode next) {
    Guard guard = of_output;
    guard.kind = GuardKind::kStop;
    guard.sign = sign;
    guard.constant = constant;
    guard.next = next;
    guards_.push_back(guard);
  };
  const bool left = mode == ContactMode::kLeftStop || mode == ContactMode::kLeftFlight;
  if (mode == ContactMode::kGap) {
    if (law.right) add(-1.0, law.right->gap, ContactMode::kRightStop);
    if (law.left) add(1.0, law.left->gap, ContactMode::kLeftStop);
  } else if (kind == RegimeOutput::Kind::kDisplacement) {
    if (left)
      add(-1.0, -law.left->gap, ContactMode::kGap);
    else
      add(1.0, -law.right->gap, ContactMode::kGap);
  } else if (mode == ContactMode::kLeftFlight || mode == ContactMode::kRightFlight) {
    add(-1.0, 0.0, left ? ContactMode::kLeftStop : ContactMode::kRightStop);
  } else {
    // Without damping the force vanishes where the gap begins: there is no flight beyond it.
    const bool damped = (left ? law.left : law.right)->damping > 0.0;
    add(1.0, 0.0, !damped ? ContactMode::kGap : left ? ContactMode::kLeftFlight : ContactMode::kRightFlight);
  }
}

double ClosedFormFlow::scale(const Guard& guard) const {
  const Regime& r = tables_->regime();
  const RegimeOutput& output = r.outputs[static_cast<std::size_t>(guard.output)];
  const ContactForces& law = resolver_.laws()[static_cast<std::size_t>(guard.contact)];
  if (output.kind == RegimeOutput::Kind::kForce) return law.static_limit;
  if (guard.kind == GuardKind::kStop) {
    // Not by amplitudes: a slow drift through the gap has a large one.
    double size = std::abs(guard.constant) + r.row.col(guard.output).cwiseAbs().dot(x_.cwiseAbs()) +
                  r.coefficient.col(guard.output).cwiseAbs().dot(inputs_.cwiseAbs());
    if (regime_->overlay) size += regime_->overlay->outputs.size(guard.output);
    return size;
  }
  double size = r.weight.col(guard.output).dot(amplitude_);
  if (regime_->overlay) size += regime_->overlay->outputs.size(guard.output);
  if (output.kind == RegimeOutput::Kind::kSpeed)
    return size + std::abs(inputs_(r.speed_input())) +
           slipping_.mobility(guard.contact, guard.contact) * law.static_limit / r.rate;
  return size + (guard.kind == GuardKind::kLoad ? law.load : law.static_limit);
}

ClosedFormFlow::GuardValue ClosedFormFlow::evaluate(const Guard& guard, double t) const {
  const Regime& r = tables_->regime();
  const auto k = guard.output;
  double value = r.output(k, x_, inputs_);
  double rate = dot_padded(r.row1.col(k).data(), x_.data(), x_.size()) + r.coefficient1.col(k).dot(inputs_);
  if (const DriveOverlay* overlay = regime_->overlay.get()) {
    const DrivePhase phase = phase_at(t);
    value += overlay->outputs.at(k, phase);
    rate += overlay->omega() * overlay->outputs.rate(k, phase);
  }
  return {guard.constant + guard.sign * value, guard.sign * rate};
}

double ClosedFormFlow::second_derivative(const Guard& guard, double t) const {
  const Regime& r = tables_->regime();
  double second = r.row2.col(guard.output).dot(x_) + r.coefficient2.col(guard.output).dot(inputs_);
  if (const DriveOverlay* overlay = regime_->overlay.get())
    second += overlay->omega() * overlay->omega() * overlay->outputs.bend(guard.output, phase_at(t));
  return guard.sign * second;
}

double ClosedFormFlow::drive_velocity(double t, const Eigen::VectorXd& inputs) const {
  return regime_->overlay ? resolver_.drive().velocity(t) : inputs(tables_->regime().speed_input());
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
  // A guard that starts at zero. Taylor's theorem says for how long it is sure to stay positive: g ≥ g′t − M₂t²/2 (or
  // g″t²/2 − M₃t³/6 when g′ vanishes); half of that time is used.
  const Regime& r = tables_->regime();
  const DriveOverlay* overlay = regime_->overlay.get();
  const double tiny = 1e-9 / r.rate, room = std::exp(r.growth / r.rate);
  double shortest = std::numeric_limits<double>::infinity();
  for (Guard& guard : guards_) {
    const auto i = static_cast<std::size_t>(guard.contact), k = static_cast<std::size_t>(guard.output);
    const ContactForces& law = resolver_.laws()[i];
    const bool rigid_speed =
        r.outputs[k].kind == RegimeOutput::Kind::kSpeed && law.kind == ContactForces::Kind::kConstant && !law.varies;
    const auto [g0, g1] = evaluate(guard, point_.time);
    const double size = scale(guard);
    if (rigid_speed ? point_.multiplicity[i] == 0 : g0 > kStarting * size) continue;
    const double w = overlay ? overlay->omega() : 0.0;
    const double harmonic2 = overlay ? w * w * overlay->outputs.size(guard.output, 2) : 0.0;
    const double harmonic3 = overlay ? w * w * w * overlay->outputs.size(guard.output, 3) : 0.0;
    const double g2 = second_derivative(guard, point_.time);
    const double third = std::abs(r.polynomial3.col(guard.output).dot(inputs_));
    const double m3 = room * r.weight3.col(guard.output).dot(amplitude_) + third + harmonic3;
    const double m2 = room * r.weight2.col(guard.output).dot(amplitude_) +
                      std::abs(r.polynomial2.col(guard.output).dot(inputs_)) + third / r.rate + harmonic2;
    const bool simple = rigid_speed ? point_.multiplicity[i] == 1 : g1 > kSimpleStart * r.rate * size;
    const bool flat = rigid_speed ? point_.multiplicity[i] == 2 : std::abs(g1) <= kSimpleStart * r.rate * size;
    double clear = 0.0;
    if (simple && g1 > 0) clear = std::min(g1 / m2, 1.0 / r.rate);
    if (flat && g2 > 0) clear = std::min(1.5 * g2 / m3, 1.0 / r.rate);
    if (!rigid_speed && clear == 0.0) continue;  // falling through zero: an event at once
    clear = std::max(clear, tiny);
    guard.exempt_until = point_.time + clear;
    shortest = std::min(shortest, clear);
  }
  if (shortest < std::numeric_limits<double>::infinity())
    level_ = tables_->level_covering(shortest);
  else
    level_ = std::min(std::max(level_, tables_->level_covering(4.0 / r.rate)), RegimeTables::kLevels - 1);
}

void ClosedFormFlow::judge(const BernsteinPolynomial& polynomial, double remainder, double tolerance, int guard,
                           Search& found) const {
  found.spare = std::min(found.spare, 1.0);
  Search here;
  here.guard = guard;
  here.spare = found.spare;
  here.resolved = remainder <= tolerance;
  std::optional<FirstRoot> root;
  if (here.resolved) root = first_root(polynomial);
  if (!root || root->touching) {
    BernsteinPolynomial low = polynomial;
    for (int k = 0; k < kNodes; ++k) low.coefficient[static_cast<std::size_t>(k)] -= remainder;
    root = first_root(low);
    if (!root) return;
    here.touching = here.resolved;
  }
  here.at = root->at;
  if (!here.resolved) here.refinement = 1 + std::min(8, std::ilogb(remainder / tolerance) / 8);
  here.alone = found.guard < 0;
  if (found.guard < 0 || here.at < found.at) found = here;
  found.alone = here.alone;
}

ClosedFormFlow::Search ClosedFormFlow::search(int level) const {
  const Regime& r = tables_->regime();
  const RegimeWindow& w = tables_->window(level);
  const DriveOverlay* overlay = regime_->overlay.get();
  const auto np = r.pairs.np, ni = r.inputs();
  Search found;
  Eigen::Index computed = -1;
  V8 output{};
  double remainder = 0.0;
  for (std::size_t g = 0; g < guards_.size(); ++g) {
    const Guard& guard = guards_[g];
    if (guard.exempt_until > begin_) continue;
    const auto k = guard.output;
    if (k != computed) {
      computed = k;
      output = node_sums(w.from_state.data() + 8 * 2 * np * k, x_.data(), 2 * np) +
               node_sums(w.from_inputs.data() + 8 * ni * k, inputs_.data(), ni);
      remainder = dot_padded(w.remainder.col(k).data(), amplitude_.data(), np);
      if (overlay) {
        // c cos j(θ₀ + ωτ) + s sin j(θ₀ + ωτ) by the window's cos jωτ and sin jωτ.
        DrivePhase p;
        Eigen::Index j = 0;
        for (const DriveOverlay::Window& harmonic : overlay->window(level, tables_->length(level))) {
          p = p.times(phase_);
          const double c = overlay->outputs.c(k, j), s = overlay->outputs.s(k, j);
          output += (c * p.cosine + s * p.sine) * harmonic.cosine + (s * p.cosine - c * p.sine) * harmonic.sine;
          remainder += harmonic.remainder * overlay->outputs.magnitude(k, j);
          ++j;
        }
      }
    }
    const V8 values = guard.constant + guard.sign * output;
    const double least = min8(values);
    if (least > remainder || stays_above(values, remainder, kHalvings)) {
      found.spare = std::min(found.spare, std::max(least, 0.0) / std::max(remainder, 1e-300));
      continue;
    }
    alignas(64) double lanes[kNodes];
    store8(lanes, values);
    BernsteinPolynomial polynomial;
    polynomial.degree = kNodes - 1;
    std::copy_n(lanes, kNodes, polynomial.coefficient.begin());
    judge(polynomial, remainder, kTouching * scale(guard), static_cast<int>(g), found);
  }
  return found;
}

bool ClosedFormFlow::approach(const Guard& guard, double& tau) {
  // Newton on the exact guard, from a time at which it is not yet reached.
  const double rate = tables_->regime().rate, from = tau, bend = curvature(guard.output);
  double slope = 0.0;
  for (int k = 0; k < kNewtonSteps; ++k) {
    const GuardValue now = evaluate(guard, begin_ + tau);
    slope = now.rate;
    const double shift = -now.value / slope;
    if (!(slope < 0.0) || !(std::abs(shift) * rate < 2.0) || tau + shift < 0.0) return false;
    tau += shift;
    advance(*tables_, shift, x_, inputs_);
    // Newton squares its error, with a factor of about the guard's curvature by its slope.
    if (std::abs(shift) * rate < 1e-15 || shift * shift * bend < 1e-15 / rate * std::abs(slope)) break;
  }
  // The guard falls all the way from `from`: it vanishes here for the first time.
  return tau <= from || (tau - from) * bend < std::abs(slope);
}

double ClosedFormFlow::curvature(Eigen::Index output) const {
  const Regime& r = tables_->regime();
  const double h = tables_->length(level_);
  double bend = std::exp(std::min(r.growth * h, 200.0)) * r.weight2.col(output).dot(amplitude_) +
                std::abs(r.polynomial2.col(output).dot(inputs_begin_)) +
                std::abs(r.polynomial3.col(output).dot(inputs_begin_)) * h;
  if (const DriveOverlay* overlay = regime_->overlay.get())
    bend += overlay->omega() * overlay->omega() * overlay->outputs.size(output, 2);
  return bend;
}

bool ClosedFormFlow::step(double t_limit) {
  resolver_.clear();
  begin_ = point_.time;
  step_regime_ = regime_;
  if (regime_->overlay) phase_ = phase_at(begin_);
  double limit = t_limit;
  bool corner = false;
  if (!resolver_.drive().is_constant()) {
    if (const auto t = resolver_.drive().next_corner(begin_); t && *t <= limit) {
      limit = *t;
      corner = true;
    }
  }
  double end = limit;
  for (const Guard& guard : guards_)
    if (guard.exempt_until > begin_) end = std::min(end, guard.exempt_until);
  const double remaining = end - begin_;

  measure_amplitudes();
  Search found;
  double h = 0.0, tau = 0.0;
  for (;;) {
    h = tables_->length(level_);
    found = search(level_);
    const bool finest = level_ + 1 >= RegimeTables::kLevels || !(begin_ + h > begin_);
    if (found.guard < 0 || found.at * h >= remaining) {
      found.guard = -1;
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
  if (found.guard >= 0 && !found.touching) {
    // Up to the part that is proved clear; from there Newton, which may prove itself.
    if (!found.resolved) tau *= kUsed;
    advance(*tables_, tau, x_, inputs_);
    double root = tau;
    const bool proved = approach(guards_[static_cast<std::size_t>(found.guard)], root);
    if (proved ? root <= std::min(h, remaining) && (found.alone || found.resolved) : found.resolved) {
      tau = root;
    } else {
      x_ = x_begin_;
      inputs_ = inputs_begin_;
      advance(*tables_, tau, x_, inputs_);
      found.guard = -1;
      level_ = std::min(level_ + found.refinement, RegimeTables::kLevels - 1);
    }
  } else {
    advance(*tables_, tau, x_, inputs_);
  }
  point_.time = tau == remaining ? end : begin_ + tau;
  ++statistics_.steps;
  if ((x_.size() > 0 && !std::isfinite(x_(0))) || !std::isfinite(point_.time)) {
    lift(*regime_, begin_, x_begin_, inputs_begin_, point_.x, point_.force);
    throw NumericalFailure("the state is no longer finite at t = " + std::to_string(begin_), begin_, point_.x,
                           std::numeric_limits<double>::quiet_NaN());
  }
  for (std::size_t c = 0; c < point_.modes.size(); ++c)
    if (point_.modes[c] == ContactMode::kStick) statistics_.stick_time[c] += tau;
  const bool ends = found.guard >= 0 || point_.time >= limit;
  if (options_.audit) account(tau, ends);

  if (found.guard >= 0) return settle(found.guard, found.touching);
  if (found.spare > kSpareToGrow) {
    const int growth = std::clamp(std::ilogb(found.spare) / 8, 1, kLargestGrowth);
    level_ = std::max(0, level_ - growth);
  }
  if (!ends) return false;
  if (corner) return settle(-1, false);
  lift_point();
  if (carries_) push_tangents();
  return false;
}

bool ClosedFormFlow::settle(int guard, bool touching) {
  lift_point();
  const double window_end = begin_ + tables_->length(level_);
  const Guard* reached = guard >= 0 ? &guards_[static_cast<std::size_t>(guard)] : nullptr;
  const bool salts = carries_ && !touching;
  if (salts) leave_tangents(reached);
  resolver_.settle(point_, reached ? Reached{reached->contact, touching, reached->kind, reached->next} : Reached{});
  statistics_.events += static_cast<std::int64_t>(resolver_.events().size());
  if (touching)
    guards_[static_cast<std::size_t>(guard)].exempt_until = std::max(window_end, std::nextafter(point_.time, 1e300));
  else
    enter_regime();
  if (salts) salt_tangents();
  return true;
}

void ClosedFormFlow::lift(const Visited& in, double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
                          Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  const Regime& r = in.tables->regime();
  out_x.noalias() = r.to_slipping * x;
  out_x.noalias() += r.inputs_slipping * inputs;
  out_force.resize(nc_);
  for (int c = 0; c < nc_; ++c)
    out_force(c) = r.roles[static_cast<std::size_t>(c)] == ContactRole::kSliding
                       ? inputs(c)
                       : r.force_row.col(c).dot(x) + r.force_coefficient.col(c).dot(inputs);
  if (!in.overlay) return;
  const DrivePhase phase = phase_at(t);
  in.overlay->slipping.add(phase, 1.0, out_x);
  for (int c = 0; c < nc_; ++c) out_force(c) += in.overlay->force.at(c, phase);
}

void ClosedFormFlow::lift_point() {
  lift(*regime_, point_.time, x_, inputs_, point_.x, point_.force);
  for (const int c : compliant_)
    point_.internal(system_.internal_begin(c)) =
        point_.force(c) / resolver_.laws()[static_cast<std::size_t>(c)].stiffness;
  if (oscillator_states_.empty()) return;
  const Regime& r = tables_->regime();
  Eigen::VectorXd x = x_;
  if (const DriveOverlay* overlay = regime_->overlay.get()) {
    overlay->state.add(phase_at(point_.time), 1.0, x);
  }
  point_.internal(oscillator_states_) = r.to_oscillators * x;
}

void ClosedFormFlow::evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  Eigen::VectorXd x = x_begin_, inputs = inputs_begin_;
  advance(*step_regime_->tables, std::max(0.0, t - begin_), x, inputs);
  lift(*step_regime_, t, x, inputs, out_x, out_force);
}

}  // namespace slipmode::dynamics
