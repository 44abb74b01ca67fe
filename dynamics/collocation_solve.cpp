#include "core/decompositions.hpp"
#include "dynamics/collocation_flow.hpp"
#include "dynamics/pair_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

constexpr int kNewtonLimit = 12;

}  // namespace

void CollocationFlow::free_velocities(const Collocation& table) {
  for (int c = 0; c < nc_; ++c) {
    const double* free = table.free.data() + kNodes * 2 * model_.np * c;
    V8 sum = load8(table.load.data() + kNodes * c);
    sum += node_sums(free, x_begin_.data(), model_.n);
    sum += node_sums(free + kNodes * model_.np, x_begin_.data() + model_.np, model_.n);
    store8(free_.data() + kNodes * c, sum);
  }
}

void CollocationFlow::guess_forces(int level, bool retry) {
  // A rejected step's own solution; the last solution continued; the way the last slip began; or the force at the
  // start.
  const RadauTables& t = nodes_;
  const int finer = level - step_level_;
  for (int c = 0; c < nc_; ++c) {
    double* forces = forces_.data() + kNodes * c;
    if (solved_ && retry) {
      for (int halving = 0; halving < finer; ++halving) store8(forces, matrix8_times(t.left_half.data(), forces));
    } else if (solved_ && finer >= -1 && finer + 1 < static_cast<int>(t.following.size())) {
      const double* ahead = t.following[static_cast<std::size_t>(finer + 1)].data();
      const auto i = static_cast<std::size_t>(c);
      if (laws()[i].kind == ContactForces::Kind::kStribeck && point_.modes[i] != ContactMode::kStick) {
        // Sliding speed is smoother than the force, and continues better.
        const double sign = sign_of(point_.modes[i]);
        const double* velocity = velocity_.data() + kNodes * c;
        const V8 speed = sign * (load8(drive_nodes_.data() + kNodes * c) - matrix8_times(ahead, velocity));
        store8(forces,
               sign * (laws()[i].kinetic + laws()[i].drop * exp8(-laws()[i].alpha * (speed > 0.0 ? speed : V8{}))));
      } else {
        store8(forces, matrix8_times(ahead, forces));
      }
    } else if (fresh_ && !retry && nc_ == 1) {
      store8(forces, point_.force(0) * load8(first_shape_.data()));
      for (int halving = first_level_; halving < level; ++halving)
        store8(forces, matrix8_times(t.left_half.data(), forces));
    } else {
      store8(forces, broadcast8(point_.force(c)));
    }
  }
}

int CollocationFlow::foreseen_level(int level) const {
  // Sliding slows down ever faster where the law rises steeply: look ahead by a parabola through the last step's
  // velocities and keep α (μ_s − μ_k) N e^{−αv} × mobility × step within what eight nodes resolve. Solved for v once,
  // so that no exponential is needed here.
  if (!solved_) return level;
  const auto& node = nodes_.node;
  const double last_step = tables_.step(step_level_);
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = laws()[i];
    if (law.kind != ContactForces::Kind::kStribeck || point_.modes[i] == ContactMode::kStick) continue;
    const double sign = sign_of(point_.modes[i]);
    const auto speed = [&](int j) { return sign * (drive_nodes_(kNodes * c + j) - velocity_(kNodes * c + j)); };
    const double s1 = speed(2), s2 = speed(5), s3 = speed(7);
    const double d12 = (s2 - s1) / (node(5) - node(2)), d23 = (s3 - s2) / (node(7) - node(5));
    const double bend = (d23 - d12) / (node(7) - node(2)), slope = d23 + bend * (node(7) - node(5));
    for (; level + 1 < StepTables::kLevels; ++level) {
      const double ahead = tables_.step(level) / last_step;
      const double foreseen = std::max(0.0, s3 + ahead * (slope + bend * ahead));
      if (foreseen >= steep_speed_[i] - level * (std::numbers::ln2 / law.alpha)) break;
    }
  }
  return level;
}

