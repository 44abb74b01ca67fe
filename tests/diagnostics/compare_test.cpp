#include <slipmode/diagnostics/validation/compare.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

fem::Structure oscillator(double M, double K) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  return {Eigen::MatrixXd(M * one), Eigen::MatrixXd(0.0 * one), Eigen::MatrixXd(K * one)};
}

Record record(const std::vector<double>& q, const std::vector<double>& v) {
  const auto T = static_cast<Eigen::Index>(q.size());
  return {.q = Eigen::Map<const Eigen::RowVectorXd>(q.data(), T),
          .v = Eigen::Map<const Eigen::RowVectorXd>(v.data(), T)};
}

TEST(Deviation, IsWhatAHandComputes) {
  // M = 2, K = 3. Full: q = 4, 6 (mean 5, so x = −1, 1), v = 2, 0. Reduced: q = 4, 7 (x = −1, 2), v = 1, 0.
  // ΔX: differences² 0 + 1 + 1 + 0 = 2 over 1 + 1 + 4 + 0 = 6, so 100 sqrt(1/3).
  // E = v² + 1.5 x²: full 5.5, 1.5 (mean 3.5); reduced 2.5, 6 (mean 4.25): ΔE = 100·0.75/3.5;
  // pointwise 100 sqrt((3² + 4.5²)/2)/3.5.
  const Deviation d = deviation(oscillator(2.0, 3.0), record({4.0, 6.0}, {2.0, 0.0}), record({4.0, 7.0}, {1.0, 0.0}));
  EXPECT_NEAR(d.dX, 100.0 * std::sqrt(1.0 / 3.0), 1e-12);
  EXPECT_NEAR(d.energy_full, 3.5, 1e-15);
  EXPECT_NEAR(d.energy_reduced, 4.25, 1e-15);
  EXPECT_NEAR(d.dE, 100.0 * 0.75 / 3.5, 1e-12);
  EXPECT_NEAR(d.dE_pointwise, 100.0 * std::sqrt((9.0 + 20.25) / 2.0) / 3.5, 1e-12);
}

TEST(Deviation, OfAShiftInTimeSparesTheMeanEnergyOnly) {
  // sin(t) against sin(t − δ) over whole periods, M = K = 1: ΔX = 200 sin(δ/2) %, E = ½ at every instant.
  constexpr double kDelta = 0.3;
  std::vector<double> q, v, q_late, v_late;
  for (int k = 0; k < 64; ++k) {
    const double t = 2.0 * std::numbers::pi * k / 64;
    q.push_back(std::sin(t));
    v.push_back(std::cos(t));
    q_late.push_back(std::sin(t - kDelta));
    v_late.push_back(std::cos(t - kDelta));
  }
  const Deviation d = deviation(oscillator(1.0, 1.0), record(q, v), record(q_late, v_late));
  EXPECT_NEAR(d.dX, 200.0 * std::sin(0.5 * kDelta), 1e-10);
  EXPECT_NEAR(d.dE, 0.0, 1e-10);
}

TEST(Deviation, DoesNotSeeWhereDisplacementsAreMeasuredFrom) {
  const Record full = record({4.0, 6.0, 3.0}, {2.0, 0.0, 1.0});
  const Record reduced = record({4.5, 5.0, 3.5}, {1.0, 0.5, 1.0});
  Record full_moved = full;
  Record reduced_moved = reduced;
  full_moved.q.array() += 17.0;
  reduced_moved.q.array() += 17.0;
  const Deviation a = deviation(oscillator(2.0, 3.0), full, reduced);
  const Deviation b = deviation(oscillator(2.0, 3.0), full_moved, reduced_moved);
  EXPECT_NEAR(a.dX, b.dX, 1e-11);
  EXPECT_NEAR(a.dE, b.dE, 1e-11);
}

TEST(Deviation, RefusesRecordsThatDoNotMatchOrDoNotMove) {
  const Record two = record({1.0, 2.0}, {0.0, 0.0});
  const Record three = record({1.0, 2.0, 3.0}, {0.0, 0.0, 0.0});
  const Record still = record({1.0, 1.0}, {0.0, 0.0});
  EXPECT_THROW((void)deviation(oscillator(1.0, 1.0), two, three), InvalidInput);
  EXPECT_THROW((void)deviation(oscillator(1.0, 1.0), still, two), InvalidInput);
  EXPECT_THROW((void)deviation(fem::chain({.masses = 2}), two, two), InvalidInput);
  EXPECT_THROW((void)deviation(oscillator(1.0, 1.0), {}, {}), InvalidInput);
}

