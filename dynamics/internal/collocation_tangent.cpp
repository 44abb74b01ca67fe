#include "dynamics/internal/collocation_flow.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/dynamics/bristle.hpp>

#include <algorithm>
#include <cmath>

// Tangents of the state come first, those of the bristles after them: docs/theory/bristle-laws.md.

namespace slipmode::dynamics {

double CollocationFlow::force_slope(int c, ContactMode mode, double velocity, double drive_velocity) const {
  const auto i = static_cast<std::size_t>(c);
  const double s = drive_velocity - velocity;
  if (bristled(c)) return -laws()[i].bristle.slopes(sign_of(mode), s, point_.internal(own_at_[i])).by_speed;
  if (elaborate(c)) return 0.0;  // not of the speed alone: own_force_gradient
  return mode == ContactMode::kStick ? 0.0 : -laws()[i].slope(sign_of(mode), s);
}

void CollocationFlow::set_tangents(Eigen::MatrixXd tangents) {
  tangents_ = std::move(tangents);
  std::vector<Eigen::Index> stuck;
  if (any_elaborate_) slave_stretches();
  for (int c = 0; c < nc_; ++c)
    if (held(point_.modes, c)) stuck.push_back(c);
  if (stuck.empty()) return;
  const Eigen::MatrixXd rows = model_.velocity_row(Eigen::all, stuck).transpose();
  const Eigen::MatrixXd mobility = model_.mobility(stuck, stuck);
  auto states = tangents_.topRows(2 * model_.np);
  states -= Eigen::MatrixXd(model_.input(Eigen::all, stuck)) * mobility.ldlt().solve(rows * states);
}

Eigen::VectorXd CollocationFlow::point_rate() const {
  Eigen::VectorXd rate(point_.x.size() + point_.internal.size());
  rate.head(point_.x.size()) = model_.rate(point_.x, point_.force);
  if (given_ > 0) rate.head(point_.x.size()) += model_.force_input * resolver_.drive_force(point_.time);
  rate.tail(point_.internal.size()).setZero();
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const bool sprung = laws()[i].kind == LawKind::kCompliant && point_.modes[i] != ContactMode::kSeparated;
    if (!bristled(c) && !sprung) continue;
    const double s = drive().velocity(point_.time) - resolver_.contact_velocity(c, point_.x.data());
    double& own = rate(point_.x.size() + own_at_[i]);
    if (bristled(c))
      own = laws()[i].bristle.rate(sign_of(point_.modes[i]), s, point_.internal(own_at_[i]));
    else if (point_.modes[i] == ContactMode::kStick)
      own = s;
    else
      own = resolver_.slide_stretch_gradient(point_, c).head(point_.x.size()) * rate.head(point_.x.size());
  }
  return rate;
}

double CollocationFlow::tangent_rate() const {
  // With w̄ = wᵀM⁻¹w: δs′ = −w̄ (λ_s δs + λ_z δz), δz′ = (1 − κ′z) δs − κ δz at each node.
  double fastest = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    fastest = std::max({fastest, std::sqrt(std::abs(own_forces_[i].stiffness) * model_.mobility(c, c)),
                        std::abs(own_forces_[i].damping) * model_.mobility(c, c)});
    if (!bristled(c)) continue;
    const friction::BristleForces& law = laws()[i].bristle;
    const double sign = sign_of(point_.modes[i]), mobility = model_.mobility(c, c);
    for (Eigen::Index j = kNodes * c; j < kNodes * (c + 1); ++j) {
      const double s = drive_nodes_(j) - velocity_(j), z = bristle_nodes_(j);
      const friction::BristleForces::Decay decay = law.decay(sign, s);
      const friction::BristleForces::Slopes by = law.slopes(sign, s, z);
      const double sum = mobility * by.by_speed + decay.value,
                   product = mobility * (by.by_speed * decay.value + by.by_deflection * (1.0 - decay.slope * z));
      const double apart = 0.25 * sum * sum - product;
      fastest = std::max(fastest, apart < 0.0 ? std::sqrt(product) : std::abs(0.5 * sum) + std::sqrt(apart));
    }
  }
  return std::hypot(fastest, model_.fastest);
}

