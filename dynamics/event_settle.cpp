#include <slipmode/core/errors.hpp>
#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/dynamics/event_resolver.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

namespace slipmode::dynamics {
namespace {

/// A stick force this close to its limit (relative), and rising, reaches it together with the one that has.
constexpr double kTogether = 1e-9;
/// Modal coordinates this small are at rest, in whatever units: a factor of 1e58 above the least number with all
/// digits.
constexpr double kDiedOut = 1e-250;

bool presses(ContactMode mode) { return mode == ContactMode::kLeftStop || mode == ContactMode::kRightStop; }

}  // namespace

std::vector<bool> EventResolver::released_together(const HybridPoint& point, int contact) const {
  std::vector<bool> released(point.modes.size());
  if (contact < 0 || point.modes[static_cast<std::size_t>(contact)] != ContactMode::kStick ||
      !decides_by_acceleration(point, static_cast<std::size_t>(contact)))
    return released;
  const std::vector<ContactForces> laws = laws_at(point);
  const Instant now = instant(point, laws, point.force);
  std::vector<bool> stuck;
  for (std::size_t c = 0; c < laws_.size(); ++c)
    stuck.push_back(point.modes[c] == ContactMode::kStick && decides_by_acceleration(point, c));
  Eigen::VectorXd force = point.force, rate;
  stick_forces(now, stuck, force);
  for (std::size_t c = 0; c < released.size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    if (i == contact) {
      released[c] = true;
    } else if (stuck[c] && std::abs(force(i)) >= laws[c].limit(force(i)) * (1 - kTogether)) {
      if (rate.size() == 0) rate = stick_force_rates(now, point.modes, force, deflections(point));
      released[c] = rate(i) * force(i) > 0;
    }
  }
  return released;
}

void EventResolver::settle(HybridPoint& point, Reached reached) {
  if (reached.kind == GuardKind::kFriction && lets_go(point, reached.contact)) reached.kind = GuardKind::kLoad;
  if (reached.contact >= 0 && reached.touching) {
    const auto i = static_cast<std::size_t>(reached.contact);
    record(point, reached.contact, EventKind::kGrazing, point.modes[i]);
    point.multiplicity[i] = point.modes[i] == ContactMode::kStick ? 0 : 2;
  } else if (plain_ && reached.contact == 0) {
    settle_single(point);
  } else if (clearances_only_ && reached.kind == GuardKind::kStop) {
    settle_stop(point, reached);
  } else if (lone_spring_ && reached.contact == 0) {
    settle_spring(point, reached);
  } else {
    settle_coupled(point, reached);
  }
  // Where nothing else excites it, a structure between stops without a gap rattles on while it dies out: what is left
  // of it ends before it has fewer digits than a number has, whose roots no window isolates.
  if (reached.kind == GuardKind::kStop) point.x = (point.x.array().abs() < kDiedOut).select(0.0, point.x);
  guard_against_zeno(point);
}

void EventResolver::settle_single(HybridPoint& point) {
  const ContactMode before = point.modes[0];
  const double force_before = point.force(0), gap = drive_.velocity(point.time) - contact_velocity(0, point.x.data());
  const double impulse = gap / model_.mobility(0, 0);
  const double* input = model_.input.data();
  kernels::kernels().add_scaled(impulse, input, point.x.data(), 2 * model_.np);
  const SingleResolution next =
      resolve_single(instant(point.time, point.x.data()), before == ContactMode::kStick, force_before > 0 ? 1.0 : -1.0);
  point.modes[0] = next.mode;
  point.multiplicity[0] = next.multiplicity;
  point.force(0) = next.force;
  if (keeps_speed(before, next.mode, true))
    kernels::kernels().add_scaled(-impulse, input, point.x.data(), 2 * model_.np);
  record_change(point, 0, before);
}

bool EventResolver::keeps_speed(ContactMode before, ContactMode after, bool reached) const {
  return drive_.shaker() != nullptr && before != ContactMode::kStick && after != ContactMode::kStick &&
         (!reached || before != after);
}

void EventResolver::settle_stop(HybridPoint& point, const Reached& reached) {
  ContactMode& mode = point.modes[static_cast<std::size_t>(reached.contact)];
  const ContactMode before = std::exchange(mode, reached.next);
  applied_forces(point, point.force);
  record_change(point, reached.contact, before);
}

void EventResolver::settle_spring(HybridPoint& point, const Reached& reached) {
  const ContactMode before = point.modes[0];
  if (reached.kind == GuardKind::kLoad)
    turn_load(point, 0);
  else
    turn_compliant(point, 0);
  point.multiplicity[0] = 0;
  point.force(0) = applied_force(point, 0);
  record_change(point, 0, before);
}

void EventResolver::turn_compliant(HybridPoint& point, int c) const {
  const auto i = static_cast<std::size_t>(c);
  const ContactForces law = law_at(point, c);
  double& stretch = point.internal(internal_[i]);
  if (point.modes[i] != ContactMode::kStick) {
    stretch = law.sliding(sign_of(point.modes[i]), 0.0) / law.stiffness;
    point.modes[i] = ContactMode::kStick;
    return;
  }
  // The contact point jumps to where the spring pulls with μ_k N, and slides on if it moves that way; else it is held
  // there.
  const ContactMode slip = stretch > 0 ? ContactMode::kSlipPositive : ContactMode::kSlipNegative;
  stretch = law.sliding(sign_of(slip), 0.0) / law.stiffness;
  if (sign_of(slip) * slide_velocity(point, c, sign_of(slip)) > 0.0) point.modes[i] = slip;
}

void EventResolver::turn_together(HybridPoint& point, int c) const {
  const ContactMode before = point.modes[static_cast<std::size_t>(c)];
  turn_compliant(point, c);
  if (before == ContactMode::kStick) return;
  for (int d = 0; d < model_.contacts; ++d)
    if (slides_as(d) == slides_as(c) && point.modes[static_cast<std::size_t>(d)] == before) turn_compliant(point, d);
}

bool EventResolver::has_event(int c) const {
  return std::any_of(events_.begin(), events_.end(), [c](const Event& e) { return e.contact == c; });
}

Eigen::RowVectorXd EventResolver::slide_stretch_gradient(const HybridPoint& point, int c) const {
  const auto i = static_cast<std::size_t>(c);
  const friction::LoadForm& load = loads_[i];
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(2 * model_.np + point.internal.size());
  if (!load.varies()) return gradient;
  // A contact that was gained a moment ago slides, its stretch still nothing.
  const ContactMode mode = point.modes[i];
  const double sign = mode != ContactMode::kStick ? sign_of(mode) : point.internal(internal_[i]) > 0 ? 1.0 : -1.0;
  gradient.head(2 * model_.np) = load.y * model_.displacement_row.col(c) + load.v * model_.velocity_row.col(c);
  if (load.oscillates()) {
    gradient(2 * model_.np + oscillator_[i]) = load.z;
    gradient(2 * model_.np + oscillator_[i] + 1) = load.z_rate;
  }
  return sign * laws_[i].kinetic_coefficient(sign) / laws_[i].stiffness * gradient;
}

void EventResolver::turn_load(HybridPoint& point, int c) const {
  const auto i = static_cast<std::size_t>(c);
  const bool compliant = laws_[i].kind == LawKind::kCompliant;
  if (compliant) point.internal(internal_[i]) = 0.0;
  if (point.modes[i] != ContactMode::kSeparated) {
    point.modes[i] = ContactMode::kSeparated;
    return;
  }
  const double sliding = drive_.velocity(point.time) - contact_velocity(c, point.x.data());
  const double sign = sliding > 0 ? 1.0 : -1.0;
  const bool held =
      compliant ? sign * slide_velocity(point, c, sign) <= 0.0 : at_belt_speed(point.time, c, point.x.data());
  point.modes[i] = held ? ContactMode::kStick : sign > 0 ? ContactMode::kSlipPositive : ContactMode::kSlipNegative;
}

bool EventResolver::lets_go(const HybridPoint& point, int contact) const {
  const auto i = static_cast<std::size_t>(contact);
  return contact >= 0 && point.modes[i] == ContactMode::kStick && laws_[i].varies && laws_[i].sticks() &&
         law_at(point, contact).static_limit <= kTogether * limit_sizes(point)(contact);
}

void EventResolver::settle_coupled(HybridPoint& point, const Reached& reached) {
  const auto [contact, touching, kind, next] = reached;
  const std::vector<ContactMode> before = point.modes;
  const std::vector<bool> released =
      kind == GuardKind::kFriction ? released_together(point, contact) : std::vector<bool>(point.modes.size());
  if (contact >= 0 && kind == GuardKind::kLoad)
    turn_load(point, contact);
  else if (contact >= 0 && kind == GuardKind::kStop)
    point.modes[static_cast<std::size_t>(contact)] = next;
  else if (contact >= 0 && laws_[static_cast<std::size_t>(contact)].kind == LawKind::kCompliant)
    turn_together(point, contact);

  // Rigid contacts at rest on the drive, to be decided together: those that stick and the one whose guard was reached.
  // Others at zero speed are held there too; decide() tells whether they slide on.
  std::vector<bool> at_rest(point.modes.size());
  std::vector<Eigen::Index> resting;
  for (std::size_t c = 0; c < point.modes.size(); ++c) {
    const auto i = static_cast<int>(c);
    if (!decides_by_acceleration(point, c)) continue;
    at_rest[c] = point.modes[c] == ContactMode::kStick || (i == contact && kind == GuardKind::kFriction);
    if (at_rest[c] || at_belt_speed(point.time, i, point.x.data())) resting.push_back(i);
  }
  const Eigen::VectorXd reached_at = point.x;
  hold(point.time, resting, point.x.data());
  point.assign(decide(point, at_rest, released));
  if (std::erase_if(resting, [&](Eigen::Index c) {
        const auto i = static_cast<std::size_t>(c);
        return keeps_speed(before[i], point.modes[i], c == reached.contact);
      }) > 0) {
    point.x = reached_at;
    hold(point.time, resting, point.x.data());
  }

  if (contact < 0) record(point, -1, EventKind::kDriveCorner, ContactMode::kStick);
  for (std::size_t c = 0; c < point.modes.size(); ++c)
    if (point.modes[c] != before[c] || static_cast<int>(c) == contact)
      record_change(point, static_cast<int>(c), before[c]);
}

void EventResolver::record(const HybridPoint& point, int contact, EventKind kind, ContactMode before) {
  Event e{point.time, contact, kind, before, before, 0.0, 0.0, 0.0};
  if (contact >= 0) {
    e.after = point.modes[static_cast<std::size_t>(contact)];
    e.displacement =
        kernels::kernels().dot(model_.displacement_row.col(contact).data(), point.x.data(), 2 * model_.np) +
        model_.contact_offset(contact);
    e.velocity = contact_velocity(contact, point.x.data());
    e.force = point.force(contact);
  }
  events_.push_back(e);
}

void EventResolver::record_change(const HybridPoint& point, int contact, ContactMode before) {
  const auto i = static_cast<std::size_t>(contact);
  const ContactMode after = point.modes[i];
  if (laws_[i].kind == LawKind::kClearance) {
    // A stop that has let go is passed again without anything happening.
    if (presses(before) || presses(after))
      record(point, contact, presses(after) ? EventKind::kContact : EventKind::kSeparation, before);
    return;
  }
  const bool jumped = laws_[i].kind == LawKind::kCompliant && after == ContactMode::kStick;
  record(point, contact,
         after == before                     ? (jumped ? EventKind::kJump : EventKind::kGrazing)
         : before == ContactMode::kSeparated ? EventKind::kContact
         : after == ContactMode::kSeparated  ? EventKind::kSeparation
         : before == ContactMode::kStick     ? EventKind::kRelease
         : after == ContactMode::kStick      ? EventKind::kStick
                                             : EventKind::kReversal,
         before);
}

void EventResolver::guard_against_zeno(const HybridPoint& point) {
  recent_.push_back(point.time);
  const auto window = static_cast<std::size_t>(max_events_per_window_);
  if (recent_.size() <= window) return;
  const double since = recent_[recent_.size() - 1 - window];
  constexpr double kInstant = 1e-12;  // of the time: what has no rate of its own
  if (point.time - since < std::max(zeno_window_, kInstant * std::abs(point.time)))
    throw NumericalFailure(fmt::format("Zeno: more than {} events within {:.3g} before t = {:.10g}", window,
                                       point.time - since, point.time),
                           point.time, point.x, point.time - since);
  if (recent_.size() > 8 * window) recent_.erase(recent_.begin(), recent_.end() - static_cast<std::ptrdiff_t>(window));
}

}  // namespace slipmode::dynamics
