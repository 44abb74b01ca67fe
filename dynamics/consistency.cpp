#include <slipmode/dynamics/consistency.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// Forces are compared with their limits, and accelerations with zero, to this relative accuracy.
constexpr double kForceTolerance = 1e-10;
constexpr double kReleaseTolerance = 1e-6;
/// A stick force further from its limit than this share is none that let go; accelerations are trusted to this many
/// times what it is off by.
constexpr double kLargestRelease = 1e-3, kReleasesRoundBy = 2.0;
/// Below this share of the largest friction acceleration, sliding is taken to start with zero acceleration.
constexpr double kSimpleTouch = 1e-7;
/// Up to this many undecided contacts every combination can be tried.
constexpr int kMaxEnumerated = 6;

ContactMode slip_mode(double sign) { return sign > 0 ? ContactMode::kSlipPositive : ContactMode::kSlipNegative; }

/// wᵀq̈ of every contact with all forces zero.
Eigen::VectorXd free_acceleration(const Instant& now) {
  const Eigen::Map<const Eigen::VectorXd> x(now.x, 2 * now.model.np);
  Eigen::VectorXd free = now.model.acceleration_row.transpose() * x + now.model.load_acceleration;
  if (now.force.size() > 0) free += now.model.force_acceleration * now.force;
  return free;
}

/// What wᵀq̈ may be off by: states and loads round by all of the motion, not by what is left at a contact, and limits by
/// what loads are sums of.
Eigen::VectorXd acceleration_rounding(const Instant& now, const Eigen::VectorXd& force) {
  constexpr double kRoundsBy = 64.0 * std::numeric_limits<double>::epsilon();
  const Eigen::Map<const Eigen::VectorXd> x(now.x, 2 * now.model.np);
  const double motion = (now.model.acceleration_row.cwiseAbs().transpose() * x.cwiseAbs()).maxCoeff();
  Eigen::VectorXd size = Eigen::VectorXd::Constant(force.size(), force.lpNorm<Eigen::Infinity>());
  if (now.limit_size.size() > 0) size += now.limit_size;
  return kRoundsBy * (motion + now.model.mobility.diagonal().cwiseProduct(size).array());
}

/// What wᵀq̈ of contacts that let go may be off by: their stick forces have reached their limits in the regime that
/// ends, whose stiffest modes can be 1e8 times as large as what is left here. Where another contact comes to rest at
/// the same instant, forces are others, and nothing is known.
/// @param force  of the contacts that are not at rest; the others' entries are not read
Eigen::VectorXd release_rounding(const Instant& now, const std::vector<ContactMode>& modes,
                                 const std::vector<bool>& at_rest, const std::vector<bool>& released,
                                 const Eigen::VectorXd& force) {
  Eigen::VectorXd rounding = Eigen::VectorXd::Zero(force.size()), stick = force;
  for (std::size_t c = 0; c < modes.size(); ++c)
    if (at_rest[c] && modes[c] != ContactMode::kStick) return rounding;
  stick_forces(now, at_rest, stick);
  for (std::size_t c = 0; c < modes.size(); ++c) {
    if (!released[c]) continue;
    const auto i = static_cast<Eigen::Index>(c);
    const double limit = now.laws[c].limit(stick(i)), off = std::abs(std::abs(stick(i)) - limit);
    if (off <= kLargestRelease * limit) rounding(i) = kReleasesRoundBy * now.model.mobility(i, i) * off;
  }
  return rounding;
}

struct Trial {
  std::vector<ContactMode> modes;
  Eigen::VectorXd force;
  Eigen::VectorXd rounding;  ///< of accelerations, where limits are as small: of a load that vanishes
};

