#include <slipmode/orbits/strobe_map.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/gap_motion.hpp>
#include <slipmode/orbits/orbit_map.hpp>
#include "fixtures/clearance_scenes.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/shaken_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

const auto kFromRest = [](const dynamics::HybridSystem& system) { return system.rest(); };

StrobeOptions watching(Eigen::Index n) {
  StrobeOptions options;
  options.rows = Eigen::MatrixXd::Identity(n, n);
  return options;
}

/// One damped oscillator under two harmonics, no contact.
dynamics::HybridSystem two_harmonics(double first, double third) {
  return {fem::chain({.masses = 1, .damping = 0.3}),
          {},
          friction::Force{.omega = 0.6, .harmonics = {{.amplitude = first}, {.amplitude = third, .order = 3}}},
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

/// Complex amplitude of its displacement at ω: 1/(1 − ω² + 0.3 iω).
std::complex<double> transfer(double omega) { return 1.0 / std::complex<double>(1.0 - omega * omega, 0.3 * omega); }

// A sine of amplitude a: (max − min)/2 = a = √2 · effective.
TEST(Strobe, OfASineHasTheAmplitudeOfItsSine) {
  const auto system = two_harmonics(1.0, 0.0);
  const Strobe point = strobe(system, linear_response(system), watching(1));
  const double amplitude = std::abs(transfer(0.6));
  EXPECT_EQ(point.order, 1);
  EXPECT_NEAR(point.alternating(0), amplitude, 1e-6 * amplitude);
  EXPECT_NEAR(point.effective(0), amplitude / std::numbers::sqrt2, 1e-6 * amplitude);
  EXPECT_LT(point.sine_gap(0), 1e-6);
}

// Two harmonics of amplitudes a, b have the mean square (a² + b²)/2; their extremes are taken from the closed form on a
// fine grid. Such motion is periodic, and S1's test calls it otherwise.
TEST(Strobe, OfTwoHarmonicsIsPeriodicButFailsTheTestOfS1) {
  const auto system = two_harmonics(1.0, 2.0);
  const Strobe point = strobe(system, linear_response(system), watching(1));
  const std::complex<double> first = transfer(0.6), third = 2.0 * transfer(1.8);
  double high = 0.0;
  for (int k = 0; k < 200000; ++k) {
    const double phase = 2.0 * std::numbers::pi * k / 200000.0;
    high = std::max(high, std::imag(first * std::polar(1.0, phase) + third * std::polar(1.0, 3.0 * phase)));
  }
  EXPECT_EQ(point.order, 1);
  EXPECT_NEAR(point.alternating(0), high, 2e-5);
  EXPECT_NEAR(point.effective(0), std::sqrt(0.5 * (std::norm(first) + std::norm(third))), 2e-5);
  EXPECT_GT(point.sine_gap(0), 0.1);
}

// The cubic through values and slopes at both ends of a step h misses y by h⁴/384 max |y⁗| at most.
TEST(Strobe, ExtremesAreWithinTheErrorOfCubics) {
  const auto system = two_harmonics(1.0, 2.0);
  const double omega = 0.6;
  const std::complex<double> first = transfer(omega), third = 2.0 * transfer(3.0 * omega);
  const auto alternating = [&](int samples) {
    StrobeOptions options = watching(1);
    options.samples = samples;
    return strobe(system, linear_response(system), options).alternating(0);
  };
  const double exact = alternating(4096);
  for (const int samples : {12, 24, 48}) {
    const double step = 2.0 * std::numbers::pi / omega / samples;
    const double fourth = std::pow(omega, 4) * std::abs(first) + std::pow(3.0 * omega, 4) * std::abs(third);
    EXPECT_LE(std::abs(alternating(samples) - exact), std::pow(step, 4) / 384.0 * fourth);
  }
}

// S1: no period 1 for 0.77 < η < 0.94; checked by sections: lost between 0.765 and 0.766, regained between 0.944 and
// 0.945, period 3 from rest near 1.12.
TEST(StrobeMap, FindsTheBandOfTheThreeMasses) {
  const std::vector<double> values{0.70, 0.76, 0.77, 0.82, 0.88, 0.94, 0.95, 1.0, 1.12};
  const StrobeMap map = strobe_map(fixtures::clearance_pair, kFromRest, values, watching(2));
  const std::vector<int> first_period{1, 1, 0, 0, 0, 0, 1, 1, 0};
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_EQ(map.points[k].settled.order == 1 ? 1 : 0, first_period[k]) << "eta = " << values[k];
  }
  EXPECT_EQ(map.points[8].settled.order, 3);
}

// reference: at η = 0.60 to 0.75 the motion has period 1 and alternating and effective amplitudes differ by several per
// cent: S1's test would call it non-periodic.
TEST(StrobeMap, ShowsWhereTheTestOfS1Fails) {
  const StrobeMap map = strobe_map(fixtures::clearance_pair, kFromRest, {0.60, 0.65, 0.70, 0.75}, watching(2));
  for (const auto& point : map.points) {
    EXPECT_EQ(point.settled.order, 1);
    EXPECT_GT(std::max(point.settled.sine_gap(0), point.settled.sine_gap(1)), 0.02);
  }
}

// S0 Figure 4.7 and reference: period 1 at 0.65, none between 0.42 and 0.54, where periods 3 and 5 are.
TEST(StrobeMap, IsTheBifurcationDiagramOfTheSingleMass) {
  const StrobeMap map =
      strobe_map([](double omega) { return fixtures::backlash_mass(omega); },
                 [](const dynamics::HybridSystem&) {
                   return fixtures::state(Eigen::VectorXd::Constant(1, 3.0), Eigen::VectorXd::Zero(1));
                 },
                 {0.47, 0.49, 0.65}, watching(1));
  EXPECT_EQ(map.points[0].settled.order, 3);
  EXPECT_EQ(map.points[1].settled.order, 5);
  EXPECT_EQ(map.points[2].settled.order, 1);
  EXPECT_EQ(map.points[2].settled.section.cols(), 100);
}

/// S0's single mass where it has period 3, its coordinate counted from far away.
dynamics::HybridSystem far_backlash(double shift) {
  const auto near = fixtures::backlash_mass(0.47);
  std::vector<friction::Contact> contacts = near.contacts();
  contacts.front().offset = -shift;
  return {near.structure(), contacts, near.drive(), {}, near.force_directions()};
}

// Where the coordinate is counted from changes nothing: neither the order nor what the map finds.
TEST(StrobeMap, SubharmonicsAreSeenBesideALargeMean) {
  constexpr double kShift = 1e6;
  const auto start = fixtures::state(Eigen::VectorXd::Constant(1, kShift + 3.0), Eigen::VectorXd::Zero(1));
  const auto system = far_backlash(kShift);
  EXPECT_EQ(strobe(system, start, watching(1)).order, 3);
  const MapPoint settled = settled_orbit(system, start, {.max_order = 6});
  EXPECT_EQ(settled.order, 3);
}

// The same mass beside one that swings a million times as far, once per period of the force.
TEST(StrobeMap, SubharmonicsAreSeenBesideALargerMotion) {
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(2, 2);
  std::vector<friction::Contact> contacts = fixtures::backlash_mass(0.47).contacts();
  contacts.front().direction = Eigen::Vector2d::UnitX();
  const friction::Force force{0.47, {{.amplitude = 1.0}, {.amplitude = 1e6, .direction = 1}}};
  const dynamics::HybridSystem system(
      fem::Structure(fem::Matrix(unit), fem::Matrix(Eigen::MatrixXd(Eigen::Vector2d(0.05, 0.5).asDiagonal())),
                     fem::Matrix(Eigen::MatrixXd(Eigen::Vector2d(0.0, 1.0).asDiagonal()))),
      contacts, force, {}, unit);
  EXPECT_EQ(strobe(system, fixtures::state(Eigen::Vector2d(3.0, 0.0), Eigen::Vector2d::Zero()), watching(2)).order, 3);
}

// Two runs of 40 periods that follow each other are one of 80.
TEST(StrobeMap, FollowingValuesStartWhereTheOneBeforeEnded) {
  StrobeOptions options = watching(2);
  options.periods = 40;
  options.kept = 10;
  options.follow = true;
  const StrobeMap map = strobe_map(fixtures::clearance_pair, kFromRest, {0.6, 0.6}, options);
  options.periods = 80;
  const auto system = fixtures::clearance_pair(0.6);
  const Strobe longer = strobe(system, system.rest(), options);
  EXPECT_LT((map.points[1].settled.section - longer.section).cwiseAbs().maxCoeff(), 1e-9);
}

// The same for a contact with states of its own: its spring's stretch, its oscillator's displacement and velocity.
TEST(StrobeMap, FollowingValuesKeepTheContactsOwnStates) {
  const friction::NormalOscillator own{
      .mass = 0.5, .support_stiffness = 1.0, .spring_stiffness = 2.0, .spring_damping = 0.01, .slope = 0.4};
  const auto system = fixtures::single_mass(
      1.0, 0.05, 1.0, {.direction = {}, .law = friction::CompliantCoulomb{0.4, 0.3, 8.0}, .normal_load = {1.0, own}},
      friction::Shaker{.amplitude = 0.9, .frequency_hz = 0.7 / (2.0 * std::numbers::pi)});
  const auto same = [&](double) { return system; };
  StrobeOptions options = watching(1);
  options.periods = 7;
  options.kept = 5;
  options.follow = true;
  const StrobeMap map = strobe_map(same, kFromRest, {0.0, 0.0}, options);
  options.periods = 14;
  const Strobe longer = strobe(system, system.rest(), options);
  const double reach = longer.section.cwiseAbs().maxCoeff();
  EXPECT_LT((map.points[1].settled.section - longer.section).cwiseAbs().maxCoeff(), 1e-9 * reach);
}

// Random contacts, rigid or behind a spring, under random loads; and the next value may have any amplitude.
TEST(StrobeMap, FollowsThroughAnyContact) {
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    const auto system = fixtures::random_piecewise_linear(seed);
    const friction::Shaker* shaker = system.drive().shaker();
    if (shaker == nullptr) continue;
    const auto at = [&](double amplitude) {
      friction::Shaker changed = *shaker;
      changed.amplitude = amplitude;
      return system.with_drive(changed);
    };
    StrobeOptions options = watching(system.size());
    options.periods = 3;
    options.kept = 2;
    options.follow = true;
    const StrobeMap map =
        strobe_map(at, kFromRest, {shaker->amplitude, shaker->amplitude, 0.3 * shaker->amplitude}, options);
    for (const auto& point : map.points) ASSERT_EQ(point.failure, "") << seed;
    options.periods = 6;
    const Strobe longer = strobe(system, system.rest(), options);
    const double reach = longer.section.cwiseAbs().maxCoeff();
    EXPECT_LT((map.points[1].settled.section - longer.section).cwiseAbs().maxCoeff(), 1e-7 * reach) << seed;
    ++compared;
  }
  EXPECT_GT(compared, 60);
}

