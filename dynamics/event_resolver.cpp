#include "dynamics/event_resolver.hpp"

#include "core/errors.hpp"
#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Sliding slower than this share of the velocities at play is no sliding.
constexpr double kAtRest = 1e-13;
/// A stick force this close to its limit (relative), and rising, reaches it together with the one that has.
constexpr double kTogether = 1e-9;

void assign(HybridPoint& point, Resolution resolution) {
  point.modes = std::move(resolution.modes);
  point.multiplicity = std::move(resolution.multiplicity);
  point.force = std::move(resolution.force);
}

}  // namespace

void WorkSums::add(double contact, double drive, double viscous) {
  contact_work += contact;
  drive_work += drive;
  viscous_loss += viscous;
  exchanged += std::abs(contact) + viscous;
}

EventResolver::EventResolver(const HybridSystem& system, const ModalModel& model, const FlowOptions& options)
    : model_(model),
      drive_(system.drive()),
      max_events_per_window_(options.max_events_per_window),
      zeno_window_(options.zeno_window) {
  for (const auto& contact : system.contacts()) laws_.push_back(contact_forces(contact));
}

Instant EventResolver::instant(double time, const double* x) const {
  return {model_, laws_, x, time, drive_.velocity(time), drive_.acceleration(time)};
}

double EventResolver::contact_velocity(int c, const double* x) const {
  return dot_padded(model_.velocity_row.col(c).data(), x, 2 * model_.np);
}

bool EventResolver::at_belt_speed(double time, int c, const double* x) const {
  const double V = drive_.velocity(time);
  const Eigen::Map<const Eigen::VectorXd> state(x, 2 * model_.np);
  const double scale = model_.velocity_row.col(c).cwiseAbs().dot(state.cwiseAbs()) + std::abs(V);
  return std::abs(V - contact_velocity(c, x)) <= kAtRest * scale;
}

void EventResolver::start(HybridPoint& point) const {
  const Instant now = instant(point.time, point.x.data());
  std::vector<bool> at_rest;
  for (const ContactMode mode : point.modes) at_rest.push_back(mode == ContactMode::kStick);
  const std::vector<bool> none(at_rest.size(), false);
  Resolution first = resolve(now, point.modes, at_rest, none);
  // A contact said to slide at zero speed does so if its acceleration takes it there; else it is at rest.
  bool again = false;
  for (std::size_t c = 0; c < at_rest.size(); ++c) {
    const auto i = static_cast<int>(c);
    if (at_rest[c] || !laws_[c].sticks() || !at_belt_speed(point.time, i, point.x.data())) continue;
    const int multiplicity = start_multiplicity(now, i, first.modes[c], first.force);
    first.multiplicity[c] = std::max(multiplicity, 0);
    if (multiplicity < 0) again = at_rest[c] = true;
  }
  assign(point, again ? resolve(now, point.modes, at_rest, none) : std::move(first));
}

void EventResolver::hold(double time, const std::vector<ContactMode>& modes, double* x) const {
  std::vector<Eigen::Index> stuck;
  for (std::size_t c = 0; c < modes.size(); ++c)
    if (modes[c] == ContactMode::kStick) stuck.push_back(static_cast<Eigen::Index>(c));
  hold(time, stuck, x);
}

void EventResolver::hold(double time, const std::vector<Eigen::Index>& contacts, double* x) const {
  if (contacts.empty()) return;
  const double V = drive_.velocity(time);
  Eigen::VectorXd gap(static_cast<Eigen::Index>(contacts.size()));
  for (Eigen::Index k = 0; k < gap.size(); ++k)
    gap(k) = V - contact_velocity(static_cast<int>(contacts[static_cast<std::size_t>(k)]), x);
  Eigen::Map<Eigen::VectorXd>(x, 2 * model_.np) +=
      Eigen::MatrixXd(model_.input(Eigen::all, contacts)) *
      Eigen::MatrixXd(model_.mobility(contacts, contacts)).ldlt().solve(gap);
}

Eigen::VectorXd EventResolver::forces(double time, const std::vector<ContactMode>& modes, const double* x) const {
  Eigen::VectorXd force(model_.contacts);
  std::vector<bool> stuck(modes.size());
  for (std::size_t c = 0; c < modes.size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    stuck[c] = modes[c] == ContactMode::kStick;
    if (!stuck[c])
      force(i) = laws_[c].sliding(modes[c], drive_.velocity(time) - contact_velocity(static_cast<int>(c), x));
  }
  stick_forces(instant(time, x), stuck, force);
  return force;
}

