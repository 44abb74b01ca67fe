#include "dynamics/internal/belt_work.hpp"

#include <utility>

namespace slipmode::dynamics {

std::unique_ptr<BeltWork> BeltWork::make(const Regime& r) {
  if (!r.told_from_rounding) return nullptr;
  if (r.pairs.n > 0 && (!r.pairs.proportional || r.pairs.dissipation_root.size() > 0)) return nullptr;
  for (Eigen::Index i = 0; i < r.pairs.n; ++i)
    if (!(r.pairs.omega(i) > 0.0)) return nullptr;
  for (std::size_t c = 0; c < r.roles.size(); ++c)
    if (!r.follows[c] && !r.force_row.col(static_cast<Eigen::Index>(c)).isZero(0.0)) return nullptr;
  return std::unique_ptr<BeltWork>(new BeltWork(r));
}

BeltWork::BeltWork(const Regime& r) : regime_(r) {
  const auto np = r.pairs.np, nc = r.speed_input();
  stiffness_ = mass_ = Eigen::VectorXd::Zero(np);
  impulse_ = Eigen::MatrixXd::Zero(2 * np, nc);
  resting_ = r.particular.transpose() * r.force_row + r.force_coefficient;
  for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
    const double stiffness = r.pairs.omega(i) * r.pairs.omega(i), d = r.pairs.damping(i);
    if (d != 0.0) {
      stiffness_(i) = stiffness;
      mass_(i) = 1.0;
    }
    for (Eigen::Index c = 0; c < nc; ++c) {
      impulse_(i, c) = r.force_row(np + i, c) - r.force_row(i, c) * d / stiffness;
      impulse_(np + i, c) = -r.force_row(i, c) / stiffness;
    }
  }
}

void BeltWork::measure(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs, End& out) {
  const Regime& r = regime_;
  const auto np = r.pairs.np, nc = r.speed_input();
  const double V = inputs(nc);
  free_.noalias() = x - r.particular * inputs;
  carried_.noalias() = r.particular.bottomRows(np) * inputs;
  out.time = t;
  out.energy = 0.5 * (stiffness_.dot(free_.head(np).cwiseAbs2()) + mass_.dot(free_.tail(np).cwiseAbs2()));
  out.dragged = 2.0 * V * r.viscous_cross.tail(np).dot(x.head(np));
  if (r.pairs.n > 0) out.dragged += 2.0 * r.pairs.damping.cwiseProduct(carried_).dot(free_.head(np));
  out.by_force.resize(nc);
  out.resting.resize(nc);
  out.stored = 0.0;
  for (Eigen::Index c = 0; c < nc; ++c) {
    if (r.sticks(static_cast<int>(c))) {
      out.by_force(c) = impulse_.col(c).dot(free_);
      out.resting(c) = resting_.col(c).dot(inputs);
      if (r.spring(c) == 0.0) continue;
      const double force = r.force_row.col(c).dot(x) + r.force_coefficient.col(c).dot(inputs);
      out.stored += force * force / (2.0 * r.spring(c));
    } else {
      out.by_force(c) = r.displacement_row.col(c).dot(x) + r.displacement_coefficient.col(c).dot(inputs);
    }
  }
}

void BeltWork::begin(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) {
  measure(t, x, inputs, begin_);
}

StayWork BeltWork::until(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) {
  const Regime& r = regime_;
  const auto nc = r.speed_input();
  const double V = inputs(nc);
  measure(t, x, inputs, end_);
  const double stay = end_.time - begin_.time;
  StayWork work;
  for (Eigen::Index c = 0; c < nc; ++c) {
    const double change = end_.by_force(c) - begin_.by_force(c);
    if (r.sticks(static_cast<int>(c))) {
      const double by_drive = V * (change + stay * (begin_.resting(c) + end_.resting(c)) / 2.0);
      work.contact += by_drive;
      work.drive += by_drive;
    } else {
      work.contact += inputs(c) * change;
      work.drive += inputs(c) * V * stay;
    }
  }
  work.contact -= end_.stored - begin_.stored;
  work.viscous = begin_.energy - end_.energy + (end_.dragged - begin_.dragged) + V * V * r.viscous_drive * stay;
  if (r.pairs.n > 0) work.viscous += r.pairs.damping.dot(carried_.cwiseAbs2()) * stay;
  std::swap(begin_, end_);
  return work;
}

}  // namespace slipmode::dynamics
