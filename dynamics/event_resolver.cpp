#include "dynamics/event_resolver.hpp"

#include "core/errors.hpp"
#include "dynamics/pair_kernels.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Sliding slower than this share of the velocities at play is no sliding.
constexpr double kAtRest = 1e-13;

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
      belt_(system.drive()),
      max_events_per_window_(options.max_events_per_window),
      zeno_window_(options.zeno_window) {
  for (const auto& contact : system.contacts()) laws_.push_back(contact_forces(contact));
}

Instant EventResolver::instant(double time, const double* x) const {
  return {model_, laws_, x, time, belt_.velocity(time), belt_.acceleration(time)};
}

double EventResolver::contact_velocity(int c, const double* x) const {
  return dot_padded(model_.velocity_row.col(c).data(), x, 2 * model_.np);
}

void EventResolver::start(HybridPoint& point) const {
  std::vector<bool> at_rest;
  for (const ContactMode mode : point.modes) at_rest.push_back(mode == ContactMode::kStick);
  assign(point, resolve(instant(point.time, point.x.data()), point.modes, at_rest, -1));
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
  const double force_before = point.force(0), gap = belt_.velocity(point.time) - contact_velocity(0, point.x.data());
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
  const double V = belt_.velocity(point.time);
  std::vector<bool> at_rest(point.modes.size());
  std::vector<Eigen::Index> resting;
  for (std::size_t c = 0; c < point.modes.size(); ++c) {
    const auto i = static_cast<int>(c);
    if (!laws_[c].sticks()) continue;
    const double speed = std::abs(V - contact_velocity(i, point.x.data()));
    const double scale = model_.velocity_row.col(i).cwiseAbs().dot(point.x.cwiseAbs()) + std::abs(V);
    at_rest[c] = point.modes[c] == ContactMode::kStick || i == contact || speed <= kAtRest * scale;
    if (at_rest[c]) resting.push_back(i);
  }
  if (!resting.empty()) {
    Eigen::VectorXd gap(static_cast<Eigen::Index>(resting.size()));
    for (Eigen::Index k = 0; k < gap.size(); ++k)
      gap(k) = V - contact_velocity(static_cast<int>(resting[static_cast<std::size_t>(k)]), point.x.data());
    point.x += Eigen::MatrixXd(model_.input(Eigen::all, resting)) *
               Eigen::MatrixXd(model_.mobility(resting, resting)).ldlt().solve(gap);
  }

  const bool released = contact >= 0 && point.modes[static_cast<std::size_t>(contact)] == ContactMode::kStick;
  const std::vector<ContactMode> before = point.modes;
  assign(point, resolve(instant(point.time, point.x.data()), point.modes, at_rest, released ? contact : -1));

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
