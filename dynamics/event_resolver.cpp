#include <slipmode/dynamics/event_resolver.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/friction/places.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipmode::dynamics {
namespace {

/// Sliding slower than this share of the velocities at play is no sliding.
constexpr double kAtRest = 1e-13;
/// A speed rounds by this share of them.
constexpr double kSpeedRounds = 8.0 * std::numeric_limits<double>::epsilon();
/// A spring stretched beyond its limit by this share is at it: where sliding has ended, it is but for rounding.
constexpr double kAtLimit = 1e-12;

}  // namespace

void HybridPoint::assign(Resolution resolution) {
  modes = std::move(resolution.modes);
  multiplicity = std::move(resolution.multiplicity);
  force = std::move(resolution.force);
}

void WorkSums::add(double contact, double drive, double viscous, double force) {
  contact_work += contact;
  drive_work += drive;
  viscous_loss += viscous;
  force_work += force;
  exchanged += std::abs(contact) + std::abs(force) + viscous;
}

double clock_rounding(const friction::Drive& drive, double time) {
  return kClockRounds * std::abs(drive.acceleration(time) * time);
}

EventResolver::EventResolver(const HybridSystem& system, const ModalModel& model, const FlowOptions& options)
    : model_(model),
      drive_(system.drive()),
      max_events_per_window_(options.max_events_per_window),
      zeno_window_(options.zeno_window) {
  for (int c = 0; c < model.contacts; ++c) {
    const friction::Contact& contact = system.contacts()[static_cast<std::size_t>(c)];
    laws_.push_back(friction::contact_forces(contact));
    loads_.emplace_back(contact);
    internal_.push_back(system.internal_begin(c));
    oscillator_.push_back(internal_.back() + friction::internal_states(contact) - 2);
  }
  slides_as_.resize(laws_.size());
  std::iota(slides_as_.begin(), slides_as_.end(), 0);
  for (const std::vector<std::size_t>& place : friction::by_place(system.contacts())) {
    const auto alike = [&](std::size_t c) { return laws_[c].kind == LawKind::kCompliant && !laws_[c].varies; };
    const auto first = std::ranges::find_if(place, alike);
    for (const std::size_t c : place)
      if (alike(c)) slides_as_[c] = static_cast<int>(*first);
  }
  for (const ContactForces& law : laws_) clearances_only_ &= law.kind == LawKind::kClearance;
  lone_spring_ = laws_.size() == 1 && laws_[0].kind == LawKind::kCompliant;
  plain_ = laws_.size() == 1 && !laws_[0].is_elaborate();
}

double EventResolver::contact_displacement(int c, const double* x) const {
  return kernels::kernels().dot(model_.displacement_row.col(c).data(), x, 2 * model_.np);
}

const double* EventResolver::own_states(const HybridPoint& point, int c) const {
  return point.internal.data() + oscillator_[static_cast<std::size_t>(c)];
}

double EventResolver::normal_load(const HybridPoint& point, int c) const {
  const friction::LoadForm& load = loads_[static_cast<std::size_t>(c)];
  if (!load.varies()) return load.constant;
  return load.load(contact_displacement(c, point.x.data()), contact_velocity(c, point.x.data()),
                   load.oscillates() ? own_states(point, c) : nullptr);
}

std::vector<ContactForces> EventResolver::laws_at(const HybridPoint& point) const {
  std::vector<ContactForces> laws = laws_;
  for (std::size_t c = 0; c < laws.size(); ++c)
    if (laws[c].varies) laws[c] = law_at(point, static_cast<int>(c));
  return laws;
}

ContactForces EventResolver::law_at(const HybridPoint& point, int c) const {
  const ContactForces& law = laws_[static_cast<std::size_t>(c)];
  return law.varies ? law.under(std::max(normal_load(point, c), 0.0)) : law;
}