bool CollocationFlow::solve_forces(const Collocation& table, double h) {
  const RadauTables::Vector8 drive_speed = drive_velocities(begin_, h);
  for (int c = 0; c < nc_; ++c) drive_nodes_.segment<kNodes>(kNodes * c) = drive_speed;
  if (nc_ != 1 || any_bristle_) return solve_coupled(table, h);

  double* forces = forces_.data();
  if (point_.modes[0] == ContactMode::kStick) {
    const V8 held = load8(drive_speed.data());
    store8(free_.data(), held - load8(free_.data()));
    store8(forces, matrix8_times(table.kernel_inverse.data(), free_.data()));
    store8(velocity_.data(), held);
    return true;
  }
  if (laws()[0].is_constant()) {
    store8(forces, broadcast8(sign_of(point_.modes[0]) * laws()[0].kinetic));
    store8(velocity_.data(), load8(free_.data()) + matrix8_times(table.kernel.data(), forces));
    return true;
  }
  return solve_single_slip(table);
}

bool CollocationFlow::solve_single_slip(const Collocation& table) {
  const ContactForces& law = laws()[0];
  const V8 free = load8(free_.data()), drive_speed = load8(drive_nodes_.data());
  const bool smooth = !law.sticks();
  const double sign = smooth ? 1.0 : sign_of(point_.modes[0]);
  const double velocity_scale = smooth ? law.epsilon : 1.0 / law.alpha;
  const V8 clip = broadcast8(-kLargestOvershoot * 2);

  alignas(64) double force[kNodes];
  V8 v = free + matrix8_times(table.kernel.data(), forces_.data());
  for (int iteration = 0; iteration < kNewtonLimit; ++iteration) {
    V8 lambda, slope;
    if (smooth) {
      alignas(64) double l[kNodes], d[kNodes], s[kNodes];
      store8(s, drive_speed - v);
      for (int j = 0; j < kNodes; ++j) {
        l[j] = law.smooth(s[j], d[j]);
        d[j] = -d[j];
      }
      lambda = load8(l);
      slope = load8(d);
    } else {
      V8 scaled = law.alpha * sign * (drive_speed - v);  // α times sliding speed
      const auto inside = scaled > clip;
      scaled = inside ? scaled : clip;
      const V8 e = law.drop * exp8(-scaled);
      lambda = sign * (law.kinetic + e);
      slope = inside ? law.alpha * e : V8{};
    }
    store8(force, lambda);
    const V8 residual = free + matrix8_times(table.kernel.data(), force) - v;
    V8 delta;
    if (!solve_newton(table.kernel.data(), table.kernel_norm, newton_change_, slope, residual, delta)) return false;
    v += delta;
    const double change = max8(abs8(delta));
    if (!(change < 1e12)) return false;
    if (change < newton_change_ * velocity_scale || change < 1e-14) {
      store8(forces_.data(), lambda + slope * delta);
      store8(velocity_.data(), v);
      return true;
    }
  }
  return false;
}

