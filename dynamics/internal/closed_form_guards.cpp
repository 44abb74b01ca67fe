#include <slipmode/core/errors.hpp>
#include <slipmode/core/kernels/kernels.hpp>
#include "dynamics/internal/closed_form_flow.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// A guard that cannot be told from zero beyond this share of its scale touches it.
constexpr double kTouching = 1e-12;
/// Terms that cancel count by what they round by, 1e-14 of them.
constexpr double kCancels = 1e-2;
/// What a place rounds by, of its size.
constexpr double kPlaceRounding = 64.0 * std::numeric_limits<double>::epsilon();
/// A guard below this share of its scale when a regime begins starts at zero; a slope below it times the fastest rate
/// may be zero …
constexpr double kStarting = 1e-9;
/// … and is known to rise above this one.
constexpr double kRising = 1e-13;
/// A root is located to this phase of the fastest pair.
constexpr double kClock = 1e-15;
constexpr int kNewtonSteps = 20;
/// From where a window has a guard's root to another root a guard changes by more than this many times what it is told
/// from zero to.
constexpr double kOtherRoot = 8.0;
/// Radians of the slipping structure after which what never leaves its rounding is looked at again, as that may shrink.
constexpr double kUnlooked = 1e3;
constexpr int kHalvings = 3;
constexpr int kLargestRefinement = 9;

}  // namespace

