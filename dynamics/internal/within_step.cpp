#include "dynamics/internal/within_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace slipmode::dynamics {
namespace {

/// Up to this phase (fastest rate times time) what is left of a step is left to a Taylor series.
constexpr double kTaylorPhase = 1.0;
constexpr double kNegligible = 1e-17;
/// A state moved by less than this phase, and share of a step, takes so many terms: the next is below 1e-20.
constexpr double kShortShift = 1e-3;
constexpr int kShiftTerms = 6;

/// Terms after which those of a series in this phase are negligible. The forces' highest power enters the last of the
/// first eight. @param steepness  its coefficient, by the size of the forces
int terms_for(double phase, double steepness) {
  static const std::array<double, kernels::kMostTerms + 1> reciprocal = [] {
    std::array<double, kernels::kMostTerms + 1> out{};
    for (int k = 1; k <= kernels::kMostTerms; ++k) out[static_cast<std::size_t>(k)] = 1.0 / k;
    return out;
  }();
  const double square = phase * phase, fourth = square * square;
  double by_state = fourth * fourth / 40320.0, by_force = steepness;
  int terms = kNodes;
  for (; terms < kernels::kMostTerms && by_state + by_force > kNegligible; ++terms) {
    const double factor = phase * reciprocal[static_cast<std::size_t>(terms + 1)];
    by_state *= factor;
    by_force *= factor;
  }
  return terms;
}

/// For squares of velocities over the rest of a step. Exact to degree 11: beyond, there is the square of what the
/// forces still hold in degree 5, times a damping ratio.
const kernels::SeriesRule& rest_rule() {
  static const kernels::SeriesRule out = [] {
    const GaussRule gauss = gauss_rule(kernels::kWorkPoints);
    kernels::SeriesRule rule{};
    for (int p = 0; p < kernels::kWorkPoints; ++p) {
      rule.weight[p] = gauss.weight(p);
      double power = 1.0;
      for (int k = 0; k < kernels::kMostTerms; ++k) rule.at_node[k][p] = power *= gauss.node(p) / (k + 1);
    }
    return rule;
  }();
  return out;
}

}  // namespace

WithinStep::WithinStep(const StepTables& tables, bool audit, Load load)
    : tables_(tables),
      model_(tables.acted_on()),
      audit_(audit),
      loaded_(load == Load::kIncluded && tables.loaded()),
      pairs_{model_.np,
             model_.contacts,
             model_.g11.data(),
             model_.g12.data(),
             model_.g21.data(),
             model_.g22.data(),
             loaded_ ? model_.load.data() : nullptr,
             model_.input.data()},
      base_(2 * model_.np),
      next_(2 * model_.np),
      moments_(kernels::kMoments * model_.contacts),
      points_(audit && !model_.proportional ? 2 * model_.np * kernels::kWorkPoints : 0) {
  pairs_.given = model_.given;
  for (auto* v : {&current_, &other_, &monomials_, &scaled_, &velocities_}) v->resize(kNodes * model_.contacts);
}

void WithinStep::begin(const double* x, const double* forces, int level) {
  x_ = x;
  forces_ = forces;
  level_ = level;
  found_ = false;
}

