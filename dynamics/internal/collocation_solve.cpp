#include <slipmode/core/decompositions.hpp>
#include "dynamics/internal/collocation_flow.hpp"

#include <slipmode/dynamics/bristle.hpp>
#include <slipmode/friction/characteristic.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

constexpr int kNewtonLimit = 12;
/// Of a single contact's forces Newton may leave this share of the tolerance wrong, and no more than the other of the
/// static limit: errors of all steps add up, and where a law's steepness limits the steps they would be all there is.
constexpr double kForceShare = 5e-3, kLargestForceError = 1e-8;

}  // namespace

void CollocationFlow::guess_forces(int level, bool retry) {
  // A rejected step's own solution; the last solution continued; the way the last slip began; or the force at the
  // start.
  const RadauTables& t = nodes_;
  const int finer = level - step_level_;
  ahead_ = nullptr;
  for (int c = 0; c < nc_; ++c) {
    double* forces = forces_.data() + kNodes * c;
    const auto halve = [&](int times) {
      for (int halving = 0; halving < times; ++halving) kernels_.matrix8(t.left_half.data(), forces, forces);
    };
    if (solved_ && retry) {
      halve(finer);
    } else if (solved_ && finer >= -1 && finer + 1 < static_cast<int>(t.following.size())) {
      const double* ahead = (t.following.begin() + (finer + 1))->data();
      const auto i = static_cast<std::size_t>(c);
      if (laws()[i].kind == LawKind::kSpeedDependent && single_ && point_.modes[i] != ContactMode::kStick)
        ahead_ = ahead;  // sliding speed is smoother than the force, and continues better
      else
        kernels_.matrix8(ahead, forces, forces);
    } else if (fresh_ && !retry && nc_ == 1) {
      forces_.head<kNodes>() = point_.force(0) * first_shape_;
      halve(level - first_level_);
    } else {
      Eigen::Map<RadauTables::Vector8>(forces).setConstant(point_.force(c));
    }
  }
}

int CollocationFlow::foreseen_level(int level) const {
  // Sliding slows down ever faster where the law rises steeply: look ahead by a parabola through the last step's
  // velocities and keep α (μ_s − μ_k) N e^{−αv} × mobility × step within what eight nodes resolve. Solved for v once,
  // so that no exponential is needed here.
  if (!solved_) return level;
  const auto& node = nodes_.node;
  static const double over12 = 1.0 / (node(5) - node(2)), over23 = 1.0 / (node(7) - node(5)),
                      over13 = 1.0 / (node(7) - node(2));
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = laws()[i];
    if (law.kind != LawKind::kSpeedDependent || point_.modes[i] == ContactMode::kStick) continue;
    const double sign = sign_of(point_.modes[i]);
    const auto speed = [&](int j) { return sign * (drive_nodes_(kNodes * c + j) - velocity_(kNodes * c + j)); };
    const double s1 = speed(2), s2 = speed(5), s3 = speed(7);
    const double d12 = (s2 - s1) * over12, d23 = (s3 - s2) * over23;
    const double bend = (d23 - d12) * over13, slope = d23 + bend * (node(7) - node(5));
    double ahead = std::ldexp(1.0, step_level_ - level), enough = steep_speed_[i] - level * steep_fall_[i];
    for (; level + 1 < StepTables::kLevels; ++level, ahead *= 0.5, enough -= steep_fall_[i]) {
      const double then = std::max(0.0, s3 + ahead * (slope + bend * ahead));
      if (law.characteristic == nullptr ? then >= enough : !too_steep(c, then, level)) break;
    }
    if (s3 + ahead * (slope + bend * ahead) <= 0.0) level = std::max(level, stop_level_);
  }
  return level;
}