void ClosedFormFlow::set_guards() {
  guards_.clear();
  std::vector<bool> guarded(static_cast<std::size_t>(nc_));  // one of a group that turns together
  const std::vector<RegimeOutput>& outputs = tables_->regime().outputs;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const int c = outputs[k].contact;
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = resolver_.laws()[i];
    Guard guard{static_cast<Eigen::Index>(k), c};
    switch (outputs[k].kind) {
      case RegimeOutput::Kind::kSpeed: {
        const auto group = static_cast<std::size_t>(resolver_.slides_as(c));
        if (guarded[group]) continue;
        guarded[group] = true;
        guard.sign = sign_of(point_.modes[i]);
        break;
      }
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
  for (const StopGuard& own : stop_guards(resolver_.laws()[i].clearance, point_.modes[i])) {
    if (own.press != (kind == RegimeOutput::Kind::kPress)) continue;
    Guard guard = of_output;
    guard.kind = GuardKind::kStop;
    guard.sign = own.sign;
    guard.constant = own.constant;
    guard.next = own.next;
    guards_.push_back(guard);
  }
}

double ClosedFormFlow::moving_size(const Guard& guard) const {
  const Regime& r = tables_->regime();
  const auto row = r.row.col(guard.output).cwiseAbs();
  double size = row.dot(x_.cwiseAbs()) + r.coefficient.col(guard.output).cwiseAbs().dot(inputs_.cwiseAbs());
  if (!whole_) size += row.dot((free_ - free_entered_).cwiseAbs());
  if (const DriveOverlay* overlay = regime_->overlay) size += overlay->outputs[0].size(guard.output);
  return size;
}

double ClosedFormFlow::cancelled(const Guard& guard) const {
  if (guard.kind != GuardKind::kStop) return 0.0;
  const Regime& r = tables_->regime();
  const auto parts = [&](Eigen::Index of) {
    const double moving = r.place_row.col(of).dot(x_.cwiseAbs()) + r.place_coefficient.col(of).dot(inputs_.cwiseAbs());
    return regime_->overlay ? moving + regime_->overlay->place_size(of) : moving;
  };
  // Now, or a radian of the slipping structure later.
  return kCancels * (parts(guard.contact) + parts(nc_ + guard.contact) / slipping_rate_) * per_place(guard);
}

ClosedFormFlow::GuardSize ClosedFormFlow::size_of(const Guard& guard) const { return {scale(guard), cancelled(guard)}; }

double ClosedFormFlow::GuardSize::starting() const { return kStarting * own + kTouching * cancelled; }

double ClosedFormFlow::scale(const Guard& guard) const {
  const Regime& r = tables_->regime();
  const RegimeOutput& output = r.outputs[static_cast<std::size_t>(guard.output)];
  const ContactForces& law = resolver_.laws()[static_cast<std::size_t>(guard.contact)];
  // A stretch is the small difference of two places.
  if (output.kind == RegimeOutput::Kind::kForce)
    return law.static_limit + (law.stiffness > 0.0 ? kCancels * moving_size(guard) : 0.0);
  const double constant = std::abs(guard.constant), moving = moving_size(guard);
  if (guard.kind == GuardKind::kStop) return constant + std::max(moving, recalled(guard));
  const double size = constant + moving;
  if (output.kind == RegimeOutput::Kind::kSpeed)
    return size + std::abs(inputs_(r.speed_input())) +
           slipping_.mobility(guard.contact, guard.contact) * law.static_limit / fastest_;
  return size + (guard.kind == GuardKind::kLoad ? law.load : law.static_limit);
}

double ClosedFormFlow::per_place(const Guard& guard) const {
  if (tables_->regime().outputs[static_cast<std::size_t>(guard.output)].kind != RegimeOutput::Kind::kPress) return 1.0;
  const auto i = static_cast<std::size_t>(guard.contact);
  const friction::Clearance& stops = resolver_.laws()[i].clearance;
  return (side_of(point_.modes[i]) < 0.0 ? stops.left : stops.right)->stiffness;
}

double ClosedFormFlow::recalled(const Guard& guard) const {
  const Recall& last = recall_[static_cast<std::size_t>(guard.contact)];
  return point_.time - last.time < 1.0 / fastest_ ? last.size * per_place(guard) : 0.0;
}

void ClosedFormFlow::recall_sizes() {
  for (const Guard& guard : guards_) {
    if (guard.kind != GuardKind::kStop) continue;
    if (!measured_) measure_amplitudes();
    Recall& last = recall_[static_cast<std::size_t>(guard.contact)];
    const double size = moving_size(guard);
    if (size > recalled(guard)) last = {point_.time, size / per_place(guard)};
  }
}

ClosedFormFlow::GuardValue ClosedFormFlow::evaluate(const Guard& guard, double t) const {
  const Regime& r = tables_->regime();
  const auto k = guard.output;
  double value = r.output(k, x_, inputs_);
  double rate = kernels::kernels().dot(r.row1.col(k).data(), x_.data(), x_.size()) + r.coefficient1.col(k).dot(inputs_);
  if (const DriveOverlay* overlay = regime_->overlay) {
    const DrivePhase phase = phase_at(t);
    value += overlay->outputs[0].at(k, phase);
    rate += overlay->outputs[1].at(k, phase);
  }
  return {guard.constant + guard.sign * value, guard.sign * rate};
}

double ClosedFormFlow::second_derivative(const Guard& guard, double t) const {
  const Regime& r = tables_->regime();
  double second = r.row2.col(guard.output).dot(x_) + r.coefficient2.col(guard.output).dot(inputs_);
  if (const DriveOverlay* overlay = regime_->overlay) second += overlay->outputs[2].at(guard.output, phase_at(t));
  return guard.sign * second;
}

ClosedFormFlow::Swing ClosedFormFlow::swing_of(const Guard& guard) const {
  const Regime& r = tables_->regime();
  const DriveOverlay* overlay = regime_->overlay;
  const auto k = guard.output;
  const Eigen::Index speed = r.speed_input();
  const bool inputs_rest = overlay ? overlay->resonances.empty() : inputs_(speed) == 0.0 && inputs_(speed + 1) == 0.0;
  if (!inputs_rest || !r.motion.available() || r.growth > 0.0) return {};
  const kernels::Kernels& vector = kernels::kernels();
  return {r.output(k, x_, inputs_) - vector.dot(r.row.col(k).data(), free_.data(), free_.size()),
          vector.dot(r.weight.col(k).data(), amplitude_.data(), amplitude_.size()) +
              (overlay ? overlay->outputs[0].size(k) : 0.0)};
}

void ClosedFormFlow::drop_idle_guards() {
  // A load that varies by a hundredth of its mean need not be looked at.
  if (regime_->overlay == nullptr) return;
  std::erase_if(guards_, [&](const Guard& guard) {
    const auto [held, reach] = swing_of(guard);
    return guard.constant + guard.sign * held - reach > kStarting * (std::abs(guard.constant) + std::abs(held) + reach);
  });
}

ClosedFormFlow::GuardStart ClosedFormFlow::start_of(const Guard& guard) const {
  const Regime& r = tables_->regime();
  const DriveOverlay* overlay = regime_->overlay;
  const double room = std::exp(r.growth / fastest_);
  const double harmonic2 = overlay ? overlay->outputs[2].size(guard.output) : 0.0;
  const double harmonic3 = overlay ? overlay->outputs[3].size(guard.output) : 0.0;
  const double third = std::abs(r.polynomial3.col(guard.output).dot(inputs_));
  const auto [value, rate] = evaluate(guard, point_.time);
  const double most_second = room * most(r.weight2.col(guard.output), 1.0 / fastest_) +
                             std::abs(r.polynomial2.col(guard.output).dot(inputs_)) + third / fastest_ + harmonic2;
  // Of what rests where the guard is zero, what moves from now on, for as long as the bounds hold, is the size.
  GuardSize size = size_of(guard);
  if (size.told() == 0.0) size.own = most_second / (fastest_ * fastest_);
  const auto [held, reach] = swing_of(guard);
  return {.value = value,
          .rate = rate,
          .second = second_derivative(guard, point_.time),
          .most = std::abs(guard.constant + guard.sign * held) + reach,
          .most_second = most_second,
          .most_third = room * most(r.weight3.col(guard.output), 1.0 / fastest_) + third + harmonic3,
          .size = size,
          .lasting = r.growth == 0.0 && third == 0.0 && !swells()};
}

double ClosedFormFlow::near_zero(const GuardStart& g) const {
  // |g| ≤ |g₀| + |g′|t + M₂t²/2, and ≤ |g₀| + |g′|t + |g″|t²/2 + M₃t³/6, of whose terms each is given its share.
  const double bounded = 1.0 / fastest_;
  const auto lasts = [&](double stays) { return g.lasting ? stays : std::min(stays, bounded); };
  const double left = kTouching * g.size.told() - std::abs(g.value), slope = std::abs(g.rate);
  if (g.size.told() == 0.0 && g.value == 0.0 && slope == 0.0 && g.most_second == 0.0)  // of what nothing moves
    return lasts(std::numeric_limits<double>::infinity());
  const double unlooked = g.most <= kTouching * g.size.told() ? kUnlooked / slipping_rate_ : 0.0;
  if (!(left > 0.0)) return unlooked;
  const double by_second = 2.0 * left / (slope + std::sqrt(slope * slope + 2.0 * g.most_second * left));
  const double by_third = std::min(
      {left / (3.0 * slope), std::sqrt(2.0 * left / (3.0 * std::abs(g.second))), std::cbrt(2.0 * left / g.most_third)});
  return std::max(unlooked, lasts(std::max(by_second, by_third)));
}

void ClosedFormFlow::look_again() {
  for (Guard& guard : guards_) {
    if (guard.exempt_until != begin_) continue;
    const GuardStart now = start_of(guard);
    if (std::abs(now.value) <= kTouching * now.size.told() / 2.0)
      guard.exempt_until = std::max(begin_ + near_zero(now), std::nextafter(begin_, 1e300));
  }
}

void ClosedFormFlow::foresee_starts() {
  // A guard that starts at zero. Taylor's theorem says for how long it is sure to stay positive: g ≥ g′t − M₂t²/2 (or
  // g″t²/2 − M₃t³/6 when g′ vanishes); half of that time is used. It is not looked at either as long as it cannot be
  // told from zero: rounding alone would decide, of its terms or, where these are nothing either, of when it vanished.
  const Regime& r = tables_->regime();
  const double tiny = 1e-9 / fastest_;
  double shortest = std::numeric_limits<double>::infinity();
  for (Guard& guard : guards_) {
    const auto i = static_cast<std::size_t>(guard.contact), k = static_cast<std::size_t>(guard.output);
    const ContactForces& law = resolver_.laws()[i];
    const bool rigid_speed =
        r.outputs[k].kind == RegimeOutput::Kind::kSpeed && law.kind == LawKind::kConstant && !law.varies;
    const bool by_order = rigid_speed && point_.multiplicity[i] > 0;
    const GuardValue now = evaluate(guard, point_.time);
    const GuardSize measure = size_of(guard);
    // A speed that is said not to start at zero does only where its contact has turned a moment before.
    if (rigid_speed && !by_order ? std::abs(now.value) > 2.0 * kTouching * measure.told()
                                 : now.value > std::max(measure.starting(), kClock / fastest_ * std::abs(now.rate)))
      continue;
    const GuardStart start = start_of(guard);
    const double g1 = start.rate, g2 = start.second, size = start.size.told(), near = near_zero(start);
    if (guard.kind == GuardKind::kStop && near >= 1.0 / fastest_) {  // at rest on the limit
      guard.exempt_until = point_.time + near;
      continue;
    }
    const bool simple = by_order ? point_.multiplicity[i] == 1 : g1 > kRising * fastest_ * size;
    // Flat, too, where it falls by rounding, and no further below zero than can be told.
    const bool flat = by_order
                          ? point_.multiplicity[i] == 2
                          : std::abs(g1) <= fastest_ * start.size.starting() || g1 * g1 <= 2.0 * g2 * kTouching * size;
    double clear = 0.0;
    if (simple && g1 > 0) clear = g1 / start.most_second;
    if (flat && g2 > 0) clear = std::max(clear, 1.5 * g2 / start.most_third);
    // A guard that falls through zero is an event at once; one of which neither slope nor curvature can be told may
    // rise.
    const bool told = !flat || std::abs(g2) > fastest_ * fastest_ * start.size.starting();
    if (!by_order && clear == 0.0 && told) {
      const bool at_rest =
          flat && std::abs(g1) <= kRising * fastest_ * size && std::abs(start.value) <= kPlaceRounding * size;
      guard.at_once = guard.kind == GuardKind::kStop && at_rest;
      continue;
    }
    clear = std::min(std::max(clear, near), 1.0 / fastest_);
    blind_start_ |= clear < tiny;
    clear = std::max(clear, tiny);
    guard.exempt_until = point_.time + clear;
    shortest = std::min(shortest, clear);
  }
  if (shortest < std::numeric_limits<double>::infinity())
    level_ = tables_->level_covering(shortest);
  else
    level_ = std::min(std::max(level_, tables_->level_covering(4.0 / fastest_)), RegimeTables::kLevels - 1);
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
    root = first_root(lowered(polynomial, remainder));
    if (!root) return;
    here.touching = here.resolved;
  }
  here.at = here.guess = root->at;
  if (!here.resolved) {
    here.refinement = std::min(kLargestRefinement, 1 + std::ilogb(remainder / tolerance) / 8);
    const std::optional<FirstRoot> likely = first_root(polynomial);
    here.guess = likely && !likely->touching ? likely->at : 0.0;
  }
  if (found.guard < 0 || here.at < found.at) {
    here.others = found.guard < 0 ? found.others : found.at;
    found = here;
  } else {
    found.others = std::min(found.others, here.at);
  }
}