void CollocationFlow::push_tangents(int level, double tau) {
  // Linearised force equations of the step: δλ_i = slope_i δw_i in slip, δw_i = 0 in stick, a bristle's also by δz at
  // the start; δw = free δx + kernel δλ.
  const Collocation& table = tables_.collocation(level);
  const Eigen::MatrixXd& kernel = table.own_kernel;
  const Eigen::Index size = kNodes * nc_, np = model_.np;
  const double h = tables_.step(level);
  Eigen::MatrixXd jacobian(size, size), free(size, 2 * np), speeds(size, tangents_.cols());
  for (int c = 0; c < nc_; ++c) free.middleRows(kNodes * c, kNodes) = table.free.middleCols(2 * np * c, 2 * np);
  speeds.noalias() = free * tangents_.topRows(2 * np);
  Eigen::MatrixXd right = speeds;
  const AtNodes* displacements = any_elaborate_ ? &tables_.displacements(level) : nullptr;
  std::vector<Eigen::RowVectorXd> points(static_cast<std::size_t>(nc_));  // where springs' contact points are
  std::vector<BristleVariation> bristles(any_bristle_ ? static_cast<std::size_t>(nc_) : 0);
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (bristled(c)) {
      const Eigen::Index first = kNodes * c;
      bristles[i] = vary_bristle(laws()[i].bristle, sign_of(step_modes_[i]), h,
                                 drive_nodes_.segment<kNodes>(first) - velocity_.segment<kNodes>(first),
                                 bristle_nodes_.segment<kNodes>(first));
      const BristleVariation& by = bristles[i];
      jacobian.middleRows<kNodes>(first).noalias() = by.force_by_speed * kernel.middleRows<kNodes>(first);
      jacobian.block<kNodes, kNodes>(first, first) += RadauTables::Matrix8::Identity();
      right.middleRows<kNodes>(first) =
          by.force_by_start * tangents_.row(2 * np + own_at_[i]) - by.force_by_speed * speeds.middleRows<kNodes>(first);
      continue;
    }
    if (elaborate(c) && !held(step_modes_, c)) {
      const OwnForce& own = own_forces_[i];
      const Eigen::Index first = kNodes * c;
      jacobian.middleRows<kNodes>(first) =
          own.stiffness * displacements->kernel.middleRows<kNodes>(first).leftCols(size) +
          own.damping * kernel.middleRows<kNodes>(first);
      jacobian.block<kNodes, kNodes>(first, first) += RadauTables::Matrix8::Identity();
      right.middleRows<kNodes>(first) =
          -own.damping * speeds.middleRows<kNodes>(first) -
          own.stiffness * (displacements->free.middleCols(2 * np * c, 2 * np) * tangents_.topRows(2 * np));
      const Eigen::RowVectorXd place = model_.displacement_row.col(c).transpose() * tangents_.topRows(2 * np);
      if (own.follows) {
        points[i] = place + tangents_.row(2 * np + own_at_[i]);
        right.middleRows<kNodes>(first).rowwise() += own.stiffness * tangents_.row(2 * np + own_at_[i]);
      } else {
        right.middleRows<kNodes>(first).rowwise() -= own.stiffness * place;
      }
      continue;
    }
    for (int j = 0; j < kNodes; ++j) {
      const Eigen::Index row = kNodes * c + j;
      if (held(step_modes_, c)) {
        jacobian.row(row) = -kernel.row(row);
        continue;
      }
      const double slope = force_slope(c, step_modes_[i], velocity_(row), drive_nodes_(row));
      jacobian.row(row) = -slope * kernel.row(row);
      jacobian(row, row) += 1.0;
      right.row(row) *= slope;
    }
  }
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(forces_.size(), tangents_.cols());  // a drive's stay as they are
  forces.topRows(size) = jacobian.partialPivLu().solve(right);
  if (any_bristle_) push_bristle_tangents(bristles, speeds + kernel * forces.topRows(size), tau / h);
  WithinStep within(tables_, false, WithinStep::Load::kLeftOut);
  const kernels::StepArrays whole = tables_.propagator(level).arrays(false);
  Eigen::VectorXd to(2 * np);
  for (Eigen::Index k = 0; k < tangents_.cols(); ++k) {
    if (tau < h) {
      within.begin(tangents_.col(k).data(), forces.col(k).data(), level);
      within.state(tau, to.data());
    } else {
      kernels_.propagate(whole, tangents_.col(k).data(), forces.col(k).data(), to.data());
    }
    tangents_.col(k).head(2 * np) = to;
  }
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (own_forces_[i].follows)
      tangents_.row(2 * np + own_at_[i]) =
          points[i] - model_.displacement_row.col(c).transpose() * tangents_.topRows(2 * np);
  }
  if (any_elaborate_) slave_stretches();
}

