// How branches end, and where they turn back with their word: against closed forms and an independent program.
#include "fixtures/scenes.hpp"
#include "special_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::State;

TEST(Continuation, OrbitsOfTwiceThePeriodEndWhereThePeriodDoublesAgain) {
  // Between unlike stops the period doubles twice, and orbits of twice the period lead from one point to the other: no
  // further, where they would be the same ones with their two periods exchanged.
  const friction::Clearance stops{friction::Stop{.stiffness = 1e6, .gap = 4e-6},
                                  friction::Stop{.stiffness = 2e6, .gap = 6e-6}, friction::ContactLoss::kGap};
  const auto drive = [](double omega) { return friction::Force{omega, {{.amplitude = 2.0}}}; };
  const HybridSystem base{fem::masses({.mass = {5e-3}, .links = {{.stiffness = 2e5, .damping = 1.5}}}),
                          {{Eigen::VectorXd::Ones(1), stops}},
                          drive(8400.0),
                          {},
                          Eigen::MatrixXd::Ones(1, 1)};
  const dynamics::SystemFamily family = [&](double omega) { return base.with_drive(drive(omega)); };
  const ContinuationOptions options{.from = 7500.0, .to = 9000.0, .both_ways = true};
  const Branch single = continue_orbit(family, settled(base, 0.0), 8400.0, options);
  const std::vector<SpecialPoint> doublings = of_kind(single, SpecialKind::kPeriodDoubling);
  ASSERT_EQ(doublings.size(), 2u) << single.reason;
  for (const std::size_t from : {0u, 1u}) {
    const BranchPoint first = switch_branch(family, doublings[from], options).at(0);
    const Branch doubled = continue_orbit(family, first.orbit, first.parameter,
                                          {.from = 7500.0,
                                           .to = 9000.0,
                                           .direction = first.parameter > doublings[from].parameter ? 1 : -1,
                                           .shooting = {.order = 2}});
    EXPECT_EQ(doubled.end, BranchEnd::kMerged) << doubled.reason;
    ASSERT_FALSE(doubled.special.empty());
    const SpecialPoint& last = doubled.special.back();
    EXPECT_EQ(last.kind, SpecialKind::kPeriodDoubling);
    EXPECT_NEAR(last.parameter, doublings[1 - from].parameter, 1e-7);
    EXPECT_EQ(last.orbit.order, 1);
    EXPECT_EQ(of_kind(doubled, SpecialKind::kPeriodDoubling).size(), 1u);
    for (const SpecialPoint& fold : of_kind(doubled, SpecialKind::kFold))
      EXPECT_NEAR(std::abs(fold.multiplier), 1.0, 1e-3);
  }
}

/// The belt speed at which the free swing after a release just reaches the belt's speed again: an oscillator about the
/// steady position, released at u = (F_s − F_k − cV)/k with speed V; its next greatest speed is V.
double last_stick_slip_speed(double c, double drop) {
  const auto excess = [&](double V) {
    const double half = c / 2, w = std::sqrt(1.0 - half * half);
    // Slip force F_k: u″ + c u′ + u = 0 with u measured from F_k. Release: u + c V = drop.
    const double u = drop - c * V, b = (V + half * u) / w;
    const auto speed = [&](double t) {
      const double e = std::exp(-half * t);
      return e * ((b * w - half * u) * std::cos(w * t) - (u * w + half * b) * std::sin(w * t));
    };
    double best = -1e9;
    for (int k = 0; k <= 4000; ++k) best = std::max(best, speed(3.0 + 6.0 * k / 4000.0));
    double at = 3.0;
    for (int k = 0; k <= 4000; ++k)
      if (speed(3.0 + 6.0 * k / 4000.0) == best) at = 3.0 + 6.0 * k / 4000.0;
    for (double h = 1e-3; h > 1e-12; h *= 0.5) {
      if (speed(at + h) > speed(at)) at += h;
      if (speed(at - h) > speed(at)) at -= h;
    }
    return speed(at) - V;
  };
  double low = 0.01, high = 5.0;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

TEST(Continuation, AStickSlipCycleEndsWhereItNoLongerSticks) {
  const double c = 0.1;
  const auto system_at = [&](double speed) {
    return fixtures::oscillator(1.0, 1.0, c, friction::Coulomb{0.4, 0.2}, 1.0, friction::Belt::constant(speed));
  };
  const RecurrenceGuess guess = recurrence_guess(
      system_at(0.1), fixtures::state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.1)), 50.0, 100.0);
  const PeriodicOrbit orbit = find_orbit(system_at(0.1), guess.state, {.period = guess.period});
  const Branch branch = continue_orbit(system_at, orbit, 0.1, {.from = 0.05, .to = 2.0});
  EXPECT_EQ(branch.end, BranchEnd::kLost);
  EXPECT_THAT(branch.reason, testing::HasSubstr("the motion jumps there"));
  EXPECT_GT(branch.points.size(), 10u);
  EXPECT_NEAR(branch.points.back().parameter, last_stick_slip_speed(c, 0.2), 1e-6);
}

