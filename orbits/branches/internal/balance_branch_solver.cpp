#include "orbits/branches/internal/balance_branch_solver.hpp"

#include <slipmode/core/errors.hpp>
#include "orbits/balance/internal/balance_orbit.hpp"
#include "orbits/branches/internal/balance_touch.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

constexpr int kMaxNewton = 20;
constexpr double kParameterStep = 1e-5;  ///< in the parameter, of its range: the equations are smooth in it
/// Residuals that stall below this are rounding.
constexpr double kRounding = 1e-10;

Eigen::VectorXd solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  bool singular = false;
  return least_norm_solution(A, b, singular);
}

/// Entries of a vector. By loop, as GCC 12 takes Eigen's indexed views for a bad free.
Eigen::VectorXd picked(const Eigen::VectorXd& x, const std::vector<Eigen::Index>& entries) {
  Eigen::VectorXd out(std::ssize(entries));
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = x[entries[static_cast<std::size_t>(i)]];
  return out;
}

}  // namespace

BalanceAt::BalanceAt(dynamics::HybridSystem own, int order, int harmonics)
    : system(std::move(own)), response(system, order, harmonics), problem(system, response, kExact, harmonics) {}

BalanceBranchSolver::BalanceBranchSolver(dynamics::SystemFamily family, const Balance& from, double parameter,
                                         const ContinuationOptions& options, bool symmetric)
    : BalanceBranchSolver([own = std::move(family)](double, double at) { return own(at); }, from, parameter, 0.0,
                          options, symmetric, std::nullopt) {}

BalanceBranchSolver::BalanceBranchSolver(dynamics::PlaneFamily family, const SpecialPoint& special, double parameter,
                                         const KeyRange& other, const ContinuationOptions& options)
    : BalanceBranchSolver(std::move(family), *special.balance, parameter, special.parameter, options,
                          special.orbit.symmetric, condition_of(special, other)) {}

BalanceBranchSolver::BalanceBranchSolver(dynamics::PlaneFamily family, const Balance& from, double parameter,
                                         double other, const ContinuationOptions& options, bool symmetric,
                                         const std::optional<CurveCondition>& condition)
    : family_(std::move(family)),
      options_(options),
      condition_(condition),
      first_(from),
      symmetric_(symmetric),
      range_(std::abs(options.to - options.from)) {
  const dynamics::HybridSystem system = family_(other, parameter);
  const Eigen::VectorXd x = unknowns_of({.parameter = parameter, .orbit = {}, .balance = from, .other = other}).x;
  const ContactResponse first(system, from.order, from.harmonics);
  displacements_ = x.size() - from.rigid.size();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::Index order = first.order_of(i);
    if (order % 2 == 0) even_.push_back(i);
    if (order % 2 == 1 || !symmetric) solved_.push_back(i);
  }
  size_ = x.cwiseAbs().maxCoeff();
  if (!(size_ > 0.0)) size_ = 1.0;
  for (const BalancedLaw& law : balanced_laws(system)) stiffness_ = std::max(stiffness_, strongest(law, 0.0));
  if (!(stiffness_ > 0.0)) stiffness_ = 1.0;  // nothing holds a mean displacement
  if (condition_ && condition_->kind == SpecialKind::kGrazing) condition_ = grazed(system, from, *condition_);
}

BalanceUnknowns BalanceBranchSolver::unknowns_of(const BranchPoint& point) const {
  const Balance& balance = *point.balance;
  BalanceUnknowns out{{}, point.parameter, point.other.value_or(0.0)};
  if (condition_) out.touch = condition_->touch;
  out.x = orbits::unknowns_of(balance.displacement, equations_at(out)->response);
  out.x.tail(balance.rigid.size()) = balance.rigid;
  if (symmetric_) clear_even(out.x);
  return out;
}

void BalanceBranchSolver::clear_even(Eigen::VectorXd& x) const {
  for (const Eigen::Index i : even_) x[i] = 0.0;
}

