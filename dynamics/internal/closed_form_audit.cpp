#include "dynamics/internal/closed_form_flow.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace slipmode::dynamics {
namespace {

/// Phase below which one short rule serves.
constexpr double kShortRest = 0.25;
/// Phase of the fastest harmonic that the rules of a window, made for the regime's own rate, take at least.
constexpr double kDriveRest = 1.0;

}  // namespace

void ClosedFormFlow::account(double tau, bool ends) {
  if (!regime_->forms && !regime_->belt) return integrate(tau);
  if (!ends) return;
  if (regime_->forms && !measured_) measure_amplitudes();
  const StayWork work =
      regime_->forms ? stay_.until({point_.time, x_, free_, point_.x}) : regime_->belt->until(point_.time, x_, inputs_);
  work_.add(work.contact, work.drive, work.viscous, work.force);
}

void ClosedFormFlow::integrate(double tau) {
  const RegimeTables& tables = *tables_;
  const Regime& r = tables.regime();
  const DriveOverlay* overlay = regime_->overlay;
  double contact = 0.0, driven = 0.0, viscous = 0.0, forced = 0.0;
  const auto add = [&](double weight, double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) {
    const DrivePhase phase = overlay ? phase_at(t) : DrivePhase{};
    const double V = drive_velocity(t, inputs);
    for (int c = 0; c < nc_; ++c) {
      double force = inputs(c), velocity = V;
      if (r.roles[static_cast<std::size_t>(c)] != ContactRole::kSliding)
        force = r.force_row.col(c).dot(x) + r.force_coefficient.col(c).dot(inputs);
      if (!r.held(c)) velocity = r.velocity_row.col(c).dot(x) + r.velocity_coefficient.col(c).dot(inputs);
      if (overlay) {
        force += overlay->force.at(c, phase);
        if (!r.held(c)) velocity += overlay->velocity.at(c, phase);
      }
      contact += weight * force * velocity;
      driven += weight * force * V;
    }
    if (const friction::Force* force = resolver_.drive().force())
      for (Eigen::Index k = 0; k < r.forces; ++k)
        forced += weight * force->value(static_cast<int>(k), t) *
                  (r.drive_row.col(k).dot(x) + r.drive_coefficient.col(k).dot(inputs) + overlay->driven.at(k, phase));
    if (overlay) {
      Eigen::VectorXd all = x;
      overlay->state.add(phase, 1.0, all);
      viscous += weight * r.viscous_power(all, V);
    } else {
      viscous += weight * r.viscous_power(x, V);
    }
  };
  const auto move_to = [&](const RegimeStep& s, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
                           Eigen::VectorXd& out_x, Eigen::VectorXd& out_inputs) {
    apply(s, x.data(), inputs, out_x.data());
    out_inputs = inputs;
    r.advance_inputs(out_inputs, s.h);
  };
  Eigen::VectorXd x = x_begin_, inputs = inputs_begin_, at_x(x.size()), at_inputs(inputs.size());
  double t = begin_;
  const double drive_rate = overlay ? static_cast<double>(overlay->orders()) * overlay->omega() : 0.0;
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
    tau -= h;
    t += h;
  }
  static const GaussRule rule = gauss_rule(5);
  if (tau > 0.0)
    for (Eigen::Index j = 0; j < rule.node.size(); ++j) {
      at_x = x;
      at_inputs = inputs;
      advance(tables, rule.node(j) * tau, at_x, at_inputs);
      add(rule.weight(j) * tau, t + rule.node(j) * tau, at_x, at_inputs);
    }
  work_.add(contact, driven, viscous, forced);
}

}  // namespace slipmode::dynamics
