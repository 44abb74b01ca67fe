#include "dynamics/internal/closed_form_flow.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/kernels/kernels.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// A guard that may vanish after more than this share of a window is approached before the window is refined.
constexpr double kWorthwhile = 0.05;
/// The part of a proved interval that is used, to leave room for the rounding of its end.
constexpr double kUsed = 1.0 - 1e-5;
/// The next window is longer when the least value of every guard is this many times what was left out.
constexpr double kSpareToGrow = 32.0;
constexpr int kLargestGrowth = 4;
/// Events this share of a window apart may be one, and come in either order.
constexpr double kSameInstant = 1e-6;
/// A sum of which no more than this share of its terms is left is made anew.
constexpr double kLittleLeft = 1e-2;

/// Whether x is next to none beside the parts that it is a sum of.
bool little_beside(const Regime& r, const Eigen::VectorXd& x, const Eigen::VectorXd& part) {
  return squared_size(r, x) < kLittleLeft * kLittleLeft * squared_size(r, part);
}

}  // namespace

double squared_size(const Regime& r, const Eigen::VectorXd& x) {
  return r.scale1.cwiseProduct(x.head(r.pairs.np)).squaredNorm() +
         r.scale2.cwiseProduct(x.tail(r.pairs.np)).squaredNorm();
}

ClosedFormFlow::ClosedFormFlow(const HybridSystem& system, HybridPoint start, const FlowOptions& options)
    : system_(system),
      slipping_(system.cache().tables(system, false).model),
      resolver_(system, slipping_, options),
      options_(options),
      nc_(slipping_.contacts),
      slipping_rate_(std::max(slipping_.pace(), resolver_.drive().omega())),
      point_(std::move(start)) {
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  recall_.resize(static_cast<std::size_t>(nc_));
  for (int c = 0; c < nc_; ++c) {
    const friction::Contact& contact = system.contacts()[static_cast<std::size_t>(c)];
    if (resolver_.laws()[static_cast<std::size_t>(c)].stiffness > 0.0) compliant_.push_back(c);
    if (contact.normal_load.oscillator) {
      const Eigen::Index end = system.internal_begin(c) + friction::internal_states(contact);
      oscillator_states_.insert(oscillator_states_.end(), {end - 2, end - 1});
    }
  }
  begin();
}

void ClosedFormFlow::restart(HybridPoint start) {
  point_ = std::move(start);
  resolver_.forget();
  carries_ = false;
  blind_start_ = false;
  work_ = {};
  statistics_ = {};
  statistics_.stick_time.assign(static_cast<std::size_t>(nc_), 0.0);
  recall_.assign(static_cast<std::size_t>(nc_), {});
  level_ = 0;
  begin();
}

void ClosedFormFlow::begin() {
  resolver_.start(point_);
  statistics_.events = static_cast<std::int64_t>(resolver_.events().size());
  enter_regime();
  begin_step();
}

void ClosedFormFlow::begin_step() {
  begin_ = point_.time;
  step_regime_ = regime_;
  if (regime_->overlay) phase_ = phase_at(begin_);
  if (!measured_) measure_amplitudes();
  whole_ = !regime_->overlay && (whole_ || regime_->entered == begin_) && little_beside(tables_->regime(), x_, free_);
  x_begin_ = x_;
  free_begin_ = free_;
  inputs_begin_ = inputs_;
}

ClosedFormFlow::Visited& ClosedFormFlow::visit(const std::vector<ContactRole>& roles, const DriveOverlay* steady) {
  const auto known = std::find_if(visited_.begin(), visited_.end(),
                                  [&](const auto& v) { return v.roles == roles && v.steady == steady; });
  if (known != visited_.end()) return *known;
  const RegimeTables& tables = system_.cache().regime(system_, roles);
  visited_.push_back({.roles = roles, .tables = &tables, .steady = steady, .belt = nullptr, .maps = nullptr});
  Visited& now = visited_.back();
  ++statistics_.regimes_built;
  if (resolver_.drive().belt() == nullptr) {
    const DrivenRegime& driven = system_.drive_cache().regime(tables, slipping_, system_.drive(), steady != nullptr);
    now.overlay = &driven.overlay;
    if (options_.audit) now.forms = driven.forms();
  } else if (options_.audit) {
    now.belt = BeltWork::make(tables, slipping_);
  }
  return now;
}