bool CollocationFlow::solve_forces(int level) {
  const Collocation& table = tables_.collocation(level);
  const double h = tables_.step(level);
  const RadauTables::Vector8 drive_speed = drive_velocities(begin_, h);
  for (int c = 0; c < nc_; ++c) drive_nodes_.segment<kNodes>(kNodes * c) = drive_speed;
  if (single_) return solve_single(table);
  const auto without_contacts = [&](const AtNodes& at, Eigen::VectorXd& out) {
    at.without_forces(x_begin_.data(), nc_, out.data());
    if (given_ > 0)
      out.noalias() += at.kernel.topRightCorner(kNodes * nc_, kNodes * given_) * forces_.tail(kNodes * given_);
  };
  without_contacts(table, free_);
  if (!any_elaborate_) return solve_coupled(table, nullptr, h);
  const AtNodes& displacements = tables_.displacements(level);
  without_contacts(displacements, free_way_);
  for (int j = 0; j < kNodes; ++j) way_nodes_(j) = drive_way(begin_, h * nodes_.node(j));
  if (!solve_coupled(table, &displacements, h)) return false;
  moved_ = free_way_ + displacements.kernel.topLeftCorner(free_.size(), free_.size()) * forces_.head(free_.size());
  return true;
}

bool CollocationFlow::solve_single(const Collocation& table) {
  const ContactForces& law = laws()[0];
  const double* load = table.load.data();
  if (given_ > 0) {
    given_speeds_ = table.load.col(0);
    given_speeds_.noalias() += table.kernel.topRightCorner(kNodes, kNodes * given_) * forces_.tail(kNodes * given_);
    load = given_speeds_.data();
  }
  if (law.kind == LawKind::kSmooth) return solve_single_smooth(table, load);
  const double sign = sign_of(point_.modes[0]);
  const kernels::Trial trial{model_.n,
                             model_.np,
                             table.free.data(),
                             load,
                             table.own_kernel.data(),
                             table.kernel_norm,
                             x_begin_.data(),
                             drive_nodes_.data(),
                             sign,
                             law.kinetic,
                             law.drop,
                             law.alpha,
                             ahead_,
                             std::min(kLargestForceError, kForceShare * options_.tolerance),
                             forces_.data(),
                             velocity_.data()};
  if (point_.modes[0] == ContactMode::kStick) {
    kernels_.solve_stick(trial, table.kernel_inverse.data());
    return true;
  }
  if (!law.is_constant()) return kernels_.solve_stribeck(trial);
  forces_.head<kNodes>().setConstant(sign * law.kinetic);
  kernels_.solve_sliding(trial);
  return true;
}

bool CollocationFlow::solve_single_smooth(const Collocation& table, const double* load) {
  const ContactForces& law = laws()[0];
  const Eigen::MatrixXd& kernel = table.own_kernel;
  kernels_.node_sums(table.free.data(), x_begin_.data(), 2 * model_.np, load, free_.data());
  RadauTables::Vector8 force, slope, delta, residual, v = free_ + kernel * forces_.head<kNodes>();
  for (int iteration = 0; iteration < kNewtonLimit; ++iteration) {
    for (int j = 0; j < kNodes; ++j) {
      force(j) = law.smooth(drive_nodes_(j) - v(j), slope(j));
      slope(j) = -slope(j);
    }
    residual = free_ + kernel * force - v;
    if (!kernels_.solve_nodes(kernel.data(), slope.data(), residual.data(), delta.data()))
      delta = (RadauTables::Matrix8::Identity() - kernel * slope.asDiagonal()).eval().partialPivLu().solve(residual);
    v += delta;
    const double change = delta.cwiseAbs().maxCoeff();
    if (!std::isfinite(change)) return false;
    if (change < newton_change_ * law.epsilon ||
        change <= kUnmoved * (v.cwiseAbs().maxCoeff() + drive_nodes_.head<kNodes>().cwiseAbs().maxCoeff())) {
      forces_.head<kNodes>() = force + slope.cwiseProduct(delta);
      velocity_ = v;
      return true;
    }
  }
  return false;
}

