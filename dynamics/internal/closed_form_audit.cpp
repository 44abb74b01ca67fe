#include "dynamics/internal/closed_form_flow.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slipmode::dynamics {
namespace {

/// Phase below which one short rule serves.
constexpr double kShortRest = 0.25;
/// Phase of the fastest harmonic that the rules of a window, made for the regime's own rate, take at least.
constexpr double kDriveRest = 1.0;
/// Forms that round by more than this share of the energy exchanged are left for quadrature if that rounds by less.
constexpr double kLostInForms = 1e-12;
/// What a sum over nodes may be off by, of its terms' sizes.
constexpr double kRounding = std::numeric_limits<double>::epsilon();
/// What inputs hold is near if it, and the terms of a stick's force that it makes, are no more than this many times
/// what there is, and told alike if the structure's equations make the forces of it that springs' rows do to this many
/// roundings of theirs.
constexpr double kHeldNear = 8.0, kToldAlike = 32.0;

/// That a contact's force is the sum of.
double size_of_force(const Regime& r, Eigen::Index c, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) {
  return r.force_row.col(c).cwiseAbs().dot(x.cwiseAbs()) + r.force_coefficient.col(c).cwiseAbs().dot(inputs.cwiseAbs());
}

/// Of a mode that hardly resists, held far out, rows and equations differ by more than rounding, and forces by the one
/// are none beside motions by the other. Springs beside stiffer ones differ by what these round by.
bool told_alike(const Regime& r, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) {
  double differ = 0.0, size = 0.0;
  for (Eigen::Index c = 0; c < r.speed_input(); ++c) {
    if (!(r.spring(c) > 0.0)) continue;
    differ = std::max(differ, std::abs(r.beside_rows.col(c).dot(inputs)));
    size = std::max(size, size_of_force(r, c, x, inputs));
  }
  return differ <= kToldAlike * kRounding * size;
}

/// @param held  x_p
bool held_near(const Regime& r, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs, const Eigen::VectorXd& held) {
  if (!(squared_size(r, held) <= kHeldNear * kHeldNear * squared_size(r, x))) return false;
  const Eigen::VectorXd terms = r.particular.cwiseAbs() * inputs.cwiseAbs();
  for (Eigen::Index c = 0; c < r.speed_input(); ++c)
    if (r.sticks(static_cast<int>(c)) &&
        !(r.force_row.col(c).cwiseAbs().dot(terms) <= kHeldNear * size_of_force(r, c, x, inputs)))
      return false;
  return true;
}

}  // namespace

void ClosedFormFlow::account(double tau, bool ends) {
  const auto add = [this](const StayWork& work) { work_.add(work.contact, work.drive, work.viscous, work.force); };
  if (!has_forms()) return add(integrate(begin_, x_begin_, free_begin_, inputs_begin_, tau));
  if (!ends) return;
  if (!measured_) measure_amplitudes();
  const StayPlace now{point_.time, x_, free_, point_.x};
  StayWork work = regime_->forms ? stay_.until(now) : regime_->belt->until(now, inputs_);
  const bool little = little_left(accounted_, x_accounted_) || !told_alike(tables_->regime(), x_, inputs_);
  if (little ||
      work.rounding > kLostInForms * (work_.exchanged + std::abs(work.contact) + std::abs(work.force) + work.viscous)) {
    const StayWork summed =
        integrate(accounted_, x_accounted_, free_accounted_, inputs_accounted_, point_.time - accounted_);
    if (little || summed.rounding < work.rounding) work = summed;
  }
  add(work);
  mark_accounted();
}

bool ClosedFormFlow::little_left(double t, const Eigen::VectorXd& x) const {
  // A whole period later it is so again.
  if (regime_->overlay == nullptr || regime_->overlay->omega() * (point_.time - t) > 1.0) return false;
  return cancels(*regime_, t, x) && cancels(*regime_, point_.time, x_);
}