/// Forces for given modes of the undecided contacts; true when every one of them obeys its law.
bool evaluate(const Instant& now, const std::vector<bool>& at_rest, const std::vector<bool>& released, Trial& trial) {
  const auto nc = trial.modes.size();
  std::vector<bool> stuck(nc);
  for (std::size_t c = 0; c < nc; ++c) {
    stuck[c] = at_rest[c] && trial.modes[c] == ContactMode::kStick;
    if (at_rest[c] && !stuck[c])
      trial.force(static_cast<Eigen::Index>(c)) = sign_of(trial.modes[c]) * now.laws[c].onset(sign_of(trial.modes[c]));
  }
  stick_forces(now, stuck, trial.force);
  const Eigen::VectorXd acceleration = free_acceleration(now) + now.model.mobility * trial.force;
  for (std::size_t c = 0; c < nc; ++c) {
    if (!at_rest[c]) continue;
    const auto i = static_cast<Eigen::Index>(c);
    const double limit = now.laws[c].most();
    if (stuck[c]) {
      const double slack = trial.rounding(i) / now.model.mobility(i, i);
      if (std::abs(trial.force(i)) > now.laws[c].limit(trial.force(i)) * (1 + kForceTolerance) + slack) return false;
    } else {
      const double scale = std::max(now.model.mobility(i, i) * limit, std::abs(now.belt_acceleration));
      // A release is located to the accuracy of the stick force; a continuous law then starts with zero acceleration.
      const double tolerance = released[c] ? kReleaseTolerance : kForceTolerance;
      if (sign_of(trial.modes[c]) * (now.belt_acceleration - acceleration(i)) < -tolerance * scale - trial.rounding(i))
        return false;
    }
  }
  return true;
}

/// All combinations of the undecided contacts of which less than `below` slide, most sticking first; the first
/// consistent one.
bool enumerate(const Instant& now, const std::vector<bool>& at_rest, const std::vector<bool>& released,
               std::size_t below, Trial& trial) {
  std::vector<std::size_t> open;
  for (std::size_t c = 0; c < at_rest.size(); ++c)
    if (at_rest[c]) open.push_back(c);
  if (static_cast<int>(open.size()) > kMaxEnumerated) return false;
  int combinations = 1;
  for (std::size_t k = 0; k < open.size(); ++k) combinations *= 3;
  for (std::size_t sliding = 0; sliding < std::min(below, open.size() + 1); ++sliding)
    for (int code = 0; code < combinations; ++code) {
      std::size_t slips = 0;
      int rest = code;
      bool allowed = true;
      for (const std::size_t c : open) {
        const int digit = rest % 3;
        rest /= 3;
        trial.modes[c] = digit == 0   ? ContactMode::kStick
                         : digit == 1 ? ContactMode::kSlipPositive
                                      : ContactMode::kSlipNegative;
        slips += digit != 0;
        allowed = allowed && !(digit == 0 && released[c]);
      }
      if (allowed && slips == sliding && evaluate(now, at_rest, released, trial)) return true;
    }
  return false;
}

}  // namespace

SingleResolution resolve_single(const Instant& now, bool released, double release_sign) {
  const ModalModel& m = now.model;
  const ContactForces& law = now.laws[0];
  double free = m.load_acceleration(0);
  if (now.force.size() > 0) free += m.force_acceleration.row(0).dot(now.force);
  const double* row = m.acceleration_row.data();
  for (Eigen::Index i = 0; i < 2 * m.np; ++i) free += row[i] * now.x[i];
  const double stick = (now.belt_acceleration - free) / m.mobility(0, 0);
  if (!released && std::abs(stick) <= law.static_limit * (1 + kForceTolerance)) return {ContactMode::kStick, stick, 0};
  const double sign = released ? release_sign : (stick > 0 ? 1.0 : -1.0);
  const double excess = sign * stick - law.onset(sign);  // sliding starts with this, times the mobility
  return {slip_mode(sign), sign * law.onset(sign), excess > kSimpleTouch * law.most() ? 1 : 2};
}