ClosedFormFlow::Search ClosedFormFlow::unknown(int guard, int level) const {
  // No bound: that of growing motion overflows in long windows. Nothing is passed over until there is one.
  if (level + 1 >= RegimeTables::kLevels || !(begin_ + tables_->length(level) > begin_))
    throw NumericalFailure("what a contact does next is no finite number at t = " + std::to_string(begin_), begin_,
                           point_.x, std::numeric_limits<double>::quiet_NaN());
  Search found;
  found.guard = guard;
  found.at = 0.0;
  found.refinement = kLargestRefinement;
  return found;
}

ClosedFormFlow::Search ClosedFormFlow::search(int level) const {
  const Regime& r = tables_->regime();
  const RegimeWindow& w = tables_->window(level);
  const DriveOverlay* overlay = regime_->overlay;
  const auto np = r.pairs.np, ni = r.inputs();
  const kernels::Kernels& vector = kernels::kernels();
  Search found;
  Eigen::Index computed = -1;
  alignas(64) std::array<double, kNodes> output{}, values;
  const Eigen::Map<const Eigen::Array<double, kNodes, 1>> at_nodes(values.data());
  double remainder = 0.0;
  for (std::size_t g = 0; g < guards_.size(); ++g) {
    const Guard& guard = guards_[g];
    if (guard.exempt_until > begin_) continue;
    if (guard.at_once) return {.guard = static_cast<int>(g), .at = 0.0, .resolved = true};
    const auto k = guard.output;
    if (k != computed) {
      computed = k;
      vector.node_sums(w.from_inputs.data() + kNodes * ni * k, inputs_.data(), ni, nullptr, output.data());
      vector.node_sums(w.from_state.data() + kNodes * 2 * np * k, x_.data(), 2 * np, output.data(), output.data());
      remainder = kernels::kernels().dot(w.remainder.col(k).data(), amplitude_.data(), np);
      if (overlay) {
        // c cos j(θ₀ + ωτ) + s sin j(θ₀ + ωτ) by the window's cos jωτ and sin jωτ.
        DrivePhase p;
        Eigen::Index j = 0;
        for (const DriveOverlay::Window& harmonic : overlay->window(r, level, tables_->length(level))) {
          p = p.times(phase_);
          const double c = overlay->outputs[0].c(k, j), s = overlay->outputs[0].s(k, j);
          vector.add_scaled(c * p.cosine + s * p.sine, harmonic.cosine.data(), output.data(), kNodes);
          vector.add_scaled(s * p.cosine - c * p.sine, harmonic.sine.data(), output.data(), kNodes);
          remainder += harmonic.remainder * overlay->outputs[0].magnitude(k, j);
          ++j;
          if (harmonic.swell_remainder.size() == 0) continue;
          vector.add_scaled(p.cosine, harmonic.swell_cosine.col(k).data(), output.data(), kNodes);
          vector.add_scaled(p.sine, harmonic.swell_sine.col(k).data(), output.data(), kNodes);
          remainder += harmonic.swell_remainder(k);
        }
      }
    }
    for (std::size_t j = 0; j < kNodes; ++j) values[j] = guard.constant + guard.sign * output[j];
    const double least = at_nodes.minCoeff();
    if (least > remainder || stays_above(values, remainder, kHalvings)) {
      found.spare = std::min(found.spare, std::max(least, 0.0) / std::max(remainder, 1e-300));
      continue;
    }
    if (!std::isfinite(remainder) || !at_nodes.allFinite()) return unknown(static_cast<int>(g), level);
    BernsteinPolynomial polynomial;
    polynomial.degree = kNodes - 1;
    std::copy_n(values.begin(), kNodes, polynomial.coefficient.begin());
    // Of what grows from next to nothing on, a window has no more digits than its largest value leaves.
    const double tolerance = kTouching * size_of(guard).told();
    const double rounding = kPlaceRounding * at_nodes.abs().maxCoeff();
    judge(polynomial, rounding > tolerance ? std::max(remainder, rounding) : remainder, tolerance, static_cast<int>(g),
          found);
  }
  return found;
}