TEST(SampleOrbit, GivesTheClosedFormCycleWithoutItsEnd) {
  const fixtures::BeltOscillator o;
  const Model model = belt_model(tests::system_of(o));
  const Record orbit = sample_orbit(model, o.belt, tests::released(o), o.period(), 500);
  ASSERT_EQ(orbit.q.cols(), 500);
  for (Eigen::Index k = 0; k < 500; ++k) {
    const double t = o.period() * static_cast<double>(k) / 500.0;
    EXPECT_NEAR(orbit.q(0, k), o.position(t), 1e-10);
    EXPECT_NEAR(orbit.v(0, k), o.velocity(t), 1e-10);
  }
  EXPECT_THROW((void)sample_orbit(model, o.belt, tests::released(o), 0.0, 500), InvalidInput);
}

/// All ten POMs of a short run: a reduced model equal to the full one in other coordinates.
pod::Basis all_modes(const dynamics::HybridSystem& system) {
  const dynamics::Trajectory run = dynamics::simulate(system, system.rest(), {.duration = 3000.0, .sample = 0.5});
  return pod::pod({.snapshots = run.q}).basis;
}

TEST(CompareOrbits, AlignsTheSlipsOfAnOrbitWithAnotherDescriptionOfIt) {
  const dynamics::HybridSystem system = tests::chain10(0.39);
  const Model full = belt_model(system);
  const Model reduced = reduced_belt_model(system, all_modes(tests::chain10(0.2)));
  SettleOptions settling;
  settling.period.tolerance = 1e-9;
  const Orbit a = settle_to_orbit(full.system(0.39), tests::near_period_three(), settling);
  // From the full orbit's second slip, so that the two lists of slips need not begin alike.
  const dynamics::State start = rom::restrict_state(system.structure(), *reduced.basis, a.states[1]);
  const Orbit b = settle_to_orbit(reduced.system(0.39), start, settling);
  const OrbitComparison found = compare_orbits(system.structure(), full, reduced, 0.39, a, b, 512);
  EXPECT_TRUE(found.same_period);
  EXPECT_LT(found.deviation.dX, 1e-5);
  EXPECT_LT(found.deviation.dE, 1e-5);
  EXPECT_LT(std::abs(found.T_difference), 1e-7);
  const auto aligned = static_cast<std::size_t>(found.alignment);
  EXPECT_NEAR(b.displacements[aligned], a.displacements[0], 1e-6);
}

TEST(CompareOrbits, OfDifferentPeriodsGivesNoDeviation) {
  const dynamics::HybridSystem system = tests::chain10(0.45);
  const Model model = belt_model(system);
  const OrbitComparison found =
      compare_orbits(system.structure(), model, model, 0.45, {.period = 1, .T = 45.0}, {.period = 2, .T = 90.0});
  EXPECT_FALSE(found.same_period);
  EXPECT_EQ(found.deviation.dX, 0.0);
  EXPECT_NEAR(found.T_difference, 100.0, 1e-12);
}

TEST(SharedRun, OfAllModesIsTheFullRun) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const Model full = belt_model(system);
  const Model reduced = reduced_belt_model(system, all_modes(system));
  const dynamics::State start = rom::restrict_state(system.structure(), *reduced.basis, system.rest());
  const SharedRun run = run_shared(full, reduced, 0.2, start, 100.0, 0.5);
  ASSERT_EQ(run.full.q.cols(), 201);
  const Deviation d = deviation(system.structure(), run.full, run.reduced);
  EXPECT_LT(d.dX, 1e-5);
  EXPECT_THROW((void)run_shared(full, reduced, 0.2, start, 0.0, 0.5), InvalidInput);
}

Settled with_slips(const std::vector<double>& x, Motion motion, int period) {
  Settled settled;
  settled.period = {.motion = motion, .period = period, .contact = 0};
  double time = 0.0;
  for (const double displacement : x) settled.slips.push_back({time += 1.0, 0, displacement});
  settled.mean_energy = 2.0 + static_cast<double>(x.size());
  settled.stick_fraction = 0.1 * static_cast<double>(x.size());
  return settled;
}

