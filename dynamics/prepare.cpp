#include <slipmode/dynamics/prepare.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/friction/engaged.hpp>
#include <slipmode/friction/load_form.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace slipmode::dynamics {
namespace {

/// A clearance this close to a guard, as a share of the sizes at play, is on it; a flow locates guards to that share of
/// them.
constexpr double kOnGuard = 1e-12;
/// The same where the state says its mode: it may come from a run that ended at an event, whose time was rounded.
constexpr double kOnGuardAsGiven = 1e-9;
/// And by this share of what its place is the sum of: flows tell a stop that is met from rest no sooner; by collocation
/// by so many tolerances, which are what contacts' forces may push it by.
constexpr double kToldTo = 1e-11, kToldToTolerances = 100.0;
constexpr double kModalRounding = 64.0 * std::numeric_limits<double>::epsilon();

/// What the rounding of a contact's displacement, or speed, is a share of: states come from a projection or from modal
/// coordinates, which round by all of the motion, not by what is at the contact, and by more where modes nearly cancel
/// each other.
/// @param values  of all degrees of freedom @param x  the start in modal coordinates @param rows  its readings there
double motion_size(const friction::Contact& contact, const Eigen::VectorXd& values, const Eigen::VectorXd& x,
                   const Eigen::MatrixXd& rows, std::size_t c) {
  return contact.direction.lpNorm<1>() * values.lpNorm<Eigen::Infinity>() +
         rows.col(static_cast<Eigen::Index>(c)).cwiseAbs().dot(x.cwiseAbs());
}

/// @param message  called only when the condition fails: runs are too short to compose it each time
template <class Message>
void require_or_say(bool condition, const Message& message) {
  if (!condition) throw InvalidInput(message());
}

void check_start(const HybridSystem& system, const State& start) {
  require_or_say(start.q.size() == system.size() && start.v.size() == system.size(), [&] {
    return "start state has " + std::to_string(start.q.size()) + " displacements and " +
           std::to_string(start.v.size()) + " velocities; the system has " + std::to_string(system.size()) +
           " degrees of freedom";
  });
  require_or_say(start.q.allFinite() && start.v.allFinite() && std::isfinite(start.time),
                 [&] { return std::string("start state holds values that are not finite"); });
  require_or_say(start.internal.size() == 0 || start.internal.size() == system.internal_size(), [&] {
    return "start state has " + std::to_string(start.internal.size()) + " contact states; the contacts have " +
           std::to_string(system.internal_size());
  });
  require_or_say(start.internal.allFinite(),
                 [&] { return std::string("start state holds contact states that are not finite"); });
  require_or_say(start.modes.empty() || start.modes.size() == system.contacts().size(), [&] {
    return "start state names the modes of " + std::to_string(start.modes.size()) + " contacts; the system has " +
           std::to_string(system.contacts().size());
  });
}

/// How far a clearance is past one of its stops, and what that stop presses with or would.
struct AtStop {
  const friction::Stop& stop;
  double past, press, rate;
  double size, press_size;    ///< which rounding is measured by
  double on_guard, on_press;  ///< what may be off where the state says its mode

