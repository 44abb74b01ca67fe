#include <slipmode/orbits/skeleton.hpp>

#include <slipmode/core/errors.hpp>
#include "diagnostics/models.hpp"
#include "fixtures/clearance_scenes.hpp"
#include "fixtures/shaken_scenes.hpp"
#include "orbits/internal/skeleton_orbit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

using fixtures::BeltOscillator;

Attractor limit_cycle(const BeltOscillator& o) {
  return record_attractor(tests::system_of(o), tests::released(o),
                          {.duration = 12.0 * o.period(), .sample = 0.01 * o.period()});
}

/// A record of the chaotic chain, belt speed 0.2.
Attractor chaos(const dynamics::HybridSystem& system) {
  fixtures::Draws random(3);
  dynamics::State start = system.rest();
  start.q = Eigen::VectorXd::LinSpaced(10, 0.67, 6.66) + random.vector(10, 0.3);
  return record_attractor(system, start, {.transient = 20000.0, .duration = 60000.0, .sample = 50.0});
}

SkeletonOptions short_search(int threads) {
  return {.returns = {.max_length = 3, .threshold = 0.5, .per_length = 4, .apart = 0.5},
          .parallel = {.threads = threads}};
}

// Closed form: tests/fixtures/belt_oscillator.hpp. The whole record lies on the one orbit there is.
TEST(Skeleton, OfALimitCycleIsTheLimitCycle) {
  const BeltOscillator o;
  const Skeleton skeleton = find_skeleton(tests::system_of(o), limit_cycle(o), {.returns = {.max_length = 3}});
  ASSERT_EQ(skeleton.orbits.size(), 1U);
  const SkeletonOrbit& found = skeleton.orbits.front();
  EXPECT_NEAR(found.orbit.period, o.period(), 1e-9);
  EXPECT_EQ(found.length, 1);
  EXPECT_NEAR(found.points(0, 0), o.stick_position(), 1e-9);
  EXPECT_NEAR(found.intervals(0), o.period(), 1e-9);
  EXPECT_DOUBLE_EQ(found.share, 1.0);
  EXPECT_LT(found.off_attractor, 1e-8);
  EXPECT_EQ(found.orbit.stability, Stability::kStable);
  EXPECT_EQ(found.path.cols(), 64);
}

TEST(Skeleton, RecognisesAMultipleOfAShorterOrbit) {
  const BeltOscillator o;
  const Candidate thrice{.state = tests::released(o), .period = 3.0 * o.period(), .length = 3};
  const Skeleton skeleton =
      find_skeleton(tests::system_of(o), limit_cycle(o), {.returns = {.max_length = 1}}, {thrice});
  ASSERT_EQ(skeleton.orbits.size(), 1U);
  EXPECT_EQ(skeleton.orbits.front().length, 1);
  EXPECT_EQ(skeleton.orbits.front().hits, static_cast<int>(skeleton.candidates.size()));
  EXPECT_NEAR(skeleton.orbits.front().orbit.period, o.period(), 1e-9);
}

// What is known stays, what further candidates lead to is told from it.
TEST(Skeleton, ExtendedByItsOwnOrbitIsTheSame) {
  const BeltOscillator o;
  const Attractor attractor = limit_cycle(o);
  const SkeletonOptions options{.returns = {.max_length = 1}};
  const Skeleton once = find_skeleton(tests::system_of(o), attractor, options);
  const Candidate again{.state = tests::released(o), .period = o.period(), .length = 1};
  const Skeleton twice = extended_skeleton(tests::system_of(o), attractor, once, options, {again, again});
  ASSERT_EQ(twice.orbits.size(), 1U);
  EXPECT_EQ(twice.orbits.front().hits, once.orbits.front().hits + 2);
  EXPECT_EQ(twice.candidates.size(), once.candidates.size() + 2);
  EXPECT_EQ(twice.orbits.front().path, once.orbits.front().path);
}

TEST(Skeleton, SaysWhyACandidateIsRefused) {
  // Below the kinetic level, without the speed to come back to the belt: it slides about 0.2 for ever.
  const BeltOscillator o;
  const Candidate sliding{.state = fixtures::state(Eigen::VectorXd::Constant(1, 0.21), Eigen::VectorXd::Zero(1)),
                          .period = 2.0 * std::numbers::pi,
                          .length = 1};
  const Skeleton skeleton =
      find_skeleton(tests::system_of(o), limit_cycle(o), {.returns = {.max_length = 1}}, {sliding});
  ASSERT_EQ(skeleton.refusals.size(), 1U);
  EXPECT_EQ(skeleton.refusals.front().candidate, skeleton.candidates.size() - 1);
  EXPECT_FALSE(skeleton.refusals.front().reason.empty());
}