void CollocationFlow::push_bristle_tangents(const std::vector<BristleVariation>& bristles,
                                            const Eigen::MatrixXd& speeds, double share) {
  for (int c = 0; c < nc_; ++c) {
    if (!bristled(c)) continue;
    const auto i = static_cast<std::size_t>(c);
    auto deflection = tangents_.row(2 * model_.np + own_at_[i]);
    const Eigen::Matrix<double, kNodes, Eigen::Dynamic> nodes =
        bristles[i].z_by_start * deflection - bristles[i].z_by_speed * speeds.middleRows<kNodes>(kNodes * c);
    for (Eigen::Index k = 0; k < deflection.size(); ++k)
      deflection(k) = share < 1.0 ? bristle_within(deflection(k), nodes.col(k), share) : nodes(kNodes - 1, k);
  }
}

Eigen::RowVectorXd CollocationFlow::held_force_gradient(int c) const {
  // λ of the held contacts from a = Gᵀrow x + mobility λ, the others following their own laws.
  std::vector<Eigen::Index> stuck;
  Eigen::Index position = 0;
  for (int d = 0; d < nc_; ++d)
    if (held(step_modes_, d)) {
      if (d == c) position = static_cast<Eigen::Index>(stuck.size());
      stuck.push_back(d);
    }
  const Eigen::Index size = 2 * model_.np;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(stuck.size()), size + point_.internal.size());
  rows.leftCols(size) = model_.acceleration_row(Eigen::all, stuck).transpose();
  for (int d = 0; d < nc_; ++d) {
    const auto i = static_cast<std::size_t>(d);
    const double V = drive().velocity(point_.time), v = model_.velocity_row.col(d).dot(point_.x),
                 slope = force_slope(d, step_modes_[i], v, V);
    const Eigen::VectorXd reach = model_.mobility(stuck, d);
    if (slope != 0.0) rows.leftCols(size) += reach * slope * model_.velocity_row.col(d).transpose();
    if (elaborate(d) && !held(step_modes_, d)) rows += reach * own_force_gradient(d);
    if (bristled(d))
      rows.col(size + own_at_[i]) +=
          reach * laws()[i].bristle.slopes(sign_of(step_modes_[i]), V - v, point_.internal(own_at_[i])).by_deflection;
  }
  const Eigen::MatrixXd mobility = model_.mobility(stuck, stuck);
  return -mobility.ldlt().solve(rows).row(position);
}

void CollocationFlow::salt_tangents(Eigen::VectorXd rate_before, const Guarded& guard) {
  // δ⁺ = R δ + (f⁺ − R f⁻) (∇g δ) / ġ⁻ for the guard g that was reached; R resets stretches that jump. Nothing jumps
  // where a bristle turns.
  const int contact = guard.contact;
  if (contact < 0 || bristled(contact)) return;
  const double tau = point_.time - begin_;
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(tangents_.rows());
  double rate = 0.0;
  if (guard.own) {
    gradient = this->gradient(*guard.own, contact);
    rate = evaluate(*guard.own, contact, tau, point_.x).rate;
  } else if (!held(step_modes_, contact)) {
    const RadauTables::Vector8 basis = nodes_.lagrange(tau / tables_.step(step_level_));
    gradient.head(2 * model_.np) = -model_.velocity_row.col(contact).transpose();
    rate = drive_acceleration(begin_, tau) - contact_acceleration(contact, point_.x, tau, basis);
  } else {
    gradient = -held_force_gradient(contact);
    const double h = tables_.step(step_level_);
    rate = -told_forces(contact).dot(nodes_.lagrange_slope(tau / h)) / h;
  }
  // Reached at rest: when is nobody's.
  const Eigen::RowVectorXd delay = gradient * tangents_ * (rate != 0.0 ? 1.0 / rate : 0.0);
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws()[i].kind != LawKind::kCompliant || !resolver_.has_event(c)) continue;
    const ContactMode before = step_modes_[i], after = point_.modes[i];
    const Eigen::Index row = 2 * model_.np + own_at_[i];
    const bool parted = before != after && (before == ContactMode::kSeparated || after == ContactMode::kSeparated);
    if (!parted && before != ContactMode::kStick) continue;  // ceases to slide: the stretch is kept
    const Eigen::RowVectorXd reset =
        parted ? Eigen::RowVectorXd::Zero(tangents_.rows()) : resolver_.slide_stretch_gradient(point_, c);
    const double moved = reset * rate_before;
    rate_before(row) = moved;
    const Eigen::RowVectorXd changed = reset * tangents_;
    tangents_.row(row) = changed;
  }
  tangents_ += (point_rate() - rate_before) * delay;
  if (any_elaborate_) slave_stretches();
}

}  // namespace slipmode::dynamics