TEST(AttractorDistance, IsReducedMinusFull) {
  const Settled full = with_slips({1.0, 2.0}, Motion::kPeriodic, 2);
  const Settled reduced = with_slips({1.0, 2.0, 2.5, 5.0}, Motion::kPeriodic, 4);
  const AttractorDistance d = attractor_distance(full, reduced);
  // Quartile by quartile: |1 − 1|, |1 − 2|, |2 − 2.5|, |2 − 5| over 4; farthest point 5 from 2.
  EXPECT_NEAR(d.wasserstein, (0.0 + 1.0 + 0.5 + 3.0) / 4.0, 1e-14);
  EXPECT_NEAR(d.hausdorff, 3.0, 1e-14);
  EXPECT_NEAR(d.mean_energy, 2.0, 1e-14);
  EXPECT_NEAR(d.mean_energy_percent, 50.0, 1e-12);
  EXPECT_NEAR(d.stick_fraction, 0.2, 1e-14);
  const AttractorDistance none = attractor_distance(full, with_slips({}, Motion::kSliding, 0));
  EXPECT_TRUE(std::isnan(none.wasserstein));
  EXPECT_TRUE(std::isnan(none.hausdorff));
}

SweepPoint point(double parameter, const std::vector<double>& x, Motion motion, int period) {
  return {.parameter = parameter, .settled = with_slips(x, motion, period)};
}

TEST(CompareSweeps, CountsWhatAgrees) {
  const std::vector<SweepPoint> full = {point(0.5, {1.0}, Motion::kPeriodic, 1),
                                        point(0.4, {1.0, 2.0}, Motion::kPeriodic, 2),
                                        point(0.3, {3.0}, Motion::kAperiodic, 0),
                                        point(0.2, {4.0}, Motion::kAperiodic, 0), point(0.1, {}, Motion::kSticking, 0)};
  std::vector<SweepPoint> reduced = {point(0.5, {1.5}, Motion::kPeriodic, 1), point(0.4, {1.0}, Motion::kPeriodic, 1),
                                     point(0.3, {3.0}, Motion::kAperiodic, 0), point(0.2, {5.0}, Motion::kPeriodic, 1),
                                     point(0.1, {}, Motion::kSticking, 0)};
  BifurcationComparison found = compare_sweeps(full, reduced);
  EXPECT_EQ(found.values, 5u);
  EXPECT_EQ(found.failed, 0u);
  EXPECT_NEAR(found.same_motion, 4.0 / 5.0, 1e-15);
  EXPECT_NEAR(found.same_period, 3.0 / 5.0, 1e-15);
  EXPECT_NEAR(found.periodic_full, 2.0 / 5.0, 1e-15);
  EXPECT_NEAR(found.periodic_reduced, 3.0 / 5.0, 1e-15);
  // Wasserstein 0.5, 0.5, 0, 1 where both slip.
  EXPECT_NEAR(found.mean_wasserstein, 0.5, 1e-14);
  EXPECT_NEAR(found.median_wasserstein, 0.5, 1e-14);
  EXPECT_NEAR(found.mean_hausdorff, (0.5 + 1.0 + 0.0 + 1.0) / 4.0, 1e-14);

  reduced[2].failure = "no convergence";
  found = compare_sweeps(full, reduced);
  EXPECT_EQ(found.values, 4u);
  EXPECT_EQ(found.failed, 1u);
  EXPECT_NEAR(found.same_period, 2.0 / 4.0, 1e-15);

  EXPECT_EQ(found.decided, 4u);

  reduced[1].parameter = 0.41;
  EXPECT_THROW((void)compare_sweeps(full, reduced), InvalidInput);
  reduced.pop_back();
  EXPECT_THROW((void)compare_sweeps(full, reduced), InvalidInput);
}

TEST(CompareSweeps, AnUndecidedMotionAgreesWithNothing) {
  const auto with = [](std::vector<Motion> motions) {
    std::vector<SweepPoint> points;
    for (const Motion motion : motions)
      points.push_back(point(0.1 * static_cast<double>(points.size()), {1.0}, motion, 0));
    return points;
  };
  const auto full = with({Motion::kUndecided, Motion::kUndecided, Motion::kSticking, Motion::kSticking});
  BifurcationComparison found =
      compare_sweeps(full, with({Motion::kUndecided, Motion::kAperiodic, Motion::kSticking, Motion::kSliding}));
  EXPECT_EQ(found.values, 4u);
  EXPECT_EQ(found.decided, 2u);
  EXPECT_EQ(found.same_motion, 0.5);
  EXPECT_EQ(found.same_period, 0.5);
  found = compare_sweeps(full, with(std::vector<Motion>(4, Motion::kUndecided)));
  EXPECT_EQ(found.decided, 0u);
  EXPECT_TRUE(std::isnan(found.same_period)) << "no agreement, and no disagreement either";
}

}  // namespace
}  // namespace slipmode::diagnostics