/// Unit mass, spring and load on a belt, μ = 0.2 + 0.2 e^{−8v}.
dynamics::SystemFamily stribeck_oscillator(double c) {
  return [c](double speed) {
    return fixtures::oscillator(1.0, 1.0, c, friction::Stribeck{0.4, 0.2, 8.0}, 1.0, friction::Belt::constant(speed));
  };
}

void expect_turn_and_hopf_point(const Branch& branch, double turn, double hopf) {
  EXPECT_TRUE(is_complete(branch.end)) << branch.reason;
  ASSERT_EQ(branch.special.size(), 2u) << branch.reason;
  for (const SpecialPoint& point : branch.special) {
    const bool turns = point.kind == SpecialKind::kNonSmoothFold;
    EXPECT_TRUE(turns || point.kind == SpecialKind::kHopf) << to_string(point.kind);
    EXPECT_NEAR(point.parameter, turns ? turn : hopf, turns ? point.uncertainty : 1e-11) << to_string(point.kind);
    EXPECT_LT(point.uncertainty, 1e-7);
  }
  const auto [least, most] = std::ranges::minmax(branch.points, {}, &BranchPoint::parameter);
  EXPECT_NEAR(most.parameter, turn, 1e-4);
}

TEST(Continuation, AStickSlipCycleTurnsBackToTheHopfPointOfSteadySliding) {
  // Sliding steadily, the slope of the friction undoes the damping: 1.6 e^{−8V} = c. The speed at which the slip just
  // reaches the belt again where it left it: DOP853 at 1e-13 from the place of release.
  const double turns[] = {0.6439495365660765, 1.4899227575794374}, dampings[] = {0.1, 0.03};
  for (int k = 0; k < 2; ++k) {
    const dynamics::SystemFamily family = stribeck_oscillator(dampings[k]);
    const double hopf = std::log(1.6 / dampings[k]) / 8.0;
    const RecurrenceGuess guess = recurrence_guess(
        family(0.1), fixtures::state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.1)), 50.0, 100.0);
    const PeriodicOrbit stick_slip = find_orbit(family(0.1), guess.state, {.period = guess.period});
    const ContinuationOptions options{.from = 0.05, .to = 3.0, .both_ways = true};
    const Branch branch = continue_orbit(family, stick_slip, 0.1, options);
    expect_turn_and_hopf_point(branch, turns[k], hopf);
    EXPECT_NEAR(branch.points.front().parameter, 0.05, 1e-12);
    EXPECT_NEAR(branch.points.back().parameter, hopf, 1e-6);
    // From the other side of an unstable cycle between.
    const BranchPoint& between = branch.points[branch.points.size() - branch.points.size() / 8];
    ASSERT_EQ(between.orbit.crossings, 0);
    const HybridSystem there = family(between.parameter);
    const State half = advanced(there, between.orbit.start, 0.5 * between.orbit.period);
    const PeriodicOrbit orbit = find_orbit(there, half, {.period = between.orbit.period});
    expect_turn_and_hopf_point(continue_orbit(family, orbit, between.parameter, options), turns[k], hopf);
  }
}

}  // namespace
}  // namespace slipmode::orbits