bool ClosedFormFlow::has_just_begun(const DriveOverlay& steady, const Eigen::VectorXd& whole) const {
  if (carries_ || !resolver_.drive().force()) return false;
  sum_.setZero(whole.size());
  steady.state.add(steady.phase(point_.time), 1.0, sum_);
  return little_beside(tables_->regime(), whole, sum_);
}

bool ClosedFormFlow::has_grown() const {
  if (!regime_->steady) return false;
  Eigen::VectorXd whole = x_;
  regime_->overlay->state.add(phase_at(point_.time), 1.0, whole);  // pairs that do not oscillate are beside theirs
  return !has_just_begun(*regime_->steady, whole);
}

void ClosedFormFlow::enter_regime() {
  const std::vector<ContactRole> roles = resolver_.roles(point_.modes);
  regime_ = &visit(roles);
  tables_ = regime_->tables;
  fastest_ = std::max(tables_->regime().rate, resolver_.drive().omega());
  const Regime& r = tables_->regime();

  inputs_ = Eigen::VectorXd::Zero(r.inputs());
  for (int c = 0; c < nc_; ++c) inputs_(c) = resolver_.regime_input(point_, c);
  if (!regime_->overlay) {
    inputs_(r.speed_input()) = resolver_.drive().velocity(point_.time);
    inputs_(r.speed_input() + 1) = resolver_.drive().acceleration(point_.time);
  }
  inputs_(r.speed_input() + 2) = 1.0;
  const kernels::Kernels& vector = kernels::kernels();
  x_.setZero(r.from_slipping.rows());
  vector.product(r.from_slipping.data(), x_.size(), point_.x.size(), point_.x.data(), x_.data());
  if (!oscillator_states_.empty())
    x_.noalias() += r.from_oscillators * Eigen::VectorXd(point_.internal(oscillator_states_));
  hold_springs(x_, nullptr, inputs_);
  if (regime_->overlay && has_just_begun(*regime_->overlay, x_)) regime_ = &visit(roles, regime_->overlay);
  const DriveOverlay* overlay = regime_->overlay;
  const DrivePhase phase = overlay ? phase_at(point_.time) : DrivePhase{};
  regime_->entered = point_.time;
  if (overlay) {
    regime_->x_entered = x_;
    regime_->inputs_entered = inputs_;
    for (Eigen::Index c = 0; c < nc_; ++c) inputs_(c) -= overlay->inputs.at(c, phase);
    overlay->state.add(phase, -1.0, x_);
    hold_springs(x_, overlay, inputs_);
  }
  amplitude_.resize(r.pairs.np);
  if (overlay) {
    resting_.setZero(x_.size());
    vector.product(r.particular.data(), x_.size(), inputs_.size(), inputs_.data(), resting_.data());
  }
  measure_amplitudes();
  free_entered_ = free_;
  const StayPlace entered{point_.time, x_, free_, point_.x};
  if (regime_->forms) stay_.begin(*regime_->forms, entered, inputs_);
  if (regime_->belt && has_forms()) regime_->belt->begin(entered, inputs_);
  mark_accounted();
  set_guards();
  drop_idle_guards();
  foresee_starts();
}

void ClosedFormFlow::hold_springs(const Eigen::VectorXd& x, const DriveOverlay* beside, Eigen::VectorXd& inputs) const {
  const Regime& r = tables_->regime();
  for (const int c : compliant_) {
    if (point_.modes[static_cast<std::size_t>(c)] != ContactMode::kStick) continue;
    const double force = r.force_row.col(c).dot(x) + r.force_coefficient.col(c).dot(inputs) +
                         (beside ? beside->force.at(c, phase_at(point_.time)) : 0.0);
    inputs(c) +=
        point_.internal(system_.internal_begin(c)) - force / resolver_.laws()[static_cast<std::size_t>(c)].stiffness;
  }
}

