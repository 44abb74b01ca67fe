#include "dynamics/prepare.hpp"

#include "core/errors.hpp"
#include "dynamics/load_form.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

/// A clearance this close to a guard, as a share of the sizes at play, is on it.
constexpr double kOnGuard = 1e-12;

/// @param message  called only when the condition fails: runs are too short to compose it each time
template <class Message>
void require(bool condition, const Message& message) {
  if (!condition) throw InvalidInput(message());
}

void check_start(const HybridSystem& system, const State& start) {
  require(start.q.size() == system.size() && start.v.size() == system.size(), [&] {
    return "start state has " + std::to_string(start.q.size()) + " displacements and " +
           std::to_string(start.v.size()) + " velocities; the system has " + std::to_string(system.size()) +
           " degrees of freedom";
  });
  require(start.q.allFinite() && start.v.allFinite() && std::isfinite(start.time),
          [&] { return std::string("start state holds values that are not finite"); });
  require(start.internal.size() == 0 || start.internal.size() == system.internal_size(), [&] {
    return "start state has " + std::to_string(start.internal.size()) + " contact states; the contacts have " +
           std::to_string(system.internal_size());
  });
  require(start.internal.allFinite(),
          [&] { return std::string("start state holds contact states that are not finite"); });
  require(start.modes.empty() || start.modes.size() == system.contacts().size(), [&] {
    return "start state names the modes of " + std::to_string(start.modes.size()) + " contacts; the system has " +
           std::to_string(system.contacts().size());
  });
}

/// Where a clearance is at the start. On a guard to rounding the mode given decides, else the velocity.
ContactMode start_mode(const friction::Clearance& law, const friction::Contact& contact, const State& start,
                       std::size_t c) {
  const double y = contact.direction.dot(start.q) + contact.offset, rate = contact.direction.dot(start.v);
  const double size = contact.direction.cwiseAbs().dot(start.q.cwiseAbs()) + std::abs(contact.offset);
  const ContactMode given = start.modes.empty() ? ContactMode::kSmooth : start.modes[c];
  ContactMode mode = ContactMode::kGap;
  const auto look = [&](const std::optional<friction::Stop>& stop, double side, ContactMode pressed,
                        ContactMode flight) {
    if (!stop) return;
    const double past = side * y - stop->gap, press = stop->stiffness * past + stop->damping * side * rate;
    const double near = kOnGuard * (size + std::abs(stop->gap));
    const bool at_gap = std::abs(past) <= near;
    const double near_press = kOnGuard * (stop->stiffness * (size + std::abs(stop->gap)) +
                                          stop->damping * contact.direction.cwiseAbs().dot(start.v.cwiseAbs()));
    if (at_gap ? (given == pressed || (given != ContactMode::kGap && given != flight && side * rate > 0.0))
               : past > 0.0)
      mode = pressed;
    if (mode != pressed || law.loss == friction::ContactLoss::kGap) return;
    const bool at_zero = std::abs(press) <= near_press;
    if (at_zero ? given == flight : press < 0.0) mode = at_gap ? ContactMode::kGap : flight;
  };
  look(law.right, 1.0, ContactMode::kRightStop, ContactMode::kRightFlight);
  if (mode == ContactMode::kGap) look(law.left, -1.0, ContactMode::kLeftStop, ContactMode::kLeftFlight);
  require(given == ContactMode::kSmooth || given == mode, [&] {
    return "start state says the clearance of contact " + std::to_string(c + 1) + " is in mode " +
           std::to_string(static_cast<int>(given)) + ", but its displacement is " + std::to_string(y) +
           " and its velocity " + std::to_string(rate) + "; leave the modes empty to have them derived";
  });
  return mode;
}

/// Modes at the start: as given, or by the sign of the sliding speed with zero speed left to consistency.
std::vector<ContactMode> start_modes(const HybridSystem& system, const State& start) {
  std::vector<ContactMode> modes(system.contacts().size());
  const double V = system.drive().velocity(start.time);
  for (std::size_t c = 0; c < modes.size(); ++c) {
    const auto& contact = system.contacts()[c];
    if (const auto* clearance = std::get_if<friction::Clearance>(&contact.law)) {
      modes[c] = start_mode(*clearance, contact, start, c);
      continue;
    }
    if (!contact_forces(contact).sticks()) {
      modes[c] = ContactMode::kSmooth;
      continue;
    }
    const double sliding = V - contact.direction.dot(start.v);
    const double scale =
        system.drive().velocity_scale(start.time) + contact.direction.cwiseAbs().dot(start.v.cwiseAbs());
    const ContactMode by_sign = std::abs(sliding) <= 1e-12 * scale ? ContactMode::kStick
                                : sliding > 0                      ? ContactMode::kSlipPositive
                                                                   : ContactMode::kSlipNegative;
    const bool compliant = contact_forces(contact).kind == ContactForces::Kind::kCompliant;
    if (start.modes.empty()) {
      modes[c] = compliant ? ContactMode::kStick : by_sign;
      continue;
    }
    modes[c] = start.modes[c];
    if (compliant || modes[c] == ContactMode::kSeparated) continue;  // decided by the force and the normal load
    const bool agrees = by_sign == ContactMode::kStick || modes[c] == by_sign ||
                        (modes[c] == ContactMode::kStick && std::abs(sliding) <= 1e-9 * std::max(1.0, scale));
    require(agrees && modes[c] != ContactMode::kSmooth, [&] {
      return "start state says contact " + std::to_string(c + 1) + " is in mode " +
             std::to_string(static_cast<int>(modes[c])) + ", but its relative velocity is " + std::to_string(sliding) +
             "; leave the modes empty to have them derived";
    });
  }
  return modes;
}