bool ClosedFormFlow::approach(const Guard& guard, double from, double& tau) {
  // Newton on the exact guard.
  const double bend = curvature(guard.output), size = size_of(guard).told(), start = tau;
  const double rounding = std::numeric_limits<double>::epsilon() / 2.0 * size;
  const auto give_up = [&] {
    tau = start;
    move_from_begin(tau);
    return false;
  };
  double slope = 0.0;
  move_from_begin(tau);
  for (int k = 0; k < kNewtonSteps; ++k) {
    const GuardValue now = evaluate(guard, begin_ + tau);
    slope = now.rate;
    const double shift = -now.value / slope;
    if (!(slope < 0.0) || !(std::abs(shift) * fastest_ < 2.0) || tau + shift < 0.0) return give_up();
    tau += shift;
    move_from_begin(tau);
    // Newton squares its error, with a factor of about the guard's curvature by its slope. It is done where that is
    // beyond the clock, or leaves of the guard no more than its rounding.
    if (std::abs(shift) * fastest_ < kClock ||
        shift * shift * bend < std::max(kClock / fastest_ * std::abs(slope), rounding))
      break;
  }
  // A root that the window has is no other one: of a guard that is all but flat there, Newton's may be.
  const double shifted = std::abs(tau - start);
  if (start == from && shifted > kRootLeaves * tables_->length(level_) &&
      std::abs(slope) * shifted > kOtherRoot * kTouching * size)
    return give_up();
  // The guard falls all the way from `from`: it vanishes here for the first time.
  return tau <= from || (tau - from) * bend < std::abs(slope);
}

