#include "dynamics/internal/belt_work.hpp"

#include "dynamics/internal/quadratic_forms.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slipmode::dynamics {
namespace {

bool has_real_modes(const ModalModel& pairs) {
  return pairs.n == 0 || (pairs.proportional && pairs.dissipation_root.size() == 0);
}

/// y of rᵀx_f.
Eigen::VectorXd antiderivative(const ModalModel& pairs, const Eigen::VectorXd& r) {
  const auto np = pairs.np;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(2 * np);
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    const Eigen::Vector2d of_pair = block(pairs, i).transpose().inverse() * Eigen::Vector2d(r(i), r(np + i));
    y(i) = of_pair(0);
    y(np + i) = of_pair(1);
  }
  return y;
}

}  // namespace

std::unique_ptr<BeltWork> BeltWork::make(const RegimeTables& tables, const ModalModel& slipping) {
  const Regime& r = tables.regime();
  if (!r.told_from_rounding) return nullptr;
  for (Eigen::Index i = 0; i < r.pairs.n; ++i)
    if (!(block(r.pairs, i).determinant() > 0.0)) return nullptr;
  std::unique_ptr<BeltWork> work(new BeltWork(r, slipping));
  if (has_real_modes(r.pairs) && std::ranges::find(work->exchange_, Exchange::kForms) == work->exchange_.end())
    return work;
  if (!decays(r.pairs, 0.0)) return nullptr;
  work->forms_ = &quadratic_forms(tables, slipping);
  if (!work->forms_->found) return nullptr;
  if (work->forms_->viscous_is_energy) work->held_ = r.to_slipping * r.particular + r.inputs_slipping;
  return work;
}

BeltWork::BeltWork(const Regime& r, const ModalModel& slipping) : regime_(r), slipping_(slipping) {
  const auto np = r.pairs.np, nc = r.speed_input();
  impulse_ = way_ = Eigen::MatrixXd::Zero(2 * np, nc);
  for (Eigen::Index c = 0; c < nc; ++c) {
    const bool constant = r.force_row.col(c).isZero(0.0);
    if (!constant) impulse_.col(c) = antiderivative(r.pairs, r.force_row.col(c));
    // A stop beside a held contact presses as that moves.
    const bool own = r.force_coefficient.col(c) == Eigen::VectorXd::Unit(r.inputs(), c);
    const Exchange by = r.sticks(static_cast<int>(c))            ? Exchange::kFollows
                        : (constant && own) || r.slope(c) != 0.0 ? Exchange::kPotential
                                                                 : Exchange::kForms;
    if (by == Exchange::kForms) way_.col(c) = antiderivative(r.pairs, r.displacement_row.col(c));
    exchange_.push_back(by);
  }
  stiffness_ = mass_ = Eigen::VectorXd::Zero(np);
  if (has_real_modes(r.pairs))
    for (Eigen::Index i = 0; i < r.pairs.n; ++i)
      if (r.pairs.damping(i) != 0.0) {
        stiffness_(i) = r.pairs.omega(i) * r.pairs.omega(i);
        mass_(i) = 1.0;
      }
  const Eigen::VectorXd moved = r.particular.col(nc);
  dragged_loss_ = r.viscous_power(moved, 1.0);
  Eigen::VectorXd with = r.viscous_cross;
  if (r.pairs.dissipation_root.size() > 0)
    with += r.pairs.dissipation_root.transpose() * (r.pairs.dissipation_root * moved);
  else if (r.pairs.n > 0)
    with.tail(np) += r.pairs.damping.cwiseProduct(moved.tail(np));
  dragging_ = 2.0 * antiderivative(r.pairs, with);
}

double BeltWork::loss_of_squares(const StayPlace& at, const Eigen::VectorXd& inputs) {
  if (forms_ == nullptr || has_real_modes(regime_.pairs)) {
    const auto np = regime_.pairs.np;
    return -0.5 * (stiffness_.dot(at.free.head(np).cwiseAbs2()) + mass_.dot(at.free.tail(np).cwiseAbs2()));
  }
  if (!forms_->viscous_is_energy) return quadratic(forms_->viscous, at.free);
  lifted_ = at.slipping;
  lifted_.noalias() -= held_ * inputs;
  return -free_energy(regime_, slipping_, lifted_, at.free);
}