  /// @param motion, speeds  see motion_size() @param told_to  what a flow tells, as a share of these
  AtStop(const friction::Stop& own, double side, const friction::Contact& contact, const State& start, double motion,
         double speeds, double told_to)
      : stop(own) {
    const double y = contact.direction.dot(start.q) + contact.offset;
    rate = side * contact.direction.dot(start.v);
    past = side * y - stop.gap;
    press = stop.stiffness * past + stop.damping * rate;
    // An event's time is rounded, and where it is not small that may be more than the displacements' own rounding.
    size = contact.direction.cwiseAbs().dot(start.q.cwiseAbs() + std::abs(start.time) * start.v.cwiseAbs()) +
           std::abs(contact.offset) + std::abs(stop.gap);
    press_size = stop.stiffness * size + stop.damping * contact.direction.cwiseAbs().dot(start.v.cwiseAbs());
    on_guard = kOnGuardAsGiven * size + told_to * motion;
    on_press = kOnGuardAsGiven * press_size + told_to * (stop.stiffness * motion + stop.damping * speeds);
  }
};

bool agrees(const friction::Clearance& law, ContactMode mode, const std::optional<AtStop>& left,
            const std::optional<AtStop>& right) {
  const auto beyond = [](const AtStop& at) { return at.past >= -at.on_guard; };
  const auto pressed = [&](const std::optional<AtStop>& at) {
    return at && beyond(*at) && (law.loss == friction::ContactLoss::kGap || at->press >= -at->on_press);
  };
  const auto flies = [&](const std::optional<AtStop>& at) {
    return at && beyond(*at) && law.loss == friction::ContactLoss::kZeroForce && at->press <= at->on_press;
  };
  const auto free = [](const std::optional<AtStop>& at) { return !at || at->past <= at->on_guard; };
  switch (mode) {
    case ContactMode::kGap:
      return free(left) && free(right);
    case ContactMode::kLeftStop:
      return pressed(left);
    case ContactMode::kRightStop:
      return pressed(right);
    case ContactMode::kLeftFlight:
      return flies(left);
    case ContactMode::kRightFlight:
      return flies(right);
    default:
      return false;
  }
}

/// A drive that swings slower than this share of the pace has hardly begun to when a stop is told.
constexpr double kSlowest = 1e-4;

/// A size of how far loads and friction push a contact in a radian of the fastest mode, mode by mode, before it shows
/// through the structure; and of how far the drive swings it in the long run: with a shaker, or as a force would at its
/// frequency if there were no resonance [m].
double pushed(const HybridSystem& system, const ModalModel& m, std::size_t c) {
  const auto i = static_cast<Eigen::Index>(c);
  const auto row = m.velocity_row.col(i).cwiseAbs();
  const auto in_a_radian = [&](const auto& input) { return row.dot(input.cwiseAbs()) / (m.pace() * m.pace()); };
  double most = in_a_radian(m.load);
  for (std::size_t d = 0; d < system.contacts().size(); ++d)
    if (const double limit = contact_forces(system.contacts()[d]).most(); std::isfinite(limit))
      most += limit * in_a_radian(m.input.col(static_cast<Eigen::Index>(d)));
  if (const friction::Shaker* shaker = system.drive().shaker())
    most += shaker->amplitude * system.contacts()[c].direction.lpNorm<1>();
  if (const friction::Force* force = system.drive().force())
    for (const friction::ForceHarmonic& h : force->harmonics) {
      // (Ω − G)⁻¹ b, at a real frequency: of what decays the determinant is Ω² at least.
      const double rate = std::max(h.order * force->omega, kSlowest * m.pace());
      const auto input = m.force_input.col(h.direction);
      const Eigen::ArrayXd a = rate - m.g11.array(), d = rate - m.g22.array(), b1 = input.head(m.np),
                           b2 = input.tail(m.np);
      const Eigen::ArrayXd det = (a * d - m.g12.array() * m.g21.array()).max(rate * rate);
      Eigen::VectorXd x(2 * m.np);
      x << (d * b1 + m.g12.array() * b2) / det, (m.g21.array() * b1 + a * b2) / det;
      const double swings = m.displacement_row.col(i).cwiseAbs().dot(x.cwiseAbs());
      most += std::abs(h.amplitude) * std::max(swings, in_a_radian(input));
    }
  return most;
}

/// What the flow tells a stop that is met from rest to.
double told_to(const FlowOptions& options) {
  if (options.method == FlowMethod::kClosedForm) return kToldTo;
  return std::max(kToldTo, kToldToTolerances * options.tolerance);
}

/// Where a clearance is at the start: as given, or by position and force; on a guard to rounding by the velocity.
ContactMode start_mode(const friction::Clearance& law, const HybridSystem& system, const State& start, std::size_t c,
                       const ModalModel& m, const Eigen::VectorXd& x, double told_to) {
  const friction::Contact& contact = system.contacts()[c];
  const auto i = static_cast<Eigen::Index>(c);
  const double speeds = motion_size(contact, start.v, x, m.velocity_row, c);
  // What has only begun to move is placed by what its speed makes of it, what pushes it, and, as the small difference
  // of free motion and where it swings in the long run, by that.
  const double rate = std::max(m.fastest, std::sqrt(friction::engaged_stiffness(contact.law) * m.mobility(i, i)));
  const double by_force = start.modes.empty() ? 0.0 : pushed(system, m, c);
  const double motion = motion_size(contact, start.q, x, m.displacement_row, c) + speeds / rate + by_force;
  std::optional<AtStop> left, right;
  if (law.left) left.emplace(*law.left, -1.0, contact, start, motion, speeds, told_to);
  if (law.right) right.emplace(*law.right, 1.0, contact, start, motion, speeds, told_to);
  if (!start.modes.empty()) {
    const ContactMode given = start.modes[c];
    require_or_say(agrees(law, given, left, right), [&] {
      return "start state says the clearance of contact " + std::to_string(c + 1) + " is in mode " +
             std::to_string(static_cast<int>(given)) + ", but its displacement is " +
             std::to_string(contact.direction.dot(start.q) + contact.offset) + " and its velocity " +
             std::to_string(contact.direction.dot(start.v)) + "; leave the modes empty to have them derived";
    });
    return given;
  }
  const auto reached = [](const std::optional<AtStop>& at) {
    return at && (std::abs(at->past) <= kOnGuard * at->size ? at->rate > 0.0 : at->past > 0.0);
  };
  const auto lets_go = [&](const AtStop& at) {
    return law.loss == friction::ContactLoss::kZeroForce && at.press < -kOnGuard * at.press_size;
  };
  if (reached(right)) return lets_go(*right) ? ContactMode::kRightFlight : ContactMode::kRightStop;
  if (reached(left)) return lets_go(*left) ? ContactMode::kLeftFlight : ContactMode::kLeftStop;
  return ContactMode::kGap;
}

/// The speed that a contact's own force makes in a radian [m/s].
double speed_of_force(const friction::Contact& contact, std::size_t c, const ModalModel& m) {
  const auto i = static_cast<Eigen::Index>(c);
  return contact_forces(contact).most() * m.mobility(i, i) / m.pace();
}

/// What a contact is accelerated by at most [m/s²], but for contacts' own forces.
double most_acceleration(std::size_t c, const ModalModel& m, const Eigen::VectorXd& x) {
  const auto i = static_cast<Eigen::Index>(c);
  return m.acceleration_row.col(i).cwiseAbs().dot(x.cwiseAbs()) + std::abs(m.load_acceleration(i));
}

/// A run that ended at an event leaves a sliding speed of rounding, of either sign: this share of the speeds at play.
constexpr double kOffGuard = 1e-9;

/// Modes at the start: as given, or by the sign of the sliding speed with zero speed left to consistency.
std::vector<ContactMode> start_modes(const HybridSystem& system, const ModalModel& m, const State& start,
                                     const Eigen::VectorXd& x, const FlowOptions& options) {
  std::vector<ContactMode> modes(system.contacts().size());
  const double V = system.drive().velocity(start.time);
  for (std::size_t c = 0; c < modes.size(); ++c) {
    const auto& contact = system.contacts()[c];
    if (const auto* clearance = friction::clearance(contact.law)) {
      modes[c] = start_mode(*clearance, system, start, c, m, x, told_to(options));
      continue;
    }
    if (!contact_forces(contact).sticks()) {
      const bool given = !start.modes.empty() && std::abs(sign_of(start.modes[c])) == 1.0;
      modes[c] = given && friction::kind(contact.law) == LawKind::kBristle ? start.modes[c] : ContactMode::kSmooth;
      continue;
    }
    const double sliding = V - contact.direction.dot(start.v);
    const double scale =
        system.drive().velocity_scale(start.time) + contact.direction.cwiseAbs().dot(start.v.cwiseAbs());
    const double at_rest = 1e-12 * scale + kModalRounding * motion_size(contact, start.v, x, m.velocity_row, c);
    const ContactMode by_sign = std::abs(sliding) <= at_rest ? ContactMode::kStick
                                : sliding > 0                ? ContactMode::kSlipPositive
                                                             : ContactMode::kSlipNegative;
    const bool compliant = friction::kind(contact.law) == LawKind::kCompliant;
    if (start.modes.empty()) {
      modes[c] = compliant ? ContactMode::kStick : by_sign;
      continue;
    }
    modes[c] = start.modes[c];
    if (compliant || modes[c] == ContactMode::kSeparated) continue;  // decided by the force and the normal load
    const bool agrees = by_sign == ContactMode::kStick || modes[c] == by_sign ||
                        std::abs(sliding) <= kOffGuard * (scale + speed_of_force(contact, c, m)) +
                                                 clock_rounding(system.drive(), start.time) +
                                                 kClockRounds * std::abs(start.time) * most_acceleration(c, m, x);
    require_or_say(agrees && modes[c] != ContactMode::kSmooth, [&] {
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
    const friction::LoadForm load(contact);
    if (!load.oscillates()) continue;
    const Eigen::Index own = system.internal_begin(static_cast<int>(c)) + friction::internal_states(contact) - 2;
    internal(own) = load.lift * (contact.direction.dot(start.q) + contact.offset) / load.stiffness;
  }
  return internal;
}

}  // namespace

FlowMethod choose_method(const HybridSystem& system, FlowMethod asked) {
  int elaborate = 0, oscillates = 0, nonlinear = 0;  // the last such contact, counted from 1
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const ContactForces law = contact_forces(system.contacts()[c]);
    const int number = static_cast<int>(c) + 1;
    if (law.is_elaborate()) elaborate = number;
    if (friction::LoadForm(system.contacts()[c]).oscillates()) oscillates = number;
    if (!is_piecewise_linear(law.kind)) nonlinear = number;
  }
  const auto name = [](int contact) { return "contact " + std::to_string(contact); };
  require_or_say(oscillates == 0 || nonlinear == 0, [&] {
    return name(oscillates) + " has a normal oscillator, for which all laws must be piecewise linear, but " +
           name(nonlinear) + " has a force that depends on the sliding speed";
  });
  require_or_say(oscillates == 0 || asked != FlowMethod::kCollocation,
                 [&] { return name(oscillates) + " has a normal oscillator: use the closed-form flow"; });
  require_or_say(nonlinear == 0 || asked != FlowMethod::kClosedForm, [&] {
    return "the closed-form flow needs piecewise-linear laws, but " + name(nonlinear) +
           " has a force that depends on the sliding speed; use the collocation flow, or Coulomb's law";
  });
  if (asked != FlowMethod::kAutomatic) return asked;
  const bool forced = system.drive().force() != nullptr;
  const bool small = system.size() <= kClosedFormSize;
  return nonlinear == 0 && (elaborate > 0 || forced || small) ? FlowMethod::kClosedForm : FlowMethod::kCollocation;
}

FlowOptions with_method(const HybridSystem& system, FlowOptions asked) {
  asked.method = choose_method(system, asked.method);
  return asked;
}

namespace {

/// The fastest rate of the drive, of the slipping structure, or of a contact on its own spring or stop [1/s].
double fastest_rate(const HybridSystem& system, const ModalModel& m) {
  double fastest = std::max(system.drive().omega(), m.floats() ? 0.0 : m.fastest);
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    const double mobility = m.mobility(i, i);
    const auto look = [&](double stiffness, double damping) {
      fastest = std::max({fastest, std::sqrt(stiffness * mobility), damping * mobility});
    };
    const friction::Law& law = system.contacts()[c].law;
    if (friction::kind(law) == LawKind::kCompliant) look(friction::spring_stiffness(law), 0.0);
    if (const auto* clearance = friction::clearance(law))
      for (const friction::Stop& stop : clearance->stops()) look(stop.stiffness, stop.damping);
  }
  return fastest;
}

}  // namespace

