// Where self-excited orbits begin: a state of rest of which a complex pair of rates crosses the imaginary axis.
#include <slipmode/core/errors.hpp>
#include "orbits/branches/internal/branch_solver.hpp"
#include "orbits/branches/internal/secant.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace slipmode::orbits {
namespace {

constexpr int kMaxSteps = 30;

/// The state of rest near `state` and its map over a time, by Newton down to rounding: what speed is left tells in the
/// slopes of laws. Regular where no multiplier of that time is 1.
std::optional<Eigen::MatrixXd> map_at_rest(ShootingProblem& problem, dynamics::State& state, double time,
                                           double tolerance) {
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kMaxSteps; ++k) {
    const ShootingEvaluation here = problem.evaluate({{state}, time});
    if (!here.events.empty()) return std::nullopt;
    if (here.largest <= tolerance && here.largest > 0.3 * last) return here.transfer[0];
    last = here.largest;
    const Eigen::Index n = here.mismatch[0].size();
    const Eigen::VectorXd step = (Eigen::MatrixXd::Identity(n, n) - here.transfer[0]).lu().solve(here.mismatch[0]);
    state = with_coordinates(state, stacked(state) + problem.scale().cwiseProduct(step));
  }
  return std::nullopt;
}

}  // namespace

std::optional<BranchSolver::HopfPoint> BranchSolver::hopf_beside(const BranchEvaluation& near) const {
  // Over a part of the orbit's period the critical pair of multipliers is near a root of 1, and the rest is regular.
  constexpr double kParts = 16.0;
  const double time = near.at.point.period / kParts;
  const std::complex<double> turned = std::polar(1.0, 2.0 * std::numbers::pi / kParts);
  ShootingOptions options = options_.shooting;
  options.segments = 1;
  options.half_period = false;
  dynamics::State rest = near.at.point.nodes[0];
  std::complex<double> critical;
  const auto growth_at = [&](double parameter) -> std::optional<double> {
    BranchUnknowns at = near.at;
    at.parameter = parameter;
    if (!in_range(at)) return std::nullopt;
    ShootingProblem problem(system_at(at), options, kind_);
    problem.use_scale(scale_);
    const auto map = map_at_rest(problem, rest, time, options.tolerance);
    if (!map) return std::nullopt;
    critical = 1.0;
    for (const std::complex<double>& mu : map->eigenvalues())
      if (std::abs(mu - turned) < std::abs(critical - turned)) critical = mu;
    return std::log(std::abs(critical));
  };
  const double start = near.at.parameter, inward = start < 0.5 * (options_.from + options_.to) ? 1e-4 : -1e-4;
  try {
    const auto root = secant_root(growth_at, start, start + inward * range_, 1e-12 * range_, range_);
    if (root) return HopfPoint{*root, 2.0 * std::numbers::pi * time / std::arg(critical)};
  } catch (const NumericalFailure&) {
    return std::nullopt;  // the flow leaves the rest
  }
  return std::nullopt;
}

}  // namespace slipmode::orbits