Eigen::VectorXd BalanceBranchSolver::scaled(const Eigen::VectorXd& column,
                                            const std::vector<Eigen::Index>& entries) const {
  Eigen::VectorXd out = picked(column, entries);
  for (Eigen::Index i = 0; i < out.size(); ++i)
    if (entries[static_cast<std::size_t>(i)] >= displacements_) out[i] /= stiffness_;
  return out / size_;
}

Eigen::MatrixXd BalanceBranchSolver::scaled_block(const Eigen::MatrixXd& jacobian,
                                                  const std::vector<Eigen::Index>& entries) const {
  const auto N = std::ssize(entries);
  Eigen::MatrixXd out(N, N);
  for (Eigen::Index j = 0; j < N; ++j)
    out.col(j) = size_ * scaled(jacobian.col(entries[static_cast<std::size_t>(j)]), entries);
  return out;
}

BalanceBranchEvaluation BalanceBranchSolver::evaluate(const BalanceUnknowns& at) const {
  if (!in_range(at))
    throw NumericalFailure(fmt::format("the parameter {:.9g} is outside the range of the branch", at.parameter), 0.0,
                           at.x, 0.0);
  BalanceBranchEvaluation out = balanced(at, true);
  if (condition_) add_condition(out);
  return out;
}

BalanceBranchEvaluation BalanceBranchSolver::balanced(const BalanceUnknowns& at, bool with_parameters) const {
  BalanceBranchEvaluation out{at, equations_at(at), {}, {}, {}};
  out.balance = out.own->problem.evaluate(at.x);
  const auto N = std::ssize(solved_);
  out.r = scaled(out.balance.residual, solved_);
  out.J = Eigen::MatrixXd::Zero(N, parameter_row().size());
  out.J.leftCols(N) = scaled_block(out.balance.jacobian, solved_);
  if (!with_parameters) return out;
  for (const BranchKey<BalanceUnknowns>& key : keys()) {
    Eigen::Index column = 0;
    key.row.maxCoeff(&column);
    out.J.col(column) = parameter_column(at, key);
  }
  return out;
}

Eigen::VectorXd BalanceBranchSolver::parameter_column(const BalanceUnknowns& at,
                                                      const BranchKey<BalanceUnknowns>& key) const {
  const double h = kParameterStep * key.range(), above = std::min(at.*key.value + h, key.high),
               below = std::max(at.*key.value - h, key.low);
  const auto residual_at = [&](double value) {
    BalanceUnknowns moved_to = at;
    moved_to.*key.value = value;
    return scaled(equations_at(moved_to)->problem.evaluate(at.x).residual, solved_);
  };
  return (residual_at(above) - residual_at(below)) * (key.range() / (above - below));
}

Eigen::VectorXd BalanceBranchSolver::tangent(const BalanceBranchEvaluation& at, const Eigen::VectorXd& along) const {
  const Eigen::Index N = at.J.rows();
  Eigen::MatrixXd bordered(N + 1, N + 1);
  bordered << at.J, along.transpose();
  return solution(bordered, Eigen::VectorXd::Unit(N + 1, N)).normalized();
}

BalanceUnknowns BalanceBranchSolver::moved(const BalanceBranchEvaluation& from, const Eigen::VectorXd& step,
                                           double /*share*/) const {
  BalanceUnknowns out = from.at;
  for (std::size_t i = 0; i < solved_.size(); ++i) out.x[solved_[i]] += size_ * step[static_cast<Eigen::Index>(i)];
  for (const BranchKey<BalanceUnknowns>& key : keys()) out.*key.value += key.range() * key.row.dot(step);
  return out;
}

Eigen::VectorXd BalanceBranchSolver::newton_step(const BalanceBranchEvaluation& at, const BalanceUnknowns& guess,
                                                 const Eigen::VectorXd& row) const {
  const Eigen::Index N = at.J.rows();
  Eigen::MatrixXd bordered(N + 1, N + 1);
  bordered << at.J, row.transpose();
  Eigen::VectorXd rest(N + 1);
  rest << -at.r, -row.dot(difference(at.at, guess));
  return solution(bordered, rest);
}