void ClosedFormFlow::mark_accounted() {
  if (!has_forms()) return;
  accounted_ = point_.time;
  x_accounted_ = x_;
  free_accounted_ = free_;
  inputs_accounted_ = inputs_;
}

double ClosedFormFlow::drive_velocity(double t, const Eigen::VectorXd& inputs) const {
  return regime_->overlay ? resolver_.drive().velocity(t) : inputs(tables_->regime().speed_input());
}

void ClosedFormFlow::measure_amplitudes() {
  const Regime& r = tables_->regime();
  const auto np = r.pairs.np;
  if (regime_->overlay) {
    free_ = x_ - resting_;
  } else {
    free_ = x_;
    free_.noalias() -= r.particular * inputs_;
  }
  amplitude_.array() =
      r.scale1.array() * free_.head(np).array().abs() + r.scale2.array() * free_.tail(np).array().abs();
  measured_ = true;
  begin_windows(point_.time);
}

void ClosedFormFlow::begin_windows(double t) {
  windows_from_.time = t;
  windows_from_.x = x_;
  windows_from_.inputs = inputs_;
  windows_from_.moved.setZero(x_.size());
}

void ClosedFormFlow::move(double tau) {
  measured_ = false;
  move(*regime_, tau, free_, x_, inputs_);
}

void ClosedFormFlow::move_from_begin(double tau) {
  x_ = x_begin_;
  inputs_ = inputs_begin_;
  move(tau);
}

void ClosedFormFlow::move(const Visited& in, double tau, const Eigen::VectorXd& free, Eigen::VectorXd& x,
                          Eigen::VectorXd& inputs) const {
  const Regime& r = in.tables->regime();
  if (needs_tables(r)) {
    by_tables_ = x;
    advance(*in.tables, tau, by_tables_, inputs);
  }
  r.motion.add(tau, free.data(), x.data());
  follow_inputs(in, inputs_begin_, tau, x, inputs);
  take_tables(r, x);
  if (in.overlay) in.overlay->move_resonances(r, tau, phase_, x);
}

void ClosedFormFlow::take_tables(const Regime& r, Eigen::VectorXd& out_x) const {
  if (whole_) {
    out_x = by_tables_;
    return;
  }
  for (const Eigen::Index i : r.motion.others())
    for (const Eigen::Index k : {i, r.pairs.np + i}) out_x(k) = by_tables_(k);
}

void ClosedFormFlow::follow_inputs(const Visited& in, const Eigen::VectorXd& from, double tau, Eigen::VectorXd& x,
                                   Eigen::VectorXd& out_inputs) const {
  if (in.overlay) return;  // then all inputs are constant
  const Regime& r = in.tables->regime();
  out_inputs = from;
  r.advance_inputs(out_inputs, tau);
  for (Eigen::Index k = 0; k <= r.speed_input(); ++k)
    if (const double change = out_inputs(k) - from(k); change != 0.0) x += change * r.particular.col(k);
}

void ClosedFormFlow::pass_window() {
  const Regime& r = tables_->regime();
  const double h = tables_->length(level_);
  if (swells()) return move(h);
  if (needs_tables(r)) {
    by_tables_.resize(x_.size());
    apply(tables_->step(level_), x_.data(), inputs_, by_tables_.data());
  }
  const RegimeChange& d = tables_->change(level_);
  kernels::kernels().pass(
      {r.pairs.np, d.d11.data(), d.d12.data(), d.d21.data(), d.d22.data(), r.scale1.data(), r.scale2.data()},
      windows_from_.moved.data(), free_.data(), amplitude_.data());
  x_ = windows_from_.x + windows_from_.moved;
  follow_inputs(*regime_, windows_from_.inputs, begin_ + h - windows_from_.time, x_, inputs_);
  if (!needs_tables(r)) return;
  take_tables(r, x_);
  if (whole_) begin_windows(begin_ + h);
  const auto np = r.pairs.np;
  for (const Eigen::Index i : r.motion.others()) {
    for (const Eigen::Index k : {i, np + i})
      free_(k) = x_(k) - (regime_->overlay ? resting_(k) : r.particular.row(k).dot(inputs_));
    amplitude_(i) = r.scale1(i) * std::abs(free_(i)) + r.scale2(i) * std::abs(free_(np + i));
  }
}