void WithinStep::seek(double tau) {
  const double fastest = model_.fastest;
  if (found_ && tau >= base_time_ && fastest * (tau - base_time_) <= kTaylorPhase &&
      tau - base_time_ <= tables_.step(base_level_))
    return;
  const int nc = model_.contacts;
  const auto to_part = [&](const RadauTables::Matrix8& part, const Eigen::VectorXd& from, Eigen::VectorXd& to) {
    for (int c = 0; c < nc; ++c) kernels_.matrix8(part.data(), from.data() + kNodes * c, to.data() + kNodes * c);
  };
  const double* from = x_;
  const auto take = [&](int level, const Eigen::VectorXd& forces) {
    if (audit_) {
      tables_.collocation(level).velocities(from, forces.data(), velocities_.data());
      const kernels::Work piece = tables_.work(level, from, forces.data(), velocities_.data());
      before_.contact += piece.contact;
      before_.force += piece.force;
      before_.loss += piece.loss;
    }
    kernels_.propagate(tables_.propagator(level).arrays(loaded_), from, forces.data(), next_.data());
    base_.swap(next_);
    from = base_.data();
  };
  found_ = true;
  before_ = {};
  base_time_ = 0.0;
  base_level_ = level_;
  current_ = Eigen::Map<const Eigen::VectorXd>(forces_, kNodes * nc);
  double rest = tau, h = tables_.step(base_level_);
  while (fastest * rest > kTaylorPhase && base_level_ + 1 < StepTables::kLevels) {
    ++base_level_;
    h /= 2.0;
    to_part(nodes_.left_half, current_, other_);
    if (rest >= h) {
      take(base_level_, other_);
      rest -= h;
      base_time_ += h;
      to_part(nodes_.right_half, current_, other_);
    }
    current_.swap(other_);
  }
  if (from == x_) base_ = Eigen::Map<const Eigen::VectorXd>(x_, 2 * model_.np);
  to_part(nodes_.monomial, current_, monomials_);
  double highest = 0.0;
  for (int c = 0; c < nc; ++c) highest = std::max(highest, std::abs(monomials_(kNodes * c + kNodes - 1)));
  const double size = nc > 0 ? current_.cwiseAbs().maxCoeff() : 0.0;
  steepness_ = highest > 0.0 ? highest / size : 0.0;
}

const double* WithinStep::coefficients(double rest) {
  const double share = rest / tables_.step(base_level_);
  for (int c = 0; c < model_.contacts; ++c) {
    double power = rest;
    for (int k = kNodes * c; k < kNodes * (c + 1); ++k, power *= share) scaled_(k) = monomials_(k) * power;
  }
  return scaled_.data();
}

void WithinStep::state(double tau, double* out_x) {
  seek(tau);
  const double rest = tau - base_time_;
  kernels_.taylor(pairs_, base_.data(), coefficients(rest), rest, terms_for(model_.fastest * rest, steepness_), out_x);
}

void WithinStep::shift(double tau, double shift, double* x) {
  seek(tau);
  const double h = tables_.step(base_level_);
  if (!(std::max(model_.fastest, 1.0 / h) * std::abs(shift) < kShortShift)) return state(tau + shift, x);
  // The forces by powers of t/shift from tau on, times shift.
  const double at = (tau - base_time_) / h, share = shift / h;
  for (int c = 0; c < model_.contacts; ++c) {
    std::array<double, kNodes> power;
    std::copy_n(monomials_.data() + kNodes * c, kNodes, power.begin());
    double size = shift;
    for (std::size_t k = 0; k < kShiftTerms; ++k, size *= share) {
      for (std::size_t l = kNodes - 1; l-- > k;) power[l] += at * power[l + 1];
      scaled_(kNodes * c + static_cast<Eigen::Index>(k)) = power[k] * size;
    }
  }
  kernels::PairArrays pairs = pairs_;
  pairs.powers = kShiftTerms;
  kernels_.taylor(pairs, x, scaled_.data(), shift, kShiftTerms, x);
}

kernels::Work WithinStep::work(double tau) {
  seek(tau);
  const double rest = tau - base_time_;
  if (!(rest > 0.0)) return before_;
  const auto size = 2 * model_.np;
  const kernels::SeriesRule& rule = rest_rule();
  kernels::Work sum = kernels_.taylor_work(
      pairs_, model_.velocity_row.data(), model_.proportional ? model_.damping.data() : nullptr, base_.data(),
      coefficients(rest), rest, terms_for(model_.fastest * rest, steepness_), rule, moments_.data(), points_.data());
  if (!model_.proportional)
    for (int k = 0; k < kernels::kWorkPoints; ++k)
      sum.loss += rule.weight[k] * rest * model_.viscous_power(points_.segment(size * k, size));
  sum.contact += before_.contact;
  sum.force += before_.force;
  sum.loss += before_.loss;
  return sum;
}

}  // namespace slipmode::dynamics
