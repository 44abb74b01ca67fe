#include "dynamics/internal/collocation_flow.hpp"

#include <slipmode/core/decompositions.hpp>

#include <cmath>

namespace slipmode::dynamics {

double CollocationFlow::force_slope(int c, ContactMode mode, double velocity, double drive_velocity) const {
  const ContactForces& law = laws()[static_cast<std::size_t>(c)];
  return mode == ContactMode::kStick ? 0.0 : -law.slope(sign_of(mode), drive_velocity - velocity);
}

void CollocationFlow::set_tangents(Eigen::MatrixXd tangents) {
  tangents_ = std::move(tangents);
  std::vector<Eigen::Index> stuck;
  for (int c = 0; c < nc_; ++c)
    if (point_.modes[static_cast<std::size_t>(c)] == ContactMode::kStick) stuck.push_back(c);
  if (stuck.empty()) return;
  const Eigen::MatrixXd rows = model_.velocity_row(Eigen::all, stuck).transpose();
  const Eigen::MatrixXd mobility = model_.mobility(stuck, stuck);
  tangents_ -= Eigen::MatrixXd(model_.input(Eigen::all, stuck)) * mobility.ldlt().solve(rows * tangents_);
}

void CollocationFlow::push_tangents(int level, double tau) {
  // Linearised force equations of the step: δλ_i = slope_i δw_i in slip, δw_i = 0 in stick, δw = free δx + kernel δλ.
  const Collocation& table = tables_.collocation(level);
  const Eigen::Index size = kNodes * nc_, np = model_.np;
  Eigen::MatrixXd jacobian(size, size), free(size, 2 * np), right(size, tangents_.cols());
  for (int c = 0; c < nc_; ++c) free.middleRows(kNodes * c, kNodes) = table.free.middleCols(2 * np * c, 2 * np);
  right.noalias() = free * tangents_;
  for (int c = 0; c < nc_; ++c)
    for (int j = 0; j < kNodes; ++j) {
      const Eigen::Index row = kNodes * c + j;
      if (step_modes_[static_cast<std::size_t>(c)] == ContactMode::kStick) {
        jacobian.row(row) = -table.kernel.row(row);
        continue;
      }
      const double slope = force_slope(c, step_modes_[static_cast<std::size_t>(c)], velocity_(row), drive_nodes_(row));
      jacobian.row(row) = -slope * table.kernel.row(row);
      jacobian(row, row) += 1.0;
      right.row(row) *= slope;
    }
  const Eigen::MatrixXd forces = jacobian.partialPivLu().solve(right);
  WithinStep within(tables_, false, WithinStep::Load::kLeftOut);
  const kernels::StepArrays whole = tables_.propagator(level).arrays(false);
  Eigen::VectorXd to(2 * np);
  for (Eigen::Index k = 0; k < tangents_.cols(); ++k) {
    if (tau < tables_.step(level)) {
      within.begin(tangents_.col(k).data(), forces.col(k).data(), level);
      within.state(tau, to.data());
    } else {
      kernels_.propagate(whole, tangents_.col(k).data(), forces.col(k).data(), to.data());
    }
    tangents_.col(k) = to;
  }
}

void CollocationFlow::salt_tangents(const Eigen::VectorXd& force_before, int contact) {
  // δx⁺ = δx + (f⁺ − f⁻) (∇g δx) / ġ⁻ for the guard g that was reached; f⁺ − f⁻ = Σ b_c Δλ_c.
  if (contact < 0) return;
  const Eigen::VectorXd jump = model_.input * (point_.force - force_before);
  const double a = drive_acceleration(begin_, point_.time - begin_), V = drive().velocity(point_.time);
  Eigen::RowVectorXd gradient;
  double rate;
  if (step_modes_[static_cast<std::size_t>(contact)] != ContactMode::kStick) {
    gradient = -model_.velocity_row.col(contact).transpose();
    rate = a - (model_.acceleration_row.col(contact).dot(point_.x) + model_.load_acceleration(contact) +
                model_.mobility.row(contact).dot(force_before));
  } else {
    // g = ±μ_s N − λ_stick(x): λ of the sticking contacts from a = Gᵀrow x + mobility λ, the sliding ones following
    // their own laws.
    std::vector<Eigen::Index> stuck;
    Eigen::Index position = 0;
    for (int c = 0; c < nc_; ++c)
      if (step_modes_[static_cast<std::size_t>(c)] == ContactMode::kStick) {
        if (c == contact) position = static_cast<Eigen::Index>(stuck.size());
        stuck.push_back(c);
      }
    Eigen::MatrixXd rows = model_.acceleration_row(Eigen::all, stuck).transpose();
    for (int d = 0; d < nc_; ++d) {
      const double slope =
          force_slope(d, step_modes_[static_cast<std::size_t>(d)], model_.velocity_row.col(d).dot(point_.x), V);
      if (slope != 0.0)
        rows += Eigen::VectorXd(model_.mobility(stuck, d)) * slope * model_.velocity_row.col(d).transpose();
    }
    const Eigen::MatrixXd mobility = model_.mobility(stuck, stuck);
    gradient = mobility.ldlt().solve(rows).row(position);  // −dλ/dx
    const double h = tables_.step(step_level_);
    rate = -forces_.segment<kNodes>(kNodes * contact).dot(nodes_.lagrange_slope((point_.time - begin_) / h)) / h;
  }
  tangents_ += jump * (gradient * tangents_) / rate;
}

}  // namespace slipmode::dynamics