double EventResolver::applied_force(const HybridPoint& point, int c) const {
  const auto i = static_cast<std::size_t>(c);
  const ContactMode mode = point.modes[i];
  if (mode == ContactMode::kSeparated) return 0.0;
  if (laws_[i].kind == LawKind::kBristle) return point.force(c);
  if (laws_[i].kind == LawKind::kClearance)
    return laws_[i].clearance.force(stop_side(mode), contact_displacement(c, point.x.data()) + loads_[i].offset,
                                    contact_velocity(c, point.x.data()));
  if (mode == ContactMode::kStick)
    return laws_[i].kind == LawKind::kCompliant ? laws_[i].stiffness * point.internal(internal_[i]) : 0.0;
  if (laws_[i].varies) return law_at(point, c).sliding(sign_of(mode), 0.0);
  return laws_[i].sliding(sign_of(mode), drive_.velocity(point.time) - contact_velocity(c, point.x.data()));
}

void EventResolver::applied_forces(const HybridPoint& point, Eigen::VectorXd& out_forces) const {
  out_forces.resize(model_.contacts);
  for (int c = 0; c < model_.contacts; ++c) out_forces(c) = applied_force(point, c);
}

double EventResolver::slide_velocity(const HybridPoint& point, int c, double direction) const {
  // y_c = y ± μ_k N / K_c: the contact point follows y and the load.
  const auto i = static_cast<std::size_t>(c);
  const friction::LoadForm& load = loads_[i];
  const double* x = point.x.data();
  const double velocity = contact_velocity(c, x), sliding = drive_.velocity(point.time) - velocity;
  if (!load.varies()) return sliding;
  double load_rate = load.y * velocity;
  if (load.v != 0.0) {
    Eigen::VectorXd force = point.force;
    force(c) = direction * law_at(point, c).onset(direction);
    load_rate += load.v * contact_acceleration(instant(point.time, x), c, force);
  }
  if (load.oscillates()) {
    const double* own = own_states(point, c);
    const double own_acceleration = -load.stiffness * own[0] - load.damping * own[1] +
                                    load.lift * (contact_displacement(c, x) + load.offset) + load.lift_rate * velocity;
    load_rate += load.z * own[1] + load.z_rate * own_acceleration;
  }
  return sliding - direction * laws_[i].kinetic_coefficient(direction) * load_rate / laws_[i].stiffness;
}

std::vector<ContactRole> EventResolver::roles(const std::vector<ContactMode>& modes) const {
  std::vector<ContactRole> roles;
  for (std::size_t c = 0; c < modes.size(); ++c) {
    const bool compliant = laws_[c].kind == LawKind::kCompliant;
    switch (modes[c]) {
      case ContactMode::kStick:
        roles.push_back(compliant ? ContactRole::kSprung : ContactRole::kHeld);
        break;
      case ContactMode::kSeparated:
        roles.push_back(ContactRole::kSeparated);
        break;
      case ContactMode::kSlipNegative:
        roles.push_back(laws_[c].varies ? ContactRole::kSlidingNegative : ContactRole::kSliding);
        break;
      case ContactMode::kSlipPositive:
        roles.push_back(laws_[c].varies ? ContactRole::kSlidingPositive : ContactRole::kSliding);
        break;
      case ContactMode::kSmooth:
        roles.push_back(ContactRole::kSliding);
        break;
      case ContactMode::kGap:
        roles.push_back(ContactRole::kGap);
        break;
      case ContactMode::kLeftStop:
        roles.push_back(ContactRole::kLeftStop);
        break;
      case ContactMode::kRightStop:
        roles.push_back(ContactRole::kRightStop);
        break;
      case ContactMode::kLeftFlight:
        roles.push_back(ContactRole::kLeftFlight);
        break;
      case ContactMode::kRightFlight:
        roles.push_back(ContactRole::kRightFlight);
        break;
    }
  }
  return roles;
}

double EventResolver::regime_input(const HybridPoint& point, int c) const {
  const auto i = static_cast<std::size_t>(c);
  const ContactMode mode = point.modes[i];
  if (mode == ContactMode::kSeparated) return 0.0;
  if (laws_[i].kind == LawKind::kClearance) return laws_[i].clearance.force(stop_side(mode), loads_[i].offset, 0.0);
  if (mode == ContactMode::kStick) {
    const double stretch = laws_[i].kind == LawKind::kCompliant ? point.internal(internal_[i]) : 0.0;
    return contact_displacement(c, point.x.data()) + stretch;
  }
  if (!laws_[i].varies) return point.force(c);
  const double sign = sign_of(mode);
  return sign * laws_[i].kinetic_coefficient(sign) * loads_[i].constant;
}