bool CollocationFlow::solve_coupled(const Collocation& table, const AtNodes* displacements, double h) {
  const Eigen::Index size = kNodes * nc_;
  const Eigen::MatrixXd& kernel = table.own_kernel;
  auto forces = forces_.head(size);
  const auto block = [](auto& vector, int c) { return vector.template segment<kNodes>(kNodes * c); };
  std::vector<bool> stuck(static_cast<std::size_t>(nc_));
  bool any_unknown = false, all_stuck = true, any_nonlinear = false;
  for (std::size_t c = 0; c < stuck.size(); ++c) {
    stuck[c] = held(point_.modes, static_cast<int>(c));
    any_unknown |= stuck[c] || (any_elaborate_ && own_forces_[c].moves());
    all_stuck &= stuck[c];
    any_nonlinear |= !stuck[c] && !is_piecewise_linear(laws()[c].kind);
  }
  if (all_stuck) {
    forces.noalias() = table.kernel_inverse * (drive_nodes_ - free_);
    velocity_ = drive_nodes_;
    return true;
  }
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (bristled(c)) continue;
    if (elaborate(c) && !stuck[i]) {
      block(forces_, c).setConstant(own_forces_[i].moves() ? point_.force(c) : own_forces_[i].constant);
      continue;
    }
    block(forces_, c)
        .setConstant(laws()[i].is_constant() && !stuck[i] ? sign_of(point_.modes[i]) * laws()[i].kinetic
                                                          : point_.force(c));
  }
  if (!any_unknown && !any_nonlinear) {
    velocity_.noalias() = free_ + kernel * forces;
    return true;
  }

  Eigen::MatrixXd jacobian(size, size);
  Eigen::VectorXd residual(size);
  for (int iteration = 0; iteration < kNewtonLimit; ++iteration) {
    // Sliding contacts: λ − law(v) = 0. Sticking ones: v − v_drive = 0.
    velocity_.noalias() = free_ + kernel * forces;
    if (displacements != nullptr)
      moved_.noalias() = free_way_ + displacements->kernel.topLeftCorner(size, size) * forces;
    double curvature = 0.0;
    for (int c = 0; c < nc_; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const ContactForces& law = laws()[i];
      if (bristled(c)) {
        const BristleStep step = solve_bristle(law.bristle, sign_of(point_.modes[i]), internal_begin_(own_at_[i]), h,
                                               block(drive_nodes_, c) - block(velocity_, c));
        block(residual, c) = step.force - block(forces_, c);
        jacobian.middleRows<kNodes>(kNodes * c).noalias() = step.slope * kernel.middleRows<kNodes>(kNodes * c);
        jacobian.block<kNodes, kNodes>(kNodes * c, kNodes * c) += RadauTables::Matrix8::Identity();
        block(bristle_nodes_, c) = step.z;
        continue;
      }
      if (elaborate(c) && !stuck[i]) {
        const OwnForce& own = own_forces_[i];
        for (int j = 0; j < kNodes; ++j) {
          const Eigen::Index row = kNodes * c + j;
          residual(row) = own.at(way_nodes_(j), moved_(row), velocity_(row)) - forces_(row);
          jacobian.row(row) = own.stiffness * displacements->kernel.row(row).head(size) + own.damping * kernel.row(row);
          jacobian(row, row) += 1.0;
        }
        continue;
      }
      for (int j = 0; j < kNodes; ++j) {
        const Eigen::Index row = kNodes * c + j;
        if (stuck[i]) {
          residual(row) = drive_nodes_(row) - velocity_(row);
          jacobian.row(row) = kernel.row(row);
          continue;
        }
        double lambda = 0.0, slope = 0.0;  // dλ/dv
        const double s = drive_nodes_(row) - velocity_(row);
        if (!law.sticks()) {
          lambda = law.smooth(s, slope);
          slope = -slope;
        } else if (law.characteristic != nullptr) {
          lambda = law.continued(sign_of(point_.modes[i]), s);
          slope = -law.slope(sign_of(point_.modes[i]), s);
        } else {
          const double sign = sign_of(point_.modes[i]), scaled = law.alpha * sign * s;
          const bool inside = scaled > -2 * kLargestOvershoot;
          const double e = law.drop * std::exp(inside ? -scaled : 2 * kLargestOvershoot);
          lambda = sign * (law.kinetic + e);
          slope = inside ? law.alpha * e : 0.0;
        }
        residual(row) = lambda - forces_(row);
        jacobian.row(row) = -slope * kernel.row(row);
        jacobian(row, row) += 1.0;
      }
    }
    const Eigen::VectorXd delta = jacobian.partialPivLu().solve(residual);
    if (!delta.allFinite()) return false;
    forces += delta;
    const Eigen::VectorXd dv = kernel * delta;
    velocity_ += dv;
    for (int c = 0; c < nc_; ++c) {
      const ContactForces& law = laws()[static_cast<std::size_t>(c)];
      if (law.characteristic != nullptr) {
        if (stuck[static_cast<std::size_t>(c)]) continue;
        // What the law says at the new velocities is about what the next change would put right.
        double squares = 0.0;
        for (int j = kNodes * c; j < kNodes * (c + 1); ++j) {
          const double sign = sign_of(point_.modes[static_cast<std::size_t>(c)]);
          const double left = law.continued(sign, drive_nodes_(j) - velocity_(j)) - forces_(j);
          squares += left * left;
        }
        if (!std::isfinite(squares)) return false;
        curvature = std::max(curvature, std::sqrt(std::sqrt(squares) * over_scale(c)));
      } else if (law.kind == LawKind::kSpeedDependent || law.kind == LawKind::kSmooth) {
        const double rate = law.kind == LawKind::kSmooth ? 1.0 / law.epsilon : law.alpha;
        if (!stuck[static_cast<std::size_t>(c)])
          curvature = std::max(curvature, rate * block(dv, c).cwiseAbs().maxCoeff());
      } else if (law.kind == LawKind::kBristle) {
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

CollocationFlow::Ending CollocationFlow::ending(const double* values) const {
  const double fifth = std::abs(kernels_.dot(nodes_.legendre5.data(), values, kNodes));
  double sixth = 0.0, seventh = 0.0;
  kernels_.two_dots(nodes_.legendre6.data(), nodes_.legendre7.data(), values, sixth, seventh);
  sixth = std::abs(sixth);
  seventh = std::abs(seventh);
  const double ratio = sixth < fifth ? sixth / fifth : 1.0;
  if (seventh < ratio * sixth) return {ratio * sixth, ratio};
  return {seventh, seventh < sixth ? seventh / sixth : 1.0};
}

double CollocationFlow::force_error() const {
  constexpr double kOfBegin = 0.5;  // there the first polynomial left out is at its largest
  static const RadauTables::Vector8 at_begin = radau().lagrange(0.0);
  double worst = 0.0;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (laws()[i].kind == LawKind::kFree) continue;
    // The first coefficient left out, if the sequence keeps falling as it does.
    const auto [last, ratio] = ending(forces_.data() + kNodes * c);
    worst = std::max(worst, std::max(0.0, last * ratio - rounding_of_stop(c)) * over_scale(c));
    // What a force does before the first node no coefficient sees: it begins where its law has it.
    if (fresh_ && point_.modes[i] != ContactMode::kStick && !bristled(c) && !elaborate(c))
      worst = std::max(
          worst, kOfBegin * over_scale(c) *
                     std::abs(kernels_.dot(at_begin.data(), forces_.data() + kNodes * c, kNodes) - point_.force(c)));
    if (bristled(c)) worst = std::max(worst, bristle_error(c, halfway()) * acting_ / tables_.step(step_level_));
    if (laws()[i].characteristic != nullptr && point_.modes[i] != ContactMode::kStick)
      worst = std::max(worst, characteristic_error(c));
  }
  return worst;
}

}  // namespace slipmode::dynamics