void stick_forces(const Instant& now, const std::vector<bool>& stuck, Eigen::VectorXd& force) {
  std::vector<Eigen::Index> open;
  for (std::size_t c = 0; c < stuck.size(); ++c)
    if (stuck[c]) {
      open.push_back(static_cast<Eigen::Index>(c));
      force(static_cast<Eigen::Index>(c)) = 0.0;
    }
  if (open.empty()) return;
  const Eigen::VectorXd missing = Eigen::VectorXd::Constant(force.size(), now.belt_acceleration) -
                                  free_acceleration(now) - now.model.mobility * force;
  const Eigen::VectorXd solved =
      Eigen::MatrixXd(now.model.mobility(open, open)).ldlt().solve(Eigen::VectorXd(missing(open)));
  for (std::size_t k = 0; k < open.size(); ++k) force(open[k]) = solved(static_cast<Eigen::Index>(k));
}

Resolution resolve(const Instant& now, const std::vector<ContactMode>& modes, const std::vector<bool>& at_rest,
                   const std::vector<bool>& released) {
  const auto nc = modes.size();
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nc));
  Trial trial{modes, none, none};
  const Eigen::Map<const Eigen::VectorXd> x(now.x, 2 * now.model.np);
  for (std::size_t c = 0; c < nc; ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    const ContactForces& law = now.laws[c];
    if (now.applied && !at_rest[c])
      trial.force(i) = (*now.applied)(i);
    else if (!law.sticks() || !at_rest[c])
      trial.force(i) = law.sliding(sign_of(modes[c]), now.belt_velocity - now.model.velocity_row.col(i).dot(x));
    else
      trial.modes[c] = ContactMode::kStick;
  }

  if (now.limit_size.size() > 0) {
    // A limit that cannot be told from zero, as where a load is regained, decides nothing before it has grown.
    const Eigen::VectorXd rounding = acceleration_rounding(now, trial.force);
    for (std::size_t c = 0; c < nc; ++c) {
      const auto i = static_cast<Eigen::Index>(c);
      if (at_rest[c] && now.model.mobility(i, i) * now.laws[c].most() <= rounding(i)) trial.rounding(i) = rounding(i);
    }
  }

  std::vector<bool> stuck(nc);
  const auto refresh = [&] {
    for (std::size_t c = 0; c < nc; ++c) stuck[c] = at_rest[c] && trial.modes[c] == ContactMode::kStick;
    stick_forces(now, stuck, trial.force);
  };
  const auto slide = [&](std::size_t c) {
    const auto i = static_cast<Eigen::Index>(c);
    trial.modes[c] = slip_mode(trial.force(i));
    trial.force(i) = sign_of(trial.modes[c]) * now.laws[c].onset(sign_of(trial.modes[c]));
  };
  refresh();
  std::size_t sliding = 0;
  for (std::size_t c = 0; c < nc; ++c)
    if (released[c]) {
      slide(c);
      ++sliding;
    }
  if (sliding > 0) refresh();
  std::size_t let_go = 0;
  for (; let_go < nc; ++let_go) {
    std::size_t worst = nc;
    double excess = 0.0;
    for (std::size_t c = 0; c < nc; ++c) {
      if (!stuck[c]) continue;
      const auto i = static_cast<Eigen::Index>(c);
      const double force = trial.force(i), slack = trial.rounding(i) / now.model.mobility(i, i),
                   over = std::abs(force) - now.laws[c].limit(force) * (1 + kForceTolerance) - slack;
      if (over > excess) {
        excess = over;
        worst = c;
      }
    }
    if (worst == nc) break;
    slide(worst);
    refresh();
  }
  sliding += let_go;
  Trial checked = trial;
  const auto find = [&] {
    if (let_go > 1) {  // the first may be held once others slide
      Trial fewer = checked;
      if (enumerate(now, at_rest, released, sliding, fewer)) {
        checked = fewer;
        return true;
      }
    }
    return evaluate(now, at_rest, released, checked) || enumerate(now, at_rest, released, nc + 1, checked);
  };
  bool consistent = find();
  if (!consistent) {  // forces at a limit that vanishes are told to their rounding, as are those of fast modes
    checked = trial;
    checked.rounding =
        acceleration_rounding(now, trial.force) + release_rounding(now, modes, at_rest, released, trial.force);
    consistent = find();
  }
  if (!consistent)
    throw NumericalFailure(
        "no combination of stick and slip satisfies the friction laws at t = " + std::to_string(now.time), now.time, x,
        std::numeric_limits<double>::quiet_NaN());
  trial = checked;

  Resolution out{trial.modes, trial.force, std::vector<int>(nc, 0)};
  for (std::size_t c = 0; c < nc; ++c)
    if (at_rest[c] && out.modes[c] != ContactMode::kStick)
      out.multiplicity[c] = start_multiplicity(now, static_cast<int>(c), out.modes[c], out.force) == 1 ? 1 : 2;
  return out;
}