Eigen::VectorXd EventResolver::drive_force(double time) const {
  const friction::Force* drive = drive_.force();
  if (drive == nullptr) return {};
  return Eigen::VectorXd::NullaryExpr(model_.force_input.cols(),
                                      [&](Eigen::Index k) { return drive->value(static_cast<int>(k), time); });
}

Eigen::VectorXd EventResolver::drive_force_rate(double time) const {
  const friction::Force* drive = drive_.force();
  if (drive == nullptr) return {};
  return Eigen::VectorXd::NullaryExpr(model_.force_input.cols(),
                                      [&](Eigen::Index k) { return drive->rate(static_cast<int>(k), time); });
}

Instant EventResolver::instant(double time, const double* x) const {
  Instant now{model_, laws_, x, time, drive_.velocity(time), drive_.acceleration(time)};
  now.force = drive_force(time);
  return now;
}

Instant EventResolver::instant(const HybridPoint& point, const std::vector<ContactForces>& laws,
                               const Eigen::VectorXd& applied) const {
  const double V = drive_.velocity(point.time);
  const double jerk = drive_.shaker() == nullptr ? 0.0 : -drive_.shaker()->omega() * drive_.shaker()->omega() * V;
  return {model_,
          laws,
          point.x.data(),
          point.time,
          V,
          drive_.acceleration(point.time),
          &applied,
          jerk,
          drive_force(point.time),
          drive_force_rate(point.time),
          limit_sizes(point)};
}

Eigen::VectorXd EventResolver::limit_sizes(const HybridPoint& point) const {
  if (std::ranges::none_of(laws_, &ContactForces::varies)) return {};
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(model_.contacts);
  const auto row_size = [&](const Eigen::MatrixXd& rows, int c) {
    return rows.col(c).cwiseAbs().dot(point.x.cwiseAbs());
  };
  for (int c = 0; c < model_.contacts; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (!laws_[i].varies) continue;
    const friction::LoadForm& load = loads_[i];
    sizes(c) = laws_[i]
                   .under(load.size(row_size(model_.displacement_row, c), row_size(model_.velocity_row, c),
                                    load.oscillates() ? own_states(point, c) : nullptr))
                   .static_limit;
  }
  return sizes;
}

double EventResolver::contact_velocity(int c, const double* x) const {
  return kernels::kernels().dot(model_.velocity_row.col(c).data(), x, 2 * model_.np);
}

bool EventResolver::at_belt_speed(double time, int c, const double* x) const {
  return at_belt_speed(time, c, x, kAtRest);
}

bool EventResolver::at_belt_speed(double time, int c, const double* x, double share) const {
  const Eigen::Map<const Eigen::VectorXd> state(x, 2 * model_.np);
  const auto row = model_.velocity_row.col(c).cwiseAbs();
  double scale = row.dot(state.cwiseAbs()) + drive_.velocity_scale(time);
  // Where all is at rest, speeds round by what the displacements would become.
  const auto np = model_.np;
  if (model_.proportional)
    scale += row.tail(np).dot(model_.omega.cwiseProduct(state.head(np).cwiseAbs()));
  else
    scale += (row.head(np).cwiseAbs2() + row.tail(np).cwiseAbs2())
                 .cwiseSqrt()
                 .dot((state.head(np).cwiseAbs2() + state.tail(np).cwiseAbs2()).cwiseSqrt());
  return std::abs(drive_.velocity(time) - contact_velocity(c, x)) <= share * scale + clock_rounding(drive_, time);
}

