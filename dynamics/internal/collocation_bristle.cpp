#include "dynamics/internal/collocation_flow.hpp"

#include <slipmode/dynamics/bristle.hpp>

#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
void CollocationFlow::start_bristles() {
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (!bristled(c)) continue;
    const double s = drive().velocity(begin_) - resolver_.contact_velocity(c, point_.x.data());
    if (point_.modes[i] != ContactMode::kSmooth && std::abs(s) <= kUnmoved * velocity_scale(c, point_.x)) continue;
    point_.modes[i] = s < 0.0 ? ContactMode::kSlipNegative : ContactMode::kSlipPositive;
  }
  // What they pull with, the resolver takes for given.
  forces_at(resolver_.instant(begin_, point_.x.data()), point_.modes, point_.internal, point_.force);
}

void CollocationFlow::refresh_bristles() {
  forces_at(resolver_.instant(point_.time, point_.x.data()), point_.modes, point_.internal, point_.force);
  for (int c = 0; c < nc_; ++c) {
    if (!bristled(c)) continue;
    const double s = drive().velocity(point_.time) - resolver_.contact_velocity(c, point_.x.data());
    if (std::abs(s) <= kUnmoved * velocity_scale(c, point_.x)) start_from_rest(c);
  }
}

void CollocationFlow::start_from_rest(int c) {
  // The way the acceleration leads: a step might see where the contact goes in the end, and not where it goes first.
  const auto i = static_cast<std::size_t>(c);
  const int order =
      start_multiplicity(resolver_.instant(point_.time, point_.x.data()), c, ContactMode::kSlipPositive, point_.force);
  point_.multiplicity[i] = order == 2 ? 2 : 1;
  if (order != 2) point_.modes[i] = order == 1 ? ContactMode::kSlipPositive : ContactMode::kSlipNegative;
}

Eigen::VectorXd CollocationFlow::internal_within(double tau, const double* x) const {
  Eigen::VectorXd internal = internal_begin_;
  const double share = tau / tables_.step(step_level_);
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws()[i].kind == LawKind::kCompliant) internal(own_at_[i]) = own_force(c, tau, x) / laws()[i].stiffness;
    if (!bristled(c)) continue;
    double& z = internal(own_at_[i]);
    z = share < 1.0 ? bristle_within(z, bristle_nodes_.segment<kNodes>(kNodes * c), share)
                    : bristle_nodes_(kNodes * c + kNodes - 1);
  }
  return internal;
}

void CollocationFlow::forces_at(const Instant& now, const std::vector<ContactMode>& modes,
                                const Eigen::VectorXd& internal, Eigen::VectorXd& out_force) const {
  std::vector<bool> stuck(modes.size());
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    stuck[i] = held(modes, c);
    const double s = now.belt_velocity - resolver_.contact_velocity(c, now.x);
    if (bristled(c))
      out_force(c) = laws()[i].bristle.force(sign_of(modes[i]), s, internal(own_at_[i]));
    else if (!stuck[i] && !elaborate(c))
      out_force(c) = laws()[i].continued(sign_of(modes[i]), s);
  }
  stick_forces(now, stuck, out_force);
}

void CollocationFlow::collocate_bristles(double h) {
  for (int c = 0; c < nc_; ++c) {
    if (!bristled(c)) continue;
    const auto i = static_cast<std::size_t>(c);
    bristle_nodes_.segment<kNodes>(kNodes * c) =
        solve_bristle(laws()[i].bristle, sign_of(point_.modes[i]), internal_begin_(own_at_[i]), h,
                      drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c))
            .z;
  }
}

bool CollocationFlow::turn_resting_bristles() {
  if (begin_ == turned_at_) return false;  // it would turn to and fro
  bool turned = false;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (!bristled(c) || point_.multiplicity[i] < 2) continue;
    const double rounding = kUnmoved * velocity_scale(c, x_begin_), sign = sign_of(point_.modes[i]);
    for (int j = 0; j < kNodes; ++j) {
      const double speed = sign * (drive_nodes_(kNodes * c + j) - velocity_(kNodes * c + j));
      if (std::abs(speed) <= rounding) continue;
      if (speed < 0.0) {
        point_.modes[i] = sign > 0.0 ? ContactMode::kSlipNegative : ContactMode::kSlipPositive;
        turned = true;
      }
      break;
    }
  }
  return turned;
}

void CollocationFlow::record_reversals(const std::vector<ContactMode>& before) {
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (bristled(c) && before[i] != ContactMode::kSmooth && point_.modes[i] != before[i])
      record_bristle(c, EventKind::kReversal, before[i]);
  }
}

void CollocationFlow::record_bristle(int c, EventKind kind, ContactMode before) {
  const double displacement = model_.displacement_row.col(c).dot(point_.x) + model_.contact_offset(c);
  events_.push_back({point_.time, c, kind, before, point_.modes[static_cast<std::size_t>(c)], displacement,
                     resolver_.contact_velocity(c, point_.x.data()), point_.force(c)});
}

void CollocationFlow::settle_bristle(int c, bool touching) {
  // The force is continuous at v_rel = 0: nothing to decide but the direction.
  const auto i = static_cast<std::size_t>(c);
  const ContactMode before = point_.modes[i];
  if (!touching) {
    std::vector<ContactMode> held = point_.modes;
    held[i] = ContactMode::kStick;
    resolver_.hold(point_.time, held, point_.x.data());
    const ContactMode after =
        before == ContactMode::kSlipPositive ? ContactMode::kSlipNegative : ContactMode::kSlipPositive;
    point_.modes[i] = after;
    start_from_rest(c);
    forces_at(resolver_.instant(point_.time, point_.x.data()), point_.modes, point_.internal, point_.force);
  } else {
    point_.multiplicity[i] = 2;
  }
  record_bristle(c, point_.modes[i] == before ? EventKind::kGrazing : EventKind::kReversal, before);
}

}  // namespace slipmode::dynamics
