// Orbits on Dahl's and the LuGre law: multipliers against differences of the simulated map and against the growth of
// small perturbations; a special point found without tangents.
#include <slipmode/core/decompositions.hpp>
#include <slipmode/orbits/branches/continuation.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::State;
using friction::Dahl;
using friction::LuGre;

HybridSystem mass_on(const friction::Law& law, const friction::Drive& drive) {
  return fixtures::oscillator(1.0, 1.0, 0.02, law, 1.0, drive);
}

const LuGre kLaw{0.4, 0.2, 0.3, 60.0, 1.0, 0.02};
HybridSystem on_belt(double speed) { return mass_on(kLaw, friction::Belt::constant(speed)); }

PeriodicOrbit belt_orbit(double speed) {
  const HybridSystem system = on_belt(speed);
  State start = fixtures::state(Eigen::VectorXd::Constant(1, 1.5), Eigen::VectorXd::Constant(1, speed));
  start.internal = Eigen::VectorXd::Zero(1);
  const RecurrenceGuess guess = recurrence_guess(system, start, 300.0, 60.0);
  return find_orbit(system, guess.state, {.period = guess.period});
}

/// d x(T)/d x(0) by central differences of order 4 of simulated motions, no tangents. The flow's 1e-12 leaves 1e-7.
Eigen::MatrixXd map_by_differences(const HybridSystem& system, const PeriodicOrbit& orbit) {
  const auto end_of = [&](State from) {
    from.modes.clear();
    return stacked(advanced(system, from, orbit.period));
  };
  return fixtures::slopes(orbit.start, end_of, 1e-5);
}

void expect_multipliers_by_differences(const HybridSystem& system, const PeriodicOrbit& orbit) {
  const Eigen::MatrixXd expected = map_by_differences(system, orbit);
  EXPECT_LT((orbit.monodromy - expected).cwiseAbs().maxCoeff(), 2e-6 * expected.cwiseAbs().maxCoeff());
  const Eigen::VectorXcd multipliers = sorted_eigenvalues(expected);
  for (Eigen::Index i = 0; i < multipliers.size(); ++i)
    EXPECT_LT((orbit.multipliers.array() - multipliers[i]).abs().minCoeff(), 1e-5) << i;
}

TEST(BristleOrbits, MultipliersOfAStickSlipCycleAreThoseOfTheSimulatedMap) {
  for (const double speed : {0.1, 0.3, 0.5}) {
    const PeriodicOrbit orbit = belt_orbit(speed);
    EXPECT_LT(orbit.residual, 1e-11);
    ASSERT_EQ(orbit.multipliers.size(), 3);
    EXPECT_EQ(orbit.trivial_multipliers, 1);
    EXPECT_LT((orbit.multipliers.array() - 1.0).abs().minCoeff(), 1e-9);  // along the motion
    EXPECT_EQ(orbit.stability, Stability::kStable);
    expect_multipliers_by_differences(on_belt(speed), orbit);
  }
}

TEST(BristleOrbits, SmallPerturbationsGrowByTheMultiplier) {
  const HybridSystem system = on_belt(0.1);
  const PeriodicOrbit orbit = belt_orbit(0.1);
  // Measured by the left eigenvector: a phase shift, of second order in the perturbation, stays for ever.
  const Eigen::EigenSolver<Eigen::MatrixXd> right(orbit.monodromy), left(Eigen::MatrixXd(orbit.monodromy.transpose()));
  Eigen::Index at = 0, across = 0;
  right.eigenvalues().real().minCoeff(&at);
  left.eigenvalues().real().minCoeff(&across);
  const double multiplier = right.eigenvalues()[at].real();
  EXPECT_LT(multiplier, -0.5);
  const Eigen::VectorXd x = stacked(orbit.start), gauge = left.eigenvectors().col(across).real();
  State state = with_coordinates(orbit.start, x + 1e-5 * right.eigenvectors().col(at).real());
  double before = gauge.dot(stacked(state) - x);
  state.modes.clear();
  for (int period = 0; period < 5; ++period) {
    state = advanced(system, state, orbit.period);
    const double after = gauge.dot(stacked(state) - x);
    EXPECT_NEAR(after / before, multiplier, 2e-3) << period;  // 1e-5 times the map's curvature
    before = after;
  }
}

TEST(BristleOrbits, DrivenOrbitsAndTheirHalfPeriods) {
  for (const friction::Law& law : {friction::Law(kLaw), friction::Law(Dahl{0.3, 20.0})}) {
    for (const double frequency : {0.1, 0.2}) {
      const HybridSystem system = mass_on(law, friction::Shaker{.amplitude = 1.0, .frequency_hz = frequency});
      const State guess = settle_guess(system, system.rest(), 20.0);
      const PeriodicOrbit orbit = find_orbit(system, guess), half = find_orbit(system, guess, {.half_period = true});
      EXPECT_TRUE(orbit.symmetric);
      EXPECT_EQ(orbit.trivial_multipliers, 0);
      expect_multipliers_by_differences(system, orbit);
      EXPECT_LT((stacked(half.start) - stacked(orbit.start)).cwiseAbs().maxCoeff(), 1e-9);
      for (Eigen::Index i = 0; i < 2; ++i)
        EXPECT_LT((half.half_multipliers.array().square() - orbit.multipliers[i]).abs().minCoeff(), 1e-8);
    }
  }
}

TEST(BristleOrbits, PeriodDoublesWhereTheDifferencedMapSaysSo) {
  const PeriodicOrbit first = belt_orbit(0.1);
  const ContinuationOptions options{.from = 0.0985, .to = 0.1, .direction = -1};
  const Branch branch = continue_orbit(on_belt, first, 0.1, options);
  const auto doubling = std::ranges::find(branch.special, SpecialKind::kPeriodDoubling, &SpecialPoint::kind);
  ASSERT_NE(doubling, branch.special.end());
  // −1 by the secant of the smallest eigenvalue of differenced maps a little to both sides.
  const auto smallest = [&](double speed) {
    const PeriodicOrbit orbit = find_orbit(on_belt(speed), doubling->orbit.start, {.period = doubling->orbit.period});
    return sorted_eigenvalues(map_by_differences(on_belt(speed), orbit)).real().minCoeff();
  };
  const double reach = 1e-5, low = smallest(doubling->parameter - reach), high = smallest(doubling->parameter + reach);
  EXPECT_LT(low, -1.0);
  EXPECT_GT(high, -1.0);
  EXPECT_NEAR(doubling->parameter - reach + 2.0 * reach * (-1.0 - low) / (high - low), doubling->parameter, 2e-8);

  const std::vector<BranchPoint> twice = switch_branch(on_belt, *doubling, options);
  ASSERT_FALSE(twice.empty());
  const PeriodicOrbit& doubled = twice.front().orbit;
  EXPECT_NEAR(doubled.period, 2.0 * doubling->orbit.period, 1e-3 * doubled.period);
  const HybridSystem there = on_belt(twice.front().parameter);
  const Eigen::VectorXd start = stacked(doubled.start);
  EXPECT_LT((stacked(advanced(there, doubled.start, doubled.period)) - start).norm(), 1e-8);
  EXPECT_GT((stacked(advanced(there, doubled.start, 0.5 * doubled.period)) - start).norm(), 1e-4);
}

}  // namespace
}  // namespace slipmode::orbits