std::optional<BalanceBranchSolver::Corrected> BalanceBranchSolver::correct(const BalanceUnknowns& guess,
                                                                           const Eigen::VectorXd& row) const {
  const double tolerance = options_.shooting.tolerance;
  try {
    Corrected out{evaluate(guess), 0};
    const auto defect = [this](const BalanceBranchEvaluation& at) {
      return at.r.cwiseAbs().maxCoeff() / std::max(1.0, at.at.x.cwiseAbs().maxCoeff() / size_);
    };
    while (defect(out.at) > tolerance) {
      if (out.iterations++ == kMaxNewton) return std::nullopt;
      const Eigen::VectorXd step = newton_step(out.at, guess, row);
      double share = 1.0;
      BalanceBranchEvaluation next = evaluate(moved(out.at, step, share));
      while (!(next.r.norm() < out.at.r.norm()) && share > 0.05) {
        share *= 0.5;
        next = evaluate(moved(out.at, share * step, share));
      }
      if (!(next.r.norm() < out.at.r.norm()))
        return defect(out.at) <= kRounding ? std::optional(std::move(out)) : std::nullopt;
      out.at = std::move(next);
    }
    return out;
  } catch (const NumericalFailure&) {
    return std::nullopt;  // beyond the range: a shorter step may not be
  }
}

BalanceBranchEvaluation BalanceBranchSolver::polished(BalanceBranchEvaluation at, const BalanceUnknowns& guess,
                                                      const Eigen::VectorXd& row) const {
  BalanceBranchEvaluation next = evaluate(moved(at, newton_step(at, guess, row), 1.0));
  if (next.r.norm() < at.r.norm()) return next;
  return at;
}

Eigen::VectorXd BalanceBranchSolver::difference(const BalanceUnknowns& b, const BalanceUnknowns& a) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(parameter_row().size());
  out.head(std::ssize(solved_)) = picked(b.x - a.x, solved_) / size_;
  for (const BranchKey<BalanceUnknowns>& key : keys()) out += (b.*key.value - a.*key.value) / key.range() * key.row;
  return out;
}

std::optional<Balance> BalanceBranchSolver::balance_of(const BalanceBranchEvaluation& at) const {
  Balance out = at.own->problem.series_of(at.balance, first_.order);
  out.converged = true;
  out.family = first_.family && at.own->problem.leaves_means_open(at.balance);
  return out;
}

PeriodicOrbit BalanceBranchSolver::describe(const BalanceBranchEvaluation& at) const {
  return in_terms_of_an_orbit(at.own->system, *balance_of(at), options_.shooting.marginal_band,
                              options_.shooting.symmetry_tolerance);
}

Eigen::VectorXd BalanceBranchSolver::skew(const BalanceBranchEvaluation& at) const {
  if (symmetric_ || !is_symmetric(at.own->system) || first_.order % 2 == 0) return {};
  return picked(at.at.x, even_) / size_;
}

BalanceBranchSolver::Simpler BalanceBranchSolver::simpler_beside(SpecialKind /*kind*/,
                                                                 const BalanceBranchEvaluation& near,
                                                                 const PeriodicOrbit& /*orbit*/,
                                                                 const Eigen::VectorXd& /*apart*/) const {
  BalanceBranchSolver solver(family_, *balance_of(near), near.at.parameter, near.at.other, options_, true,
                             std::nullopt);
  BalanceUnknowns guess = near.at;
  solver.clear_even(guess.x);
  return {std::move(solver), std::move(guess)};
}

Eigen::VectorXd BalanceBranchSolver::parameter_row() const {
  const Eigen::Index size = std::ssize(solved_) + (on_curve() ? 2 : 1);
  return Eigen::VectorXd::Unit(size, size - 1);
}

std::vector<BranchKey<BalanceUnknowns>> BalanceBranchSolver::keys() const {
  return branch_keys<BalanceUnknowns>(options_, condition_, parameter_row());
}

}  // namespace slipmode::orbits
