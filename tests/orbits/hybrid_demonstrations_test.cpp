// Demonstrations of programs for hybrid systems, whose modes, events and resets are written by hand: the same orbits
// from a law. The models of datasets/impact_oscillator and datasets/friction_oscillator.
#include <slipmode/fem/masses.hpp>
#include <slipmode/orbits/branches/continuation.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <gtest/gtest.h>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using std::numbers::pi;

/// COCO's demonstration "impact": k = 1, c = 0.1, d = 1, e = 0.8 under A cos ωt; the wall as a stop of this stiffness.
HybridSystem before_a_wall(double stiffness, double amplitude, double omega = 1.0) {
  const double loss = std::log(0.8), damping = -2.0 * loss * std::sqrt(stiffness) / std::hypot(pi, loss);
  return {fem::masses({.links = {{.stiffness = 1.0, .damping = 0.1}}}),
          {{Eigen::VectorXd::Ones(1),
            friction::Clearance{{}, friction::Stop{stiffness, damping, 1.0}, friction::ContactLoss::kGap}}},
          friction::Force{omega, {{.amplitude = amplitude, .phase = pi / 2.0}}},
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

TEST(HybridDemonstrations, StiffStopTendsToTheInstantaneousImpactAsTheRootOfItsStiffness) {
  // At ωt = π with impacts at once, by a program with 40 digits (mpmath: exponential between impacts, Newton's method
  // on phase 0.0759521649 and speed 1.6957329376 of arrival). COCO's demonstration starts its first segment at (−0.98,
  // −0.29) there, its second after the impact at phase 0.076 with −1.36 = −0.8 · 1.70.
  const Eigen::Vector2d at_once(-0.980955163026483, -0.290709736063716);
  const auto at_half = [](double stiffness) -> Eigen::Vector2d {
    const HybridSystem system = before_a_wall(stiffness, 1.0);
    const PeriodicOrbit orbit = find_orbit(system, settle_guess(system, system.rest(), 40.0), {.tolerance = 1e-10});
    EXPECT_EQ(orbit.word, "g r");
    EXPECT_EQ(orbit.stability, Stability::kStable);
    const dynamics::State there = advanced(system, orbit.start, 2.0 * pi - std::fmod(orbit.start.time + pi, 2.0 * pi));
    return {there.q[0], there.v[0]};
  };
  const Eigen::Vector2d soft = at_half(1e5), stiff = at_half(1e7);
  EXPECT_NEAR((soft - at_once).norm() / (stiff - at_once).norm(), 10.0, 0.3);
  EXPECT_LT(((10.0 * stiff - soft) / 9.0 - at_once).norm(), 1e-5);  // what the root's term leaves: 1/stiffness
}

TEST(HybridDemonstrations, WallIsGrazedAtTheAmplitudeOfTheLinearResponse) {
  // COCO follows this curve as a branch of grazing orbits: A = d |k − ω² + icω|, however stiff the wall is. Impacting
  // orbits may lie on either side of it.
  for (const double omega : {0.7, 1.0, 1.3}) {
    const std::complex<double> stiffness(1.0 - omega * omega, 0.1 * omega);
    const double grazing = std::abs(stiffness);
    const dynamics::SystemFamily family = [omega](double amplitude) { return before_a_wall(1e6, amplitude, omega); };
    const double from = 0.9 * grazing, to = 1.0001 * grazing;
    const std::complex<double> y = from / stiffness, rate = y * std::complex<double>(0.0, omega);
    const dynamics::State guess{.q = Eigen::VectorXd::Constant(1, y.real()),
                                .v = Eigen::VectorXd::Constant(1, rate.real())};
    const Branch branch =
        continue_orbit(family, find_orbit(family(from), guess), from, {.from = from, .to = to, .max_points = 60});
    ASSERT_FALSE(branch.special.empty()) << omega;
    const SpecialKind kind = branch.special.front().kind;
    EXPECT_TRUE(kind == SpecialKind::kGrazing || kind == SpecialKind::kNonSmoothFold) << to_string(kind);
    EXPECT_NEAR(branch.special.front().parameter, grazing, 1e-8 * grazing);
  }
}

/// The dry friction oscillator of PWSDDE-cont and COCO-pwsdde: ζ = 0.05, f_0 = 1.5, μ_s/μ_k as η.
HybridSystem on_dry_ground(double mu_s, double omega) {
  return {fem::masses({.links = {{.stiffness = 1.0, .damping = 0.1}}}),
          {{Eigen::VectorXd::Ones(1), friction::Coulomb{mu_s, 1.0}, 1.0}},
          friction::Force{omega, {{.amplitude = 1.5}}},
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

TEST(HybridDemonstrations, SticksWhereTheForceAtATurnIsTheStaticLimit) {
  // Frequencies at which the active force at the turn of Den Hartog's sliding orbit is μ_s, 40 digits (mpmath). At 1 it
  // is where one of the two fields of acceleration turns parallel to v = 0, which the demonstration calls SL.
  struct Limit {
    double mu_s, low, high;
  };
  for (const auto& [mu_s, low, high] :
       {Limit{1.0, 0.722679194438143, 1.235747152322398}, Limit{1.1, 0.748685731630634, 1.206269084207898}}) {
    const dynamics::SystemFamily family = [mu_s = mu_s](double omega) { return on_dry_ground(mu_s, omega); };
    const HybridSystem first = family(0.9);
    const PeriodicOrbit orbit = find_orbit(first, settle_guess(first, first.rest(), 40.0));
    EXPECT_EQ(orbit.word, "+ -");
    const Branch branch =
        continue_orbit(family, orbit, 0.9, {.from = 0.65, .to = 1.3, .direction = 1, .both_ways = true});
    EXPECT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
    std::vector<double> changes;
    for (const SpecialPoint& special : branch.special)
      if (special.kind == SpecialKind::kStickChange) changes.push_back(special.parameter);
    std::ranges::sort(changes);
    ASSERT_EQ(changes.size(), 2U) << mu_s;
    EXPECT_NEAR(changes.front(), low, 1e-8);
    EXPECT_NEAR(changes.back(), high, 1e-8);
  }
}

}  // namespace
}  // namespace slipmode::orbits
