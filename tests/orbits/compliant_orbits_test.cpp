// Orbits of contacts behind springs (Jenkins elements), whose modes are not told by displacements and velocities.
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/friction/iwan.hpp>
#include <slipmode/orbits/branches/continuation.hpp>

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
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

/// Two blocks and a joint of seven elements between them. Without `hold` nothing else holds the second.
dynamics::SystemFamily joint(double hold, double load) {
  return [=](double omega) {
    const Eigen::Matrix2d link{{1.0, -1.0}, {-1.0, 1.0}}, ground{{1.0, 0.0}, {0.0, 0.0}};
    std::vector<friction::Contact> contacts;
    const friction::Iwan whole{
        .slip_force = 0.4, .stiffness = 1.5, .chi = -0.5, .beta = 0.3, .elements = 6, .finest = 0.1};
    for (const friction::JenkinsElement& own : friction::elements_of(whole))
      contacts.push_back(
          {Eigen::Vector2d(-1.0, 1.0), friction::CompliantCoulomb{1.0, 1.0, own.stiffness}, own.slip_force});
    return HybridSystem(fem::Structure(Eigen::Vector2d(1.0, 0.5).asDiagonal().toDenseMatrix(),
                                       0.02 * Eigen::Matrix2d(ground + hold * link), ground + hold * link),
                        std::move(contacts), friction::Force{omega, {{.amplitude = 0.04}}}, Eigen::Vector2d(0.0, load),
                        Eigen::MatrixXd(Eigen::Vector2d(0.0, 1.0)));
  };
}

/// Three blocks; a joint of `elements` and one more between the first two, the force at the third.
dynamics::SystemFamily three_blocks(int elements, double finest) {
  return [=](double hertz) {
    Eigen::Matrix3d K, C;
    K << 5e5, 0.0, 0.0, 0.0, 2e5, -2e5, 0.0, -2e5, 2e5;
    C << 40.0, 0.0, 0.0, 0.0, 8.0, -8.0, 0.0, -8.0, 8.0;
    const friction::Iwan whole{
        .slip_force = 300.0, .stiffness = 2e6, .chi = -0.5, .beta = 0.6, .elements = elements, .finest = finest};
    std::vector<friction::Contact> contacts;
    for (const friction::JenkinsElement& own : friction::elements_of(whole))
      contacts.push_back(
          {Eigen::Vector3d(-1.0, 1.0, 0.0), friction::CompliantCoulomb{1.0, 1.0, own.stiffness}, own.slip_force});
    return HybridSystem(fem::Structure(Eigen::Vector3d(4.0, 2.0, 1.0).asDiagonal().toDenseMatrix(), C, K),
                        std::move(contacts), friction::Force{2.0 * std::numbers::pi * hertz, {{.amplitude = 60.0}}},
                        Eigen::VectorXd{}, Eigen::MatrixXd(Eigen::Vector3d::Unit(2)));
  };
}

// All elements slide, then the joint turns a second time within each half period: its elements turn, and slide on
// again, at one instant, of which rounding makes several. On the way a whole joint of 13 is met just as it turns.
TEST(CompliantOrbits, AreFollowedPastASecondTurnOfTheWholeJoint) {
  struct Case {
    int elements;
    double finest, from, to;
    std::vector<int> crossings;  // of each contact twice a period for every turn, and again for what slides on
  };
  for (const Case& own : {Case{4, 0.05, 38.0, 42.0, {20, 32, 20, 16}}, Case{12, 0.01, 39.2, 39.5, {52, 96}}}) {
    const dynamics::SystemFamily family = three_blocks(own.elements, own.finest);
    const HybridSystem system = family(own.from);
    const PeriodicOrbit first = find_orbit(system, settle_guess(system, system.rest(), 200.0), {.half_period = true});
    const Branch branch =
        continue_orbit(family, first, own.from, {.from = own.from, .to = own.to, .shooting = {.half_period = true}});
    EXPECT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
    std::vector<int> crossings;
    for (const BranchPoint& point : branch.points)
      if (crossings.empty() || crossings.back() != point.orbit.crossings) crossings.push_back(point.orbit.crossings);
    EXPECT_EQ(crossings, own.crossings);
    EXPECT_EQ(branch.special.size() + 1, own.crossings.size());
  }
}