bool CollocationFlow::solve_coupled(const Collocation& table, double h) {
  const Eigen::Index size = kNodes * nc_;
  const auto block = [](auto& vector, int c) { return vector.template segment<kNodes>(kNodes * c); };
  std::vector<bool> stuck(static_cast<std::size_t>(nc_));
  bool any_stuck = false, all_stuck = true, any_nonlinear = false;
  for (std::size_t c = 0; c < stuck.size(); ++c) {
    stuck[c] = point_.modes[c] == ContactMode::kStick;
    any_stuck |= stuck[c];
    all_stuck &= stuck[c];
    any_nonlinear |= !stuck[c] && !laws()[c].is_constant();
  }
  if (all_stuck) {
    forces_.noalias() = table.kernel_inverse * (drive_nodes_ - free_);
    velocity_ = drive_nodes_;
    return true;
  }
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (bristled(c)) continue;
    block(forces_, c)
        .setConstant(laws()[i].is_constant() && !stuck[i] ? sign_of(point_.modes[i]) * laws()[i].kinetic
                                                          : point_.force(c));
  }
  if (!any_stuck && !any_nonlinear) {
    velocity_.noalias() = free_ + table.kernel * forces_;
    return true;
  }

  Eigen::MatrixXd jacobian(size, size);
  Eigen::VectorXd residual(size);
  for (int iteration = 0; iteration < kNewtonLimit; ++iteration) {
    // Sliding contacts: λ − law(v) = 0. Sticking ones: v − v_drive = 0.
    velocity_.noalias() = free_ + table.kernel * forces_;
    double curvature = 0.0;
    for (int c = 0; c < nc_; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const ContactForces& law = laws()[i];
      if (bristled(c)) {
        const BristleStep step = solve_bristle(law.bristle, sign_of(point_.modes[i]), internal_begin_(bristle_at_[i]),
                                               h, block(drive_nodes_, c) - block(velocity_, c));
        block(residual, c) = step.force - block(forces_, c);
        jacobian.middleRows<kNodes>(kNodes * c).noalias() = step.slope * table.kernel.middleRows<kNodes>(kNodes * c);
        jacobian.block<kNodes, kNodes>(kNodes * c, kNodes * c) += RadauTables::Matrix8::Identity();
        block(bristle_nodes_, c) = step.z;
        continue;
      }
      for (int j = 0; j < kNodes; ++j) {
        const Eigen::Index row = kNodes * c + j;
        if (stuck[i]) {
          residual(row) = drive_nodes_(row) - velocity_(row);
          jacobian.row(row) = table.kernel.row(row);
          continue;
        }
        double lambda, slope;  // dλ/dv
        const double s = drive_nodes_(row) - velocity_(row);
        if (!law.sticks()) {
          lambda = law.smooth(s, slope);
          slope = -slope;
        } else {
          const double sign = sign_of(point_.modes[i]), scaled = law.alpha * sign * s;
          const bool inside = scaled > -2 * kLargestOvershoot;
          const double e = law.drop * std::exp(inside ? -scaled : 2 * kLargestOvershoot);
          lambda = sign * (law.kinetic + e);
          slope = inside ? law.alpha * e : 0.0;
        }
        residual(row) = lambda - forces_(row);
        jacobian.row(row) = -slope * table.kernel.row(row);
        jacobian(row, row) += 1.0;
      }
    }
    const Eigen::VectorXd delta = jacobian.partialPivLu().solve(residual);
    if (!delta.allFinite()) return false;
    forces_ += delta;
    const Eigen::VectorXd dv = table.kernel * delta;
    velocity_ += dv;
    for (int c = 0; c < nc_; ++c) {
      const ContactForces& law = laws()[static_cast<std::size_t>(c)];
      if (law.kind == ContactForces::Kind::kStribeck || law.kind == ContactForces::Kind::kSmooth) {
        const double rate = law.kind == ContactForces::Kind::kSmooth ? 1.0 / law.epsilon : law.alpha;
        if (!stuck[static_cast<std::size_t>(c)])
          curvature = std::max(curvature, rate * block(dv, c).cwiseAbs().maxCoeff());
      } else if (law.kind == ContactForces::Kind::kBristle) {
        if (law.bristle.drop > 0.0)
          curvature = std::max(curvature, block(dv, c).cwiseAbs().maxCoeff() / law.bristle.stribeck_speed);
        curvature = std::max(curvature, block(delta, c).cwiseAbs().maxCoeff() / law.static_limit);
      }
    }
    if (!any_nonlinear || curvature < newton_change_) {
      collocate_bristles(h);
      return true;
    }
  }
  return false;
}

double CollocationFlow::force_error() const {
  double worst = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws()[i].kind == ContactForces::Kind::kFree) continue;
    const V8 forces = load8(forces_.data() + kNodes * c);
    const double sixth = std::abs(sum8(forces * load8(nodes_.legendre6.data())));
    const double seventh = std::abs(sum8(forces * load8(nodes_.legendre7.data())));
    // The first coefficient left out, if the sequence keeps falling as it does.
    const double next = seventh * std::min(1.0, seventh / std::max(sixth, 1e-300));
    worst = std::max(worst, next / laws()[i].static_limit);
    if (bristled(c)) worst = std::max(worst, bristle_error(c) * tables_.step(0) / tables_.step(step_level_));
  }
  return worst;
}

}  // namespace slipmode::dynamics
