// Orbits of contacts behind springs (Jenkins elements), whose modes are not told by displacements and velocities.
#include <slipmode/fem/chain.hpp>
#include <slipmode/orbits/continuation.hpp>

#include <gtest/gtest.h>
#include <string>

namespace slipmode::orbits {
namespace {

using dynamics::ContactMode;
using dynamics::HybridSystem;

/// datasets/jenkins_chain: at the force's own phase both contacts slide.
HybridSystem sliding_chain(double omega) {
  const auto contact = [](Eigen::Index at, double limit, double stiffness) {
    return friction::Contact{Eigen::VectorXd::Unit(10, at), friction::CompliantCoulomb{limit, limit, stiffness}, 1.0};
  };
  return {fem::chain({.masses = 10, .damping = 0.02}),
          {contact(4, 0.3, 1.0), contact(9, 0.2, 0.5)},
          friction::Force{omega, {{.amplitude = 0.4}}},
          {},
          Eigen::MatrixXd(Eigen::VectorXd::Unit(10, 9))};
}

// Half a period on, what slides up slides down.
TEST(CompliantOrbits, HalfPeriodsFindTheOrbitOfWholeOnesWhereBothContactsSlideAtTheOrigin) {
  const HybridSystem system = sliding_chain(0.3);
  const dynamics::State guess = settle_guess(system, system.rest(), 30.0);
  const PeriodicOrbit whole = find_orbit(system, guess), half = find_orbit(system, guess, {.half_period = true});
  EXPECT_TRUE(whole.symmetric);
  EXPECT_EQ(whole.start.modes, std::vector<ContactMode>(2, ContactMode::kSlipPositive));
  EXPECT_EQ(half.word, whole.word);
  EXPECT_EQ(half.crossings, whole.crossings);
  EXPECT_EQ(half.events.size(), whole.events.size());
  EXPECT_LT((stacked(half.start) - stacked(whole.start)).cwiseAbs().maxCoeff(), 1e-9);
}

// Symmetric orbits are followed by half periods.
TEST(CompliantOrbits, AreFollowedFromWhereBothContactsSlide) {
  const PeriodicOrbit first =
      find_orbit(sliding_chain(0.3), settle_guess(sliding_chain(0.3), sliding_chain(0.3).rest(), 30.0));
  const Branch branch = continue_orbit(sliding_chain, first, 0.3, {.from = 0.3, .to = 0.31});
  EXPECT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  const BranchPoint& last = branch.points.back();
  const PeriodicOrbit there = find_orbit(sliding_chain(last.parameter), last.orbit.start);
  EXPECT_LT((stacked(there.start) - stacked(last.orbit.start)).cwiseAbs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace slipmode::orbits