StayWork ClosedFormFlow::integrate(double t, Eigen::VectorXd x, const Eigen::VectorXd& x_free, Eigen::VectorXd inputs,
                                   double tau) const {
  const RegimeTables& tables = *tables_;
  const Regime& r = tables.regime();
  const DriveOverlay* const drive = regime_->overlay;
  const bool whole = little_left(t, x);
  // As rows of all of x, forces round by the springs' stiffness times all that the inputs move. Free motion is told
  // apart from it, where it moves once, to go on by itself: a spring's force and its end's velocity by the same motion,
  // so that what this is off by swings, or is constant, without work.
  bool apart = !whole && (r.spring.array() > 0.0).any() && told_alike(r, x, inputs);
  Eigen::VectorXd held, free, at_free, none;
  if (apart) {
    held = x - x_free;
    apart = held_near(r, x, inputs, held);
  }
  const bool moves = inputs(nc_) != 0.0 || inputs(nc_ + 1) != 0.0;
  if (apart) {
    free = x_free;
    none = Eigen::VectorXd::Zero(inputs.size());
  }
  const auto tell_free = [&](const Eigen::VectorXd& x_then, const auto& move) {
    if (!apart) return;
    if (moves) {
      at_free = free;
      move(at_free);
      // What merely integrates the inputs is none that these hold.
      const auto np = r.pairs.np;
      at_free.head(np) = (r.scale1.array() == 0.0).select(x_then.head(np), at_free.head(np)).eval();
      at_free.tail(np) = (r.scale2.array() == 0.0).select(x_then.tail(np), at_free.tail(np)).eval();
    } else {
      at_free = x_then - held;
    }
  };
  StayWork sum;
  Eigen::VectorXd x_whole, inputs_whole;
  const auto add = [&](double weight, double at, const Eigen::VectorXd& x_beside,
                       const Eigen::VectorXd& inputs_beside) {
    if (whole) anew(*regime_, at, x_whole, inputs_whole);
    const Eigen::VectorXd& x_then = whole ? x_whole : x_beside;
    const Eigen::VectorXd& inputs_then = whole ? inputs_whole : inputs_beside;
    const DriveOverlay* const overlay = whole ? nullptr : drive;
    const DrivePhase phase = overlay ? phase_at(at) : DrivePhase{};
    const double V = drive_velocity(at, inputs_then);
    for (int c = 0; c < nc_; ++c) {
      double force = inputs_then(c), velocity = V;
      if (apart && r.sticks(c))
        force = r.force_row.col(c).dot(at_free) + r.held_force(c, inputs_then);
      else if (r.roles[static_cast<std::size_t>(c)] != ContactRole::kSliding)
        force = r.force_row.col(c).dot(x_then) + r.force_coefficient.col(c).dot(inputs_then);
      if (apart && r.spring(c) > 0.0)
        // The counterpart's less the rate at which what the inputs hold stretches the spring.
        velocity = r.velocity_row.col(c).dot(at_free) + (1.0 - r.steady_together(c) / r.spring(c)) * inputs_then(nc_) -
                   r.steady_force(nc_, c) / r.spring(c) * inputs_then(nc_ + 1);
      else if (!r.held(c))
        velocity = r.velocity_row.col(c).dot(x_then) + r.velocity_coefficient.col(c).dot(inputs_then);
      if (overlay) {
        force += overlay->force.at(c, phase);
        if (!r.held(c)) velocity += overlay->velocity.at(c, phase);
      }
      sum.contact += weight * force * velocity;
      sum.drive += weight * force * V;
      sum.rounding += kRounding * weight * std::abs(force) * (std::abs(velocity) + std::abs(V));
    }
    if (const friction::Force* force = resolver_.drive().force())
      for (Eigen::Index k = 0; k < r.forces; ++k) {
        const double power = force->value(static_cast<int>(k), at) *
                             (r.drive_row.col(k).dot(x_then) + r.drive_coefficient.col(k).dot(inputs_then) +
                              (overlay ? overlay->driven.at(k, phase) : 0.0));
        sum.force += weight * power;
        sum.rounding += kRounding * weight * std::abs(power);
      }
    if (overlay) {
      Eigen::VectorXd all = x_then;
      overlay->state.add(phase, 1.0, all);
      sum.viscous += weight * r.viscous_power(all, V);
    } else {
      sum.viscous += weight * r.viscous_power(x_then, V);
    }
  };
  const auto swell = [&](double step, Eigen::VectorXd& out_x) {
    if (swells()) drive->move_resonances(r, step, phase_at(t), out_x);
  };
  const auto move_to = [&](const RegimeStep& s, const Eigen::VectorXd& from, const Eigen::VectorXd& from_inputs,
                           Eigen::VectorXd& out_x, Eigen::VectorXd& out_inputs) {
    apply(s, from.data(), from_inputs, out_x.data());
    swell(s.h, out_x);
    out_inputs = from_inputs;
    r.advance_inputs(out_inputs, s.h);
    tell_free(out_x, [&](Eigen::VectorXd& alone) {
      apply(s, alone.data(), none, alone.data());
      swell(s.h, alone);
    });
  };
  Eigen::VectorXd at_x(x.size()), at_inputs(inputs.size());
  const double drive_rate = drive ? static_cast<double>(drive->orders()) * drive->omega() : 0.0;
  const double fastest = std::max(r.rate, drive_rate);
  const int first = drive_rate * tables.length(RegimeTables::kAuditLevel) > kDriveRest
                        ? tables.level_covering(kDriveRest / drive_rate)
                        : RegimeTables::kAuditLevel;
  for (int level = std::max(first, RegimeTables::kAuditLevel);
       level < RegimeTables::kLevels && fastest * tau > kShortRest;) {
    const double h = tables.length(level);
    if (h > tau) {
      ++level;
      continue;
    }
    const RegimeAudit& audit = tables.audit(level);
    for (Eigen::Index j = 0; j < audit.rule.node.size(); ++j) {
      move_to(audit.point[static_cast<std::size_t>(j)], x, inputs, at_x, at_inputs);
      add(h * audit.rule.weight(j), t + h * audit.rule.node(j), at_x, at_inputs);
    }
    move_to(tables.step(level), x, inputs, at_x, at_inputs);
    x.swap(at_x);
    inputs.swap(at_inputs);
    free.swap(at_free);
    tau -= h;
    t += h;
  }
  static const GaussRule rule = gauss_rule(5);
  if (tau > 0.0)
    for (Eigen::Index j = 0; j < rule.node.size(); ++j) {
      at_x = x;
      at_inputs = inputs;
      advance(tables, rule.node(j) * tau, at_x, at_inputs);
      swell(rule.node(j) * tau, at_x);
      tell_free(at_x, [&](Eigen::VectorXd& alone) {
        advance(tables, rule.node(j) * tau, alone, none);
        swell(rule.node(j) * tau, alone);
      });
      add(rule.weight(j) * tau, t + rule.node(j) * tau, at_x, at_inputs);
    }
  return sum;
}

}  // namespace slipmode::dynamics