bool ClosedFormFlow::step(double t_limit) {
  resolver_.clear();
  if (has_grown()) {
    lift_point();
    enter_regime();
  }
  begin_step();
  double limit = t_limit;
  bool corner = false;
  if (!resolver_.drive().is_constant()) {
    if (const auto t = resolver_.drive().next_corner(begin_); t && *t <= limit) {
      limit = *t;
      corner = true;
    }
  }
  look_again();
  double end = limit;
  for (const Guard& guard : guards_)
    if (guard.exempt_until > begin_) end = std::min(end, guard.exempt_until);
  const double remaining = end - begin_;

  Search found;
  double h = 0.0, tau = 0.0;
  bool finest = false, certain = !blind_start_;
  blind_start_ = false;
  for (;;) {
    h = tables_->length(level_);
    found = search(level_);
    finest = level_ + 1 >= RegimeTables::kLevels || !(begin_ + h > begin_);
    // Whether a guard vanishes before the step is to end is said by its exact time, not by the window's root or by the
    // end of what is proved clear.
    const double announced = found.touching ? 0.0 : found.resolved ? kRootLeaves : (1.0 - kUsed) * found.at;
    if (found.guard < 0 || (found.at - announced) * h >= remaining) {
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
  const bool at_once = found.guard >= 0 && guards_[static_cast<std::size_t>(found.guard)].at_once;
  if (found.guard >= 0 && !found.touching && !at_once) {
    // Up to the part that is proved clear; beyond it Newton, which may prove itself.
    if (!found.resolved) tau *= kUsed;
    double root = (found.guess > 0.0 ? found.guess : found.at) * h;
    bool proved =
        (found.resolved || found.guess > 0.0) && approach(guards_[static_cast<std::size_t>(found.guard)], tau, root);
    const bool earlier = proved && take_earlier(found, tau, root);
    if (!earlier && found.resolved && root > (found.others + kSameInstant) * h) {
      // A guard that is all rounding led past another's event: it is taken where the window has it.
      proved = false;
      root = found.at * h;
      move_from_begin(root);
    }
    const bool first = found.resolved || root <= found.others * h;
    // Where windows are finer than the clock, a root beyond the window is now, or the guard is clear until shortly
    // before.
    const double clear = begin_ + kUsed * root;
    const bool now = finest && !(clear > begin_);
    certain &= proved ? root <= found.others * h : !found.resolved;
    if (proved ? now || (root <= std::min(h, remaining) && first) : found.resolved && root <= remaining) {
      tau = root;
    } else {
      tau = std::min(tau, remaining);
      move_from_begin(tau);
      if (proved && finest) guards_[static_cast<std::size_t>(found.guard)].exempt_until = clear;
      found.guard = -1;
      level_ = std::min(level_ + found.refinement, RegimeTables::kLevels - 1);
    }
  } else if (tau == h) {
    pass_window();
  } else {
    move(tau);
  }
  point_.time = tau == remaining ? end : begin_ + tau;
  if (found.guard >= 0 && found.touching) certain = false;
  ++statistics_.steps;
  if (certain) ++statistics_.certified;
  if ((x_.size() > 0 && !std::isfinite(x_(0))) || !std::isfinite(point_.time)) {
    lift(*regime_, begin_, x_begin_, inputs_begin_, point_.x, point_.force);
    throw NumericalFailure("the state is no longer finite at t = " + std::to_string(begin_), begin_, point_.x,
                           std::numeric_limits<double>::quiet_NaN());
  }
  for (std::size_t c = 0; c < point_.modes.size(); ++c)
    if (point_.modes[c] == ContactMode::kStick) statistics_.stick_time[c] += tau;
  const bool ends = found.guard >= 0 || point_.time >= limit;
  if (ends) lift_point();
  if (options_.audit) account(tau, ends);
  if (found.guard >= 0) return settle(found.guard, found.touching);
  if (found.spare > kSpareToGrow) {
    const int growth = std::clamp(std::ilogb(found.spare) / 8, 1, kLargestGrowth);
    level_ = std::max(0, level_ - growth);
  }
  if (!ends) return false;
  if (corner) return settle(-1, false);
  if (carries_) push_tangents();
  return false;
}

bool ClosedFormFlow::settle(int guard, bool touching) {
  const double window_end = begin_ + tables_->length(level_);
  const Guard* reached = guard >= 0 ? &guards_[static_cast<std::size_t>(guard)] : nullptr;
  const bool salts = carries_ && !touching;
  if (salts) leave_tangents(reached);
  if (!touching) recall_sizes();
  resolver_.settle(point_, reached ? Reached{reached->contact, touching, reached->kind, reached->next} : Reached{});
  statistics_.events += static_cast<std::int64_t>(resolver_.events().size());
  if (touching)
    guards_[static_cast<std::size_t>(guard)].exempt_until = std::max(window_end, std::nextafter(point_.time, 1e300));
  else
    enter_regime();
  if (salts) salt_tangents();
  return true;
}

bool ClosedFormFlow::cancels(const Visited& in, double t, const Eigen::VectorXd& x) const {
  if (in.overlay == nullptr || t < in.entered) return false;
  const Regime& r = in.tables->regime();
  // Where the stay began may be far from the origin: how far it has come since then counts.
  sum_ = x;
  sum_.head(r.pairs.np) -= in.x_entered.head(r.pairs.np);
  const double alone = squared_size(r, sum_);
  in.overlay->state.add(phase_at(t), 1.0, sum_);
  return squared_size(r, sum_) < kLittleLeft * kLittleLeft * alone;
}

void ClosedFormFlow::anew(const Visited& in, double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_inputs) const {
  out_x = in.x_entered;
  out_inputs = in.inputs_entered;
  const double tau = t - in.entered;
  const DrivePhase entered = in.overlay->phase(in.entered);
  advance(*in.tables, tau, out_x, out_inputs);
  out_x += in.overlay->from_entry(in.tables->regime(), tau, entered);
  in.overlay->follow_inputs(in.tables->regime(), tau, entered, out_inputs);
}

void ClosedFormFlow::lift(const Visited& in, double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
                          Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  if (cancels(in, t, x)) {
    Eigen::VectorXd whole, all;
    anew(in, t, whole, all);
    return lift_sum(in, whole, all, out_x, out_force);
  }
  lift_sum(in, x, inputs, out_x, out_force);
  if (!in.overlay) return;
  const DrivePhase phase = phase_at(t);
  in.overlay->slipping.add(phase, 1.0, out_x);
  for (int c = 0; c < nc_; ++c) out_force(c) += in.overlay->force.at(c, phase);
}

void ClosedFormFlow::lift_sum(const Visited& in, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
                              Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  const Regime& r = in.tables->regime();
  r.lift(x, inputs, out_x);
  out_force.resize(nc_);
  for (int c = 0; c < nc_; ++c)
    out_force(c) = r.roles[static_cast<std::size_t>(c)] == ContactRole::kSliding
                       ? inputs(c)
                       : r.force_row.col(c).dot(x) + r.force_coefficient.col(c).dot(inputs);
}

void ClosedFormFlow::lift_point() {
  lift(*regime_, point_.time, x_, inputs_, point_.x, point_.force);
  for (const int c : compliant_)
    point_.internal(system_.internal_begin(c)) =
        point_.force(c) / resolver_.laws()[static_cast<std::size_t>(c)].stiffness;
  if (oscillator_states_.empty()) return;
  const Regime& r = tables_->regime();
  Eigen::VectorXd x = x_, all;
  if (cancels(*regime_, point_.time, x_))
    anew(*regime_, point_.time, x, all);
  else if (const DriveOverlay* overlay = regime_->overlay)
    overlay->state.add(phase_at(point_.time), 1.0, x);
  point_.internal(oscillator_states_) = r.to_oscillators * x;
}

void ClosedFormFlow::evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const {
  x_then_ = x_begin_;
  inputs_then_ = inputs_begin_;
  move(*step_regime_, std::max(0.0, t - begin_), free_begin_, x_then_, inputs_then_);
  lift(*step_regime_, t, x_then_, inputs_then_, out_x, out_force);
}

}  // namespace slipmode::dynamics