void BeltWork::measure(const StayPlace& at, const Eigen::VectorXd& inputs, End& out) {
  const Regime& r = regime_;
  const auto nc = r.speed_input();
  out.time = at.time;
  out.loss = loss_of_squares(at, inputs);
  out.dragged = inputs(nc) * dragging_.dot(at.free);
  out.squares = forms_ != nullptr && forms_->contact.size() > 0 ? quadratic(forms_->contact, at.free) : 0.0;
  for (Eigen::VectorXd* of_contacts : {&out.impulse, &out.steady, &out.exchange, &out.way}) of_contacts->setZero(nc);
  for (Eigen::Index c = 0; c < nc; ++c) {
    const Exchange by = exchange_[static_cast<std::size_t>(c)];
    out.steady(c) = r.held_force(c, inputs);
    if (by != Exchange::kPotential || r.slope(c) != 0.0) out.impulse(c) = impulse_.col(c).dot(at.free);
    if (by == Exchange::kForms) {
      out.exchange(c) = r.displacement_row.col(c).dot(at.free);
      out.way(c) = way_.col(c).dot(at.free);
    } else if (by == Exchange::kPotential) {
      const double place = r.displacement_row.col(c).dot(at.x) + r.displacement_coefficient.col(c).dot(inputs);
      out.exchange(c) = (inputs(c) + 0.5 * r.slope(c) * place) * place;
    } else if (r.spring(c) > 0.0) {
      const double force = r.force_row.col(c).dot(at.x) + r.force_coefficient.col(c).dot(inputs);
      out.exchange(c) = -force * force / (2.0 * r.spring(c));
    }
  }
}

void BeltWork::begin(const StayPlace& at, const Eigen::VectorXd& inputs) { measure(at, inputs, begin_); }

StayWork BeltWork::until(const StayPlace& at, const Eigen::VectorXd& inputs) {
  const Regime& r = regime_;
  const auto nc = r.speed_input();
  const double V = inputs(nc);
  measure(at, inputs, end_);
  const double stay = end_.time - begin_.time;
  StayWork work;
  double size = 0.0;
  for (const End* end : {&begin_, &end_}) size += std::abs(end->loss) + std::abs(end->dragged) + std::abs(end->squares);
  for (Eigen::Index c = 0; c < nc; ++c) {
    const Exchange by = exchange_[static_cast<std::size_t>(c)];
    const double impulse = end_.impulse(c) - begin_.impulse(c) + stay * (begin_.steady(c) + end_.steady(c)) / 2.0;
    work.drive += V * impulse;
    // Of a stay that has just begun the parts of an impulse all but cancel.
    size += std::abs(V) * (std::abs(begin_.impulse(c)) + std::abs(end_.impulse(c)) +
                           stay * (std::abs(begin_.steady(c)) + std::abs(end_.steady(c))) / 2.0);
    if (by == Exchange::kForms) {
      // ∫ λ v_p + ∫ λ_p d(wᵀq)_f, by parts; λ_p is linear.
      const double growth = stay > 0.0 ? (end_.steady(c) - begin_.steady(c)) / stay : 0.0;
      const double speed = r.velocity_row.col(c).dot(r.particular.col(nc)) + r.velocity_coefficient(nc, c);
      const double first = begin_.steady(c) * begin_.exchange(c), last = end_.steady(c) * end_.exchange(c);
      work.contact += V * speed * impulse + last - first - growth * (end_.way(c) - begin_.way(c));
      size += std::abs(first) + std::abs(last) + std::abs(growth) * (std::abs(begin_.way(c)) + std::abs(end_.way(c)));
    } else {
      size += std::abs(begin_.exchange(c)) + std::abs(end_.exchange(c));
      work.contact += end_.exchange(c) - begin_.exchange(c) + (by == Exchange::kFollows ? V * impulse : 0.0);
    }
  }
  work.contact += end_.squares - begin_.squares;
  work.viscous = end_.loss - begin_.loss + (end_.dragged - begin_.dragged) + V * V * dragged_loss_ * stay;
  work.rounding = std::numeric_limits<double>::epsilon() * size;
  std::swap(begin_, end_);
  return work;
}

}  // namespace slipmode::dynamics