struct Range {
  double half = 0.0, middle = 0.0;
};
/// Of every contact's displacement, and of every spring's force, over the orbit.
std::vector<Range> ranges(const HybridSystem& system, const PeriodicOrbit& orbit, bool of_force) {
  const dynamics::Trajectory run =
      dynamics::simulate(system, orbit.start, {.duration = orbit.period, .sample = orbit.period / 2000.0});
  const Eigen::MatrixXd& values = of_force ? run.lambda : run.contact_q;
  std::vector<Range> out;
  for (Eigen::Index c = 0; c < values.rows(); ++c) {
    const double most = values.row(c).maxCoeff(), least = values.row(c).minCoeff();
    out.push_back({0.5 * (most - least), 0.5 * (most + least)});
  }
  return out;
}

class JointOrbits : public testing::TestWithParam<std::pair<double, double>> {};

// Elements that never slide hold any mean: each orbit is one of a family, which ends where one of them reaches a limit.
// Below the resonance most hold, in it all slide, above it they hold again.
TEST_P(JointOrbits, AreFollowedThroughTheResonance) {
  const dynamics::SystemFamily family = joint(GetParam().first, GetParam().second);
  const HybridSystem system = family(0.6);
  const PeriodicOrbit first = find_orbit(system, settle_guess(system, system.rest(), 60.0));
  ASSERT_GT(first.family.cols(), 1);
  const Branch branch = continue_orbit(family, first, 0.6, {.from = 0.6, .to = 1.1});
  EXPECT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  std::ptrdiff_t most_held = 0, least_held = 7;
  for (const BranchPoint& point : branch.points) {
    const std::vector<Range> forces = ranges(family(point.parameter), point.orbit, true);
    std::ptrdiff_t held = 0;
    for (int c = 0; c < std::ssize(forces); ++c) {
      if (std::ranges::any_of(point.orbit.events, [&](const auto& e) { return e.contact == c; })) continue;
      ++held;
      const Range& force = forces[static_cast<std::size_t>(c)];
      EXPECT_LT(std::abs(force.middle), 1e-3 * force.half) << point.parameter << ", element " << c;
    }
    most_held = std::max(most_held, held);
    least_held = std::min(least_held, held);
  }
  EXPECT_GE(most_held, 6);
  EXPECT_LE(least_held, 2);
  // Beside orbits found from rest at their own frequency: other members of the family, with the same motion. Samples
  // miss the ends of a range by up to (π/2000)²/2 of it.
  for (const std::size_t k : {branch.points.size() / 4, branch.points.size() / 2, branch.points.size() - 2}) {
    const HybridSystem there = family(branch.points[k].parameter);
    const PeriodicOrbit own = find_orbit(there, settle_guess(there, there.rest(), 200.0));
    EXPECT_NEAR(own.leading_modulus, branch.points[k].orbit.leading_modulus, 1e-8) << branch.points[k].parameter;
    const double half = ranges(there, own, false)[0].half;
    EXPECT_NEAR(half, ranges(there, branch.points[k].orbit, false)[0].half, 2.5e-6 * half);
  }
}

std::string joint_name(const testing::TestParamInfo<std::pair<double, double>>& info) {
  return info.param.second > 0.0 ? "Loaded" : info.param.first > 0.0 ? "Held" : "Free";
}

INSTANTIATE_TEST_SUITE_P(All, JointOrbits,
                         testing::Values(std::pair{0.0, 0.0}, std::pair{0.5, 0.0}, std::pair{0.5, 0.05}), joint_name);

}  // namespace
}  // namespace slipmode::orbits