bool ClosedFormFlow::take_earlier(Search& found, double from, double& root) {
  if (root <= (found.others - kRootLeaves) * tables_->length(level_)) return false;
  const int reached = found.guard;
  for (std::size_t g = 0; g < guards_.size(); ++g) {
    const Guard& other = guards_[g];
    if (static_cast<int>(g) == found.guard || other.exempt_until > begin_ ||
        !(evaluate(other, begin_ + root).value < -kTouching * size_of(other).told()))
      continue;
    double before = root;
    if (approach(other, from, before) && before < root) {
      found.guard = static_cast<int>(g);
      root = before;
    } else {
      move_from_begin(root);
    }
  }
  return found.guard != reached;
}

double ClosedFormFlow::most(const Eigen::Ref<const Eigen::VectorXd>& weight, double h) const {
  return weight.dot(amplitude_) + (swells() ? h * weight.dot(regime_->overlay->swell) : 0.0);
}

double ClosedFormFlow::curvature(Eigen::Index output) const {
  const Regime& r = tables_->regime();
  const double h = tables_->length(level_);
  double bend = std::exp(std::min(r.growth * h, 200.0)) * most(r.weight2.col(output), h) +
                std::abs(r.polynomial2.col(output).dot(inputs_begin_)) +
                std::abs(r.polynomial3.col(output).dot(inputs_begin_)) * h;
  if (const DriveOverlay* overlay = regime_->overlay) bend += overlay->outputs[2].size(output);
  return bend;
}

}  // namespace slipmode::dynamics