void EventResolver::start(HybridPoint& point) {
  if (clearances_only_) {
    applied_forces(point, point.force);
    return;
  }
  const std::vector<ContactMode> given = point.modes;
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    const auto i = static_cast<int>(c);
    if (laws_[c].varies && normal_load(point, i) < 0.0) point.modes[c] = ContactMode::kSeparated;
    if (laws_[c].kind != LawKind::kCompliant) continue;
    double& stretch = point.internal(internal_[c]);
    if (point.modes[c] == ContactMode::kSeparated) {
      stretch = 0.0;
      continue;
    }
    const ContactForces law = law_at(point, i);
    const double force = law.stiffness * stretch;
    if (point.modes[c] == ContactMode::kStick && std::abs(force) > law.limit(force) * (1.0 + kAtLimit))
      point.modes[c] = force > 0 ? ContactMode::kSlipPositive : ContactMode::kSlipNegative;
    if (point.modes[c] != ContactMode::kStick) stretch = law.sliding(sign_of(point.modes[c]), 0.0) / law.stiffness;
  }
  std::vector<bool> at_rest;
  for (std::size_t c = 0; c < laws_.size(); ++c)
    at_rest.push_back(point.modes[c] == ContactMode::kStick && laws_[c].kind != LawKind::kCompliant);
  const std::vector<ContactForces> laws = laws_at(point);
  // A load that follows the speed changes with the acceleration, and so with the forces at all contacts.
  applied_forces(point, point.force);
  stick_forces(instant(point, laws, point.force), at_rest, point.force);
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    if (laws_[c].kind != LawKind::kCompliant || point.modes[c] == ContactMode::kSeparated) continue;
    const double sign = sign_of(point.modes[c]);
    if (sign * slide_velocity(point, static_cast<int>(c), sign) < 0.0) point.modes[c] = ContactMode::kStick;
  }
  const Eigen::VectorXd force = point.force;
  point.assign(decide(point, at_rest, std::vector<bool>(at_rest.size())));
  if (point.goes_on && point.modes != given) record_start(point, given, force);
  // A stick that is off by no more than its speed rounds by is left as it is: a run goes on in the same bytes.
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    const bool rigid = laws_[c].kind != LawKind::kCompliant;
    if (rigid && point.modes[c] == ContactMode::kStick &&
        !at_belt_speed(point.time, static_cast<int>(c), point.x.data(), kSpeedRounds))
      return hold(point.time, point.modes, point.x.data());
  }
}

void EventResolver::record_start(const HybridPoint& point, const std::vector<ContactMode>& before,
                                 const Eigen::VectorXd& force_before) {
  for (std::size_t c = 0; c < before.size(); ++c) {
    const auto i = static_cast<int>(c);
    if (point.modes[c] == before[c]) continue;
    record_change(point, i, before[c]);
    if (turn_at_start_.contact >= 0 || !decides_by_acceleration(point, c) || before[c] == ContactMode::kStick) continue;
    const Instant now = instant(point.time, point.x.data());
    turn_at_start_ = {i, now.belt_acceleration - contact_acceleration(now, i, force_before),
                      point.force - force_before};
  }
}

Resolution EventResolver::decide(const HybridPoint& point, std::vector<bool> at_rest,
                                 const std::vector<bool>& released) const {
  const std::vector<ContactForces> laws = laws_at(point);
  Eigen::VectorXd applied;
  applied_forces(point, applied);
  const Instant here = instant(point, laws, applied);
  // A contact said to slide at zero speed, at a start or since it was let go at this instant, does so if its
  // acceleration takes it there; else it is at rest.
  for (;;) {
    Resolution found = resolve(here, point.modes, at_rest, released);
    bool again = false;
    for (std::size_t c = 0; c < at_rest.size(); ++c) {
      const auto i = static_cast<int>(c);
      if (at_rest[c] || !decides_by_acceleration(point, c) || !at_belt_speed(point.time, i, point.x.data())) continue;
      const int multiplicity = start_multiplicity(here, i, found.modes[c], found.force);
      found.multiplicity[c] = std::max(multiplicity, 0);
      if (multiplicity < 0) again = at_rest[c] = true;
    }
    if (!again) return found;
  }
}

bool EventResolver::decides_by_acceleration(const HybridPoint& point, std::size_t c) const {
  return laws_[c].sticks() && laws_[c].kind != LawKind::kCompliant && point.modes[c] != ContactMode::kSeparated;
}

void EventResolver::hold(double time, const std::vector<ContactMode>& modes, double* x) const {
  std::vector<Eigen::Index> stuck;
  for (std::size_t c = 0; c < modes.size(); ++c)
    if (modes[c] == ContactMode::kStick && laws_[c].kind != LawKind::kCompliant)
      stuck.push_back(static_cast<Eigen::Index>(c));
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

Eigen::VectorXd EventResolver::deflections(const HybridPoint& point) const {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(model_.contacts);
  for (int c = 0; c < model_.contacts; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws_[i].kind == LawKind::kBristle) z(c) = point.internal(internal_[i]);
  }
  return z;
}

}  // namespace slipmode::dynamics