// Each orbit is run once round by the plain flow, which shares no code with shooting's Newton steps.
TEST(Skeleton, OfTheChaoticChainHoldsTrueUnstableOrbits) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  SkeletonOptions search = short_search(2);
  search.returns.per_length = 8;
  const Skeleton skeleton = find_skeleton(system, chaos(system), search);
  ASSERT_GE(skeleton.orbits.size(), 2U);  // eight records gave seven on average, five at least
  for (const SkeletonOrbit& found : skeleton.orbits) {
    const dynamics::State end = advanced(system, found.orbit.start, found.orbit.period);
    const double size = found.orbit.start.q.norm();
    EXPECT_LT((end.q - found.orbit.start.q).norm(), 1e-8 * size);
    EXPECT_LT((end.v - found.orbit.start.v).norm(), 1e-8 * size);
    EXPECT_LT(found.orbit.residual, 1e-10);
    EXPECT_EQ(found.orbit.stability, Stability::kUnstable);
    EXPECT_NEAR(found.intervals.sum(), found.orbit.period, 1e-9 * found.orbit.period);
    EXPECT_EQ(found.points.cols(), found.length);
  }
  EXPECT_TRUE(
      std::is_sorted(skeleton.orbits.begin(), skeleton.orbits.end(),
                     [](const SkeletonOrbit& a, const SkeletonOrbit& b) { return a.orbit.period < b.orbit.period; }));
}

TEST(Skeleton, HasTheSameBytesForAnyNumberOfThreads) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const Attractor attractor = chaos(system);
  const Skeleton one = find_skeleton(system, attractor, short_search(1));
  const Skeleton three = find_skeleton(tests::chain10(0.2), attractor, short_search(3));
  ASSERT_EQ(one.orbits.size(), three.orbits.size());
  for (std::size_t k = 0; k < one.orbits.size(); ++k) {
    EXPECT_EQ(one.orbits[k].orbit.period, three.orbits[k].orbit.period);
    EXPECT_EQ(one.orbits[k].path, three.orbits[k].path);
    EXPECT_EQ(one.orbits[k].share, three.orbits[k].share);
    EXPECT_EQ(one.orbits[k].hits, three.orbits[k].hits);
  }
  EXPECT_EQ(one.refusals.size(), three.refusals.size());
}

// Sliding all the time: x'' + 0.4 x' + x = F sign(v_rel) under a shaker settles to a motion of the drive's period.
TEST(Skeleton, UnderAShakerCountsPeriodsOfTheDrive) {
  const double period = 2.0 * std::numbers::pi / 0.7;
  const auto system =
      fixtures::single_mass(1.0, 0.4, 1.0, {.direction = {}, .law = friction::Coulomb{0.3, 0.3}, .normal_load = 1.0},
                            friction::Shaker{.amplitude = 3.0, .frequency_hz = 1.0 / period});
  const Attractor attractor = record_attractor(
      system, system.rest(), {.transient = 60.0 * period, .duration = 8.0 * period, .sample = period / 32.0});
  const Candidate doubled{.state = attractor.passages.front(), .period = 2.0 * period, .length = 2};
  const Skeleton skeleton = find_skeleton(system, attractor, {.returns = {.max_length = 2}}, {doubled});
  ASSERT_EQ(skeleton.orbits.size(), 1U);
  EXPECT_EQ(skeleton.orbits.front().orbit.order, 1);
  EXPECT_NEAR(skeleton.orbits.front().orbit.period, period, 1e-12);
  EXPECT_DOUBLE_EQ(skeleton.orbits.front().share, 1.0);
  EXPECT_EQ(skeleton.orbits.front().hits, static_cast<int>(skeleton.candidates.size()));
}