Prepared prepare(const HybridSystem& system, const State& start, FlowOptions options, bool rows_suffice) {
  check_start(system, start);
  require_or_say(options.tolerance > 0 && std::isfinite(options.tolerance),
                 [&] { return std::string("flow tolerance must be positive"); });
  require_or_say(options.max_events_per_window > 0,
                 [&] { return std::string("max_events_per_window must be at least 1"); });
  const bool at_origin = start.q.isZero(0.0) && start.v.isZero(0.0);
  const ModelTables& tables = system.cache().tables(system, rows_suffice && at_origin);
  const ModalModel& m = tables.model;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * m.np);
  if (!at_origin) x = m.from_q * start.q + m.from_v * start.v;
  if (const double fastest = fastest_rate(system, m); options.zeno_window == 0.0 && fastest > 0.0)
    options.zeno_window = 0.01 * 2.0 * std::numbers::pi / fastest;
  const auto nc = static_cast<Eigen::Index>(system.contacts().size());
  std::vector<ContactMode> modes = start_modes(system, m, start, x, options);
  HybridPoint point{start.time,
                    std::move(x),
                    std::move(modes),
                    std::vector<int>(static_cast<std::size_t>(nc), 0),
                    Eigen::VectorXd::Zero(nc),
                    start_internal(system, start),
                    !start.modes.empty()};
  return {tables, std::move(point), options};
}