std::vector<bool> EventResolver::released_together(const HybridPoint& point, int contact) const {
  std::vector<bool> released(point.modes.size());
  if (contact < 0 || point.modes[static_cast<std::size_t>(contact)] != ContactMode::kStick) return released;
  const Instant now = instant(point.time, point.x.data());
  std::vector<bool> stuck;
  for (const ContactMode mode : point.modes) stuck.push_back(mode == ContactMode::kStick);
  Eigen::VectorXd force = point.force, rate;
  stick_forces(now, stuck, force);
  for (std::size_t c = 0; c < released.size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    if (i == contact) {
      released[c] = true;
    } else if (stuck[c] && std::abs(force(i)) >= laws_[c].static_limit * (1 - kTogether)) {
      if (rate.size() == 0) rate = stick_force_rates(now, point.modes, force);
      released[c] = rate(i) * force(i) > 0;
    }
  }
  return released;
}

void EventResolver::settle(HybridPoint& point, int contact, bool touching) {
  if (contact >= 0 && touching) {
    const auto i = static_cast<std::size_t>(contact);
    record(point, contact, EventKind::kGrazing, point.modes[i]);
    point.multiplicity[i] = point.modes[i] == ContactMode::kStick ? 0 : 2;
  } else if (laws_.size() == 1 && contact == 0) {
    settle_single(point);
  } else {
    settle_coupled(point, contact);
  }
  guard_against_zeno(point);
}

void EventResolver::settle_single(HybridPoint& point) {
  const ContactMode before = point.modes[0];
  const double force_before = point.force(0), gap = drive_.velocity(point.time) - contact_velocity(0, point.x.data());
  const double impulse = gap / model_.mobility(0, 0);
  const double* input = model_.input.data();
  for (Eigen::Index i = 0; i < 2 * model_.np; i += kLanes)
    store8(point.x.data() + i, load8(point.x.data() + i) + impulse * load8(input + i));
  const SingleResolution next =
      resolve_single(instant(point.time, point.x.data()), before == ContactMode::kStick, force_before > 0 ? 1.0 : -1.0);
  point.modes[0] = next.mode;
  point.multiplicity[0] = next.multiplicity;
  point.force(0) = next.force;
  record_change(point, 0, before);
}

void EventResolver::settle_coupled(HybridPoint& point, int contact) {
  // Contacts at rest on the belt, to be decided together: the sticking ones, the one whose guard was reached, and any
  // other whose sliding speed is zero to rounding.
  std::vector<bool> at_rest(point.modes.size());
  std::vector<Eigen::Index> resting;
  for (std::size_t c = 0; c < point.modes.size(); ++c) {
    const auto i = static_cast<int>(c);
    if (!laws_[c].sticks()) continue;
    at_rest[c] = point.modes[c] == ContactMode::kStick || i == contact || at_belt_speed(point.time, i, point.x.data());
    if (at_rest[c]) resting.push_back(i);
  }
  hold(point.time, resting, point.x.data());
  const std::vector<ContactMode> before = point.modes;
  const std::vector<bool> released = released_together(point, contact);
  assign(point, resolve(instant(point.time, point.x.data()), point.modes, at_rest, released));

  if (contact < 0) record(point, -1, EventKind::kDriveCorner, ContactMode::kStick);
  for (std::size_t c = 0; c < point.modes.size(); ++c)
    if (point.modes[c] != before[c] || static_cast<int>(c) == contact)
      record_change(point, static_cast<int>(c), before[c]);
}

void EventResolver::record(const HybridPoint& point, int contact, EventKind kind, ContactMode before) {
  Event e{point.time, contact, kind, before, before, 0.0, 0.0, 0.0};
  if (contact >= 0) {
    e.after = point.modes[static_cast<std::size_t>(contact)];
    e.displacement = dot_padded(model_.displacement_row.col(contact).data(), point.x.data(), 2 * model_.np) +
                     model_.contact_offset(contact);
    e.velocity = contact_velocity(contact, point.x.data());
    e.force = point.force(contact);
  }
  events_.push_back(e);
}

void EventResolver::record_change(const HybridPoint& point, int contact, ContactMode before) {
  const ContactMode after = point.modes[static_cast<std::size_t>(contact)];
  record(point, contact,
         after == before                 ? EventKind::kGrazing
         : before == ContactMode::kStick ? EventKind::kRelease
         : after == ContactMode::kStick  ? EventKind::kStick
                                         : EventKind::kReversal,
         before);
}

void EventResolver::guard_against_zeno(const HybridPoint& point) {
  recent_.push_back(point.time);
  const auto window = static_cast<std::size_t>(max_events_per_window_);
  if (recent_.size() <= window) return;
  const double since = recent_[recent_.size() - 1 - window];
  if (point.time - since < zeno_window_)
    throw NumericalFailure("Zeno: more than " + std::to_string(window) + " events within " +
                               std::to_string(zeno_window_) + " before t = " + std::to_string(point.time),
                           point.time, point.x, point.time - since);
  if (recent_.size() > 8 * window) recent_.erase(recent_.begin(), recent_.end() - static_cast<std::ptrdiff_t>(window));
}

}  // namespace slipmode::dynamics