// The mass between equal stops under A sin ωt: x → −x half a period later maps orbits to orbits. So the mirror image of
// each orbit of the chaotic motion at ω = 0.5 is an orbit with the same multipliers.
TEST(Skeleton, OfASymmetricSystemComesInMirrorImages) {
  const dynamics::HybridSystem system = fixtures::backlash_mass(0.5);
  const double period = system.drive().period().value();
  const Attractor attractor =
      record_attractor(system, fixtures::state(Eigen::VectorXd::Constant(1, 3.0), Eigen::VectorXd::Zero(1)),
                       {.transient = 200.0 * period, .duration = 3000.0 * period, .sample = period / 16.0});
  const SkeletonOptions options{.returns = {.max_length = 4, .threshold = 0.5, .per_length = 8, .apart = 0.1}};
  const Skeleton found = find_skeleton(system, attractor, options);
  ASSERT_GE(found.orbits.size(), 6U);
  std::vector<Candidate> mirrored;
  for (const SkeletonOrbit& member : found.orbits) {
    dynamics::State image = member.orbit.start;
    image.time += 0.5 * period;
    image.q = -image.q;
    image.v = -image.v;
    image.modes.clear();
    mirrored.push_back({.state = image, .period = member.orbit.period, .length = member.length});
  }
  const Skeleton both = extended_skeleton(system, attractor, found, options, mirrored);
  EXPECT_EQ(both.refusals.size(), found.refusals.size());
  for (const SkeletonOrbit& member : both.orbits) {
    const auto alike = std::count_if(both.orbits.begin(), both.orbits.end(), [&](const SkeletonOrbit& other) {
      return other.length == member.length &&
             std::abs(other.orbit.leading_modulus / member.orbit.leading_modulus - 1.0) < 1e-7;
    });
    EXPECT_EQ(alike, member.orbit.symmetric ? 1 : 2) << "length " << member.length;
  }
}

TEST(Skeleton, StopsWhenAsked) {
  const BeltOscillator o;
  const Attractor attractor = limit_cycle(o);
  const StopFlag stop{true};
  const Skeleton skeleton =
      find_skeleton(tests::system_of(o), attractor, {.returns = {.max_length = 1}, .parallel = {.stop = &stop}});
  EXPECT_TRUE(skeleton.interrupted);
  EXPECT_TRUE(skeleton.orbits.empty());
}

TEST(Skeleton, RefusesOptionsOutOfRange) {
  const BeltOscillator o;
  const Attractor attractor = limit_cycle(o);
  EXPECT_THROW((void)find_skeleton(tests::system_of(o), attractor, {.passages_per_segment = 0}), InvalidInput);
  EXPECT_THROW((void)find_skeleton(tests::system_of(o), attractor, {.radius = 0.0}), InvalidInput);
  EXPECT_THROW((void)find_skeleton(tests::chain10(0.2), attractor, {}), InvalidInput);
}

// Points on rays from 0 to 2 are within 0.25 of the unit circle for a quarter of their length. A polygon of 400 corners
// lies within 1 − cos(π/400) = 3e-5 of it.
TEST(Share, IsTheShareOfPointsWithinTheRadius) {
  constexpr Eigen::Index kCorners = 400, kRays = 7, kSteps = 1000;
  Eigen::MatrixXd circle(2, kCorners), points(2, kRays * kSteps);
  for (Eigen::Index k = 0; k < kCorners; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kCorners;
    circle.col(k) << std::cos(angle), std::sin(angle);
  }
  for (Eigen::Index k = 0; k < kRays * kSteps; ++k) {
    const double radius = 2.0 * (static_cast<double>(k % kSteps) + 0.5) / kSteps;
    const double angle = 0.3 + static_cast<double>(k / kSteps);
    points.col(k) << radius * std::cos(angle), radius * std::sin(angle);
  }
  EXPECT_NEAR(detail::share_near(points, circle, 0.25), 0.25, 1.0 / kSteps);
}

// Between the corners of a square only the edges count: the middle of an edge lies on it.
TEST(Share, IsMeasuredFromEdgesNotFromCorners) {
  Eigen::MatrixXd square(2, 4);
  square << 1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0;
  const Eigen::MatrixXd middles = (Eigen::MatrixXd(2, 2) << 1.05, 0.0, 0.0, 0.9).finished();
  EXPECT_DOUBLE_EQ(detail::share_near(middles, square, 0.06), 0.5);
  EXPECT_DOUBLE_EQ(detail::share_near(middles, square, 0.11), 1.0);
}

TEST(Shape, LeastLengthOfARepeatedSequenceIsItsPeriod) {
  Eigen::MatrixXd points(1, 6);
  points << 1.0, 2.0, 3.0, 1.0, 2.0, 3.0;
  EXPECT_EQ(detail::least_length(points, 1e-9), 3);
  points(0, 5) = 3.1;
  EXPECT_EQ(detail::least_length(points, 1e-9), 6);
}

}  // namespace
}  // namespace slipmode::orbits