double contact_acceleration(const Instant& now, int c, const Eigen::VectorXd& force) {
  const ModalModel& m = now.model;
  return m.acceleration_row.col(c).dot(Eigen::Map<const Eigen::VectorXd>(now.x, 2 * m.np)) + m.load_acceleration(c) +
         m.mobility.row(c).dot(force) + (now.force.size() > 0 ? m.force_acceleration.row(c).dot(now.force) : 0.0);
}

int start_multiplicity(const Instant& now, int c, ContactMode mode, const Eigen::VectorXd& force) {
  const double start = sign_of(mode) * (now.belt_acceleration - contact_acceleration(now, c, force));
  const double threshold = kSimpleTouch * now.model.mobility(c, c) * now.laws[static_cast<std::size_t>(c)].most();
  return start > threshold ? 1 : start >= -threshold ? 2 : -1;
}

Eigen::VectorXd stick_force_rates(const Instant& now, const std::vector<ContactMode>& modes,
                                  const Eigen::VectorXd& force, const Eigen::VectorXd& deflection) {
  const ModalModel& m = now.model;
  const auto np = m.np;
  const Eigen::Map<const Eigen::VectorXd> x(now.x, 2 * np);
  Eigen::VectorXd rate = m.rate(x, force);
  if (now.force.size() > 0) rate += m.force_input * now.force;
  Eigen::VectorXd force_rate = Eigen::VectorXd::Zero(m.contacts);
  std::vector<Eigen::Index> stuck;
  for (int c = 0; c < m.contacts; ++c) {
    const ContactForces& law = now.laws[static_cast<std::size_t>(c)];
    if (law.kind == LawKind::kClearance) {
      force_rate(c) = law.clearance.force_rate(stop_side(modes[static_cast<std::size_t>(c)]),
                                               m.velocity_row.col(c).dot(x), m.velocity_row.col(c).dot(rate));
      continue;
    }
    const bool sticks = modes[static_cast<std::size_t>(c)] == ContactMode::kStick;
    if (sticks && law.kind != LawKind::kCompliant) {
      stuck.push_back(c);
      continue;
    }
    const double v_rel = now.belt_velocity - m.velocity_row.col(c).dot(x);
    if (sticks) {
      force_rate(c) = law.stiffness * v_rel;
      continue;
    }
    const double v_rel_rate = now.belt_acceleration - m.velocity_row.col(c).dot(rate);
    if (law.kind == LawKind::kBristle) {
      force_rate(c) =
          law.bristle.force_rate(sign_of(modes[static_cast<std::size_t>(c)]), v_rel, deflection(c), v_rel_rate);
      continue;
    }
    force_rate(c) = law.slope(std::copysign(1.0, v_rel), v_rel) * v_rel_rate;
  }
  Eigen::VectorXd missing = Eigen::VectorXd::Constant(m.contacts, now.belt_jerk) -
                            m.acceleration_row.transpose() * rate - m.mobility * force_rate;
  if (now.force_rate.size() > 0) missing -= m.force_acceleration * now.force_rate;
  const Eigen::VectorXd solved =
      Eigen::MatrixXd(m.mobility(stuck, stuck)).ldlt().solve(Eigen::VectorXd(missing(stuck)));
  for (std::size_t k = 0; k < stuck.size(); ++k) force_rate(stuck[k]) = solved(static_cast<Eigen::Index>(k));
  return force_rate;
}

}  // namespace slipmode::dynamics