TEST(StrobeMap, HasTheSameBytesForAnyNumberOfThreadsAndTakesOverWhatIsThere) {
  const std::vector<double> values{0.55, 0.82, 0.9, 1.05};
  const StrobeMap one = strobe_map(fixtures::clearance_pair, kFromRest, values, watching(2), {.threads = 1});
  std::size_t stored = 0;
  const StrobeSink sink{
      .recall = [&](std::size_t k, int) { return k == 2 ? std::optional(one.points[2]) : std::nullopt; },
      .store = [&](const StrobePoint&) { ++stored; }};
  const StrobeMap three = strobe_map(fixtures::clearance_pair, kFromRest, values, watching(2), {.threads = 3}, sink);
  EXPECT_EQ(stored, 3U);
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_EQ(one.points[k].settled.section, three.points[k].settled.section);
    EXPECT_EQ(one.points[k].settled.alternating, three.points[k].settled.alternating);
  }
}

TEST(StrobeMap, StopsWhenAsked) {
  const StopFlag stop{true};
  const StrobeMap map = strobe_map(fixtures::clearance_pair, kFromRest, {0.6}, watching(2), {.stop = &stop});
  EXPECT_TRUE(map.interrupted);
  EXPECT_TRUE(map.points.empty());
}

TEST(StrobeMap, RefusesBadInput) {
  const auto with = [](auto change) {
    StrobeOptions options = watching(2);
    change(options);
    return options;
  };
  const auto run = [](const StrobeOptions& options) {
    return strobe_map(fixtures::clearance_pair, kFromRest, {0.6}, options);
  };
  EXPECT_THROW((void)run(with([](StrobeOptions& o) { o.kept = 0; })), InvalidInput);
  EXPECT_THROW((void)run(with([](StrobeOptions& o) { o.kept = o.periods; })), InvalidInput);
  EXPECT_THROW((void)run(with([](StrobeOptions& o) { o.samples = 4; })), InvalidInput);
  EXPECT_THROW((void)run(with([](StrobeOptions& o) { o.rows = {}; })), InvalidInput);
  EXPECT_THROW((void)strobe_map(fixtures::clearance_pair, kFromRest, {}, watching(2)), InvalidInput);
  const auto belt = fixtures::belt_chain(friction::Coulomb{0.4, 0.2}, friction::Belt::constant(0.2), 2);
  EXPECT_THROW((void)strobe(belt, belt.rest(), watching(2)), InvalidInput);
  const Strobe point = run(watching(2)).points[0].settled;
  EXPECT_THROW((void)point.sine_gap(2), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