/// Above this size the closed form's changes of basis, O(n²) per event, cost more than they save.
constexpr Eigen::Index kClosedFormSize = 64;

/// The contacts' own states at the start: as given, or relaxed.
Eigen::VectorXd start_internal(const HybridSystem& system, const State& start) {
  if (start.internal.size() > 0) return start.internal;
  Eigen::VectorXd internal = Eigen::VectorXd::Zero(system.internal_size());
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const friction::Contact& contact = system.contacts()[c];
    const LoadForm load(contact);
    if (!load.oscillates()) continue;
    const Eigen::Index own = system.internal_begin(static_cast<int>(c)) + friction::internal_states(contact) - 2;
    internal(own) = load.lift * (contact.direction.dot(start.q) + contact.offset) / load.stiffness;
  }
  return internal;
}

}  // namespace

FlowMethod choose_method(const HybridSystem& system, FlowMethod asked) {
  int special = 0, nonlinear = 0;  // the last such contact, counted from 1
  const bool forced = system.drive().force() != nullptr;
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const ContactForces law = contact_forces(system.contacts()[c]);
    if (law.needs_closed_form()) special = static_cast<int>(c) + 1;
    if (!law.is_piecewise_linear()) nonlinear = static_cast<int>(c) + 1;
  }
  const auto name = [](int contact) { return "contact " + std::to_string(contact); };
  require(!forced || nonlinear == 0, [&] {
    return "a force drive needs piecewise-linear laws, but " + name(nonlinear) +
           " has a force that depends on the sliding speed: use Coulomb's law, rigid or compliant";
  });
  require(!forced || asked != FlowMethod::kCollocation,
          [&] { return std::string("a force drive needs the closed-form flow"); });
  require(special == 0 || nonlinear == 0, [&] {
    return name(special) +
           " has a contact spring, a clearance, a tilt or a varying load, for which "
           "all laws must be piecewise linear, but " +
           name(nonlinear) + " has a force that depends on the sliding speed";
  });
  require(special == 0 || asked != FlowMethod::kCollocation, [&] {
    return name(special) + " has a contact spring, a clearance, a tilt or a varying load: use the closed-form flow";
  });
  require(nonlinear == 0 || asked != FlowMethod::kClosedForm, [&] {
    return "the closed-form flow needs piecewise-linear laws, but " + name(nonlinear) +
           " has a force that depends on the sliding speed; use the collocation flow, or Coulomb's law";
  });
  if (asked != FlowMethod::kAutomatic) return asked;
  if (forced || special > 0 || (nonlinear == 0 && system.size() <= kClosedFormSize)) return FlowMethod::kClosedForm;
  return FlowMethod::kCollocation;
}

Prepared prepare(const HybridSystem& system, const State& start, FlowOptions options, bool rows_suffice) {
  check_start(system, start);
  require(options.tolerance > 0 && std::isfinite(options.tolerance),
          [&] { return std::string("flow tolerance must be positive"); });
  require(options.max_events_per_window > 0, [&] { return std::string("max_events_per_window must be at least 1"); });
  const bool at_origin = start.q.isZero(0.0) && start.v.isZero(0.0);
  const ModelTables& tables = system.cache().tables(system, rows_suffice && at_origin);
  const ModalModel& m = tables.model;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * m.np);
  if (!at_origin) x = m.from_q * start.q + m.from_v * start.v;
  if (options.zeno_window == 0.0) options.zeno_window = 0.01 * 2.0 * std::numbers::pi / std::max(m.fastest, 1e-300);
  const auto nc = static_cast<Eigen::Index>(system.contacts().size());
  HybridPoint point{start.time,
                    std::move(x),
                    start_modes(system, start),
                    std::vector<int>(static_cast<std::size_t>(nc), 0),
                    Eigen::VectorXd::Zero(nc),
                    start_internal(system, start)};
  return {tables, std::move(point), options};
}

State physical(const ModalModel& m, const HybridPoint& point) {
  if (!m.has_shapes()) return {point.time, {}, {}, point.modes, point.internal};
  return {point.time, m.to_q * point.x, m.to_v * point.x, point.modes, point.internal};
}

}  // namespace slipmode::dynamics