State physical(const ModalModel& m, const HybridPoint& point) {
  if (!m.has_shapes()) return {point.time, {}, {}, point.modes, point.internal};
  return {point.time, m.to_q * point.x, m.to_v * point.x, point.modes, point.internal};
}

State end_state(const HybridSystem& system, const ModalModel& m, const HybridPoint& point) {
  State end = physical(m, point);
  if (end.v.size() == 0) return end;
  constexpr double kLargestRepair = 1e-6;  // more is no error of a step: left for the next run to refuse
  const friction::Drive& drive = system.drive();
  const double belt = drive.velocity(end.time);
  // Under a shaker, whose speed rounds with the time, what slides has kept its own (EventResolver::keeps_speed).
  const double kept =
      drive.shaker() ? kOffGuard * drive.velocity_scale(end.time) + clock_rounding(drive, end.time) : 0.0;
  std::vector<Eigen::Index> held;
  for (std::size_t c = 0; c < end.modes.size(); ++c) {
    const friction::Contact& contact = system.contacts()[c];
    const double sliding = belt - contact.direction.dot(end.v), sign = sign_of(end.modes[c]);
    const double scale = std::abs(belt) + contact.direction.cwiseAbs().dot(end.v.cwiseAbs());
    const bool sticks = end.modes[c] == ContactMode::kStick, slips = std::abs(sign) == 1.0;
    const bool rigid = friction::kind(contact.law) != LawKind::kCompliant;
    const bool off_guard = rigid && (sticks || (slips && sliding * sign < -kept));
    if (off_guard && std::abs(sliding) <= kLargestRepair * (scale + speed_of_force(contact, c, m)))
      held.push_back(static_cast<Eigen::Index>(c));
  }
  if (held.empty()) return end;
  Eigen::MatrixXd W(system.size(), static_cast<Eigen::Index>(held.size()));
  for (std::size_t k = 0; k < held.size(); ++k)
    W.col(static_cast<Eigen::Index>(k)) = system.contacts()[static_cast<std::size_t>(held[k])].direction;
  const Eigen::VectorXd sliding = Eigen::VectorXd::Constant(W.cols(), belt) - W.transpose() * end.v;
  end.v += W * (W.transpose() * W).ldlt().solve(sliding);
  return end;
}

}  // namespace slipmode::dynamics
