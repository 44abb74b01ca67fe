#include <slipmode/orbits/skeleton_compare.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/rom/reduce.hpp>
#include "diagnostics/models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace slipmode::orbits {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A short skeleton of the chaotic chain. How many orbits a chaotic record finds and how long they are is chance (2 to
/// 7 in 150 such records), so no test asks for more than one.
struct Chain {
  dynamics::HybridSystem system = tests::chain10(0.2);
  Attractor attractor;
  Skeleton skeleton;

  Chain() {
    fixtures::Draws random(3);
    dynamics::State start = system.rest();
    start.q = Eigen::VectorXd::LinSpaced(10, 0.67, 6.66) + random.vector(10, 0.3);
    attractor = record_attractor(system, start, {.transient = 20000.0, .duration = 80000.0, .sample = 50.0});
    skeleton = find_skeleton(system, attractor, options());
    if (skeleton.orbits.empty()) throw std::runtime_error("a chaotic record of 80,000 in which no orbit was found");
  }

  static SkeletonOptions options() {
    return {.returns = {.max_length = 3, .threshold = 0.5, .per_length = 3, .apart = 0.5}};
  }
};

const Chain& chain() {
  static const Chain made;
  return made;
}

TEST(SkeletonCompare, ASkeletonMatchesItself) {
  const Skeleton& skeleton = chain().skeleton;
  const SkeletonComparison comparison = compare_skeletons(skeleton, skeleton, chain().attractor.metric);
  EXPECT_EQ(comparison.matched.size(), skeleton.orbits.size());
  EXPECT_THAT(comparison.missed, IsEmpty());
  EXPECT_THAT(comparison.extra, IsEmpty());
  for (const OrbitMatch& match : comparison.matched) {
    EXPECT_EQ(match.full, match.reduced);
    EXPECT_EQ(match.shape, 0.0);
    EXPECT_EQ(match.period, 0.0);
    EXPECT_EQ(match.log_multiplier, 0.0);
  }
}

// Three orbits that differ in place alone, by more than a match's shape may: an orbit's size in rms is below 10.
TEST(SkeletonCompare, TellsMissedFromExtra) {
  const Metric& metric = chain().attractor.metric;
  Skeleton three;
  three.orbits.assign(3, chain().skeleton.orbits.front());
  three.orbits[1].path.colwise() += 10.0 * metric.rms;
  three.orbits[2].path.colwise() += 20.0 * metric.rms;
  Skeleton fewer = three;
  fewer.orbits.erase(fewer.orbits.begin() + 1);
  EXPECT_THAT(compare_skeletons(three, fewer, metric).missed, ElementsAre(1U));
  EXPECT_THAT(compare_skeletons(fewer, three, metric).extra, ElementsAre(1U));
}

// The same orbit seen from another of its passages is the same shape: three passages of different sizes are put
// together.
TEST(SkeletonCompare, ShapeDoesNotDependOnTheFirstPassage) {
  SkeletonOrbit orbit = chain().skeleton.orbits.front();
  const Eigen::MatrixXd passage = orbit.path.leftCols(orbit.path.cols() / orbit.length);
  const Eigen::Index samples = passage.cols();
  orbit.length = 3;
  orbit.path.resize(passage.rows(), 3 * samples);
  orbit.path << passage, 1.1 * passage, 0.9 * passage;
  SkeletonOrbit turned = orbit;
  turned.path << orbit.path.rightCols(2 * samples), orbit.path.leftCols(samples);
  EXPECT_EQ(shape_difference(orbit, turned, chain().attractor.metric), 0.0);
  turned.path << passage, 0.9 * passage, 1.1 * passage;  // another order is another orbit
  EXPECT_GT(shape_difference(orbit, turned, chain().attractor.metric), 0.0);
}

// A path moved by d in every coordinate's rms is d away, all along: the difference is d over the orbit's size.
TEST(SkeletonCompare, ShapeIsRelativeToTheOrbitsSize) {
  const Metric& metric = chain().attractor.metric;
  const SkeletonOrbit& orbit = chain().skeleton.orbits.back();
  SkeletonOrbit moved = orbit;
  moved.path.colwise() += 0.01 * metric.rms;
  const Eigen::MatrixXd scaled = metric.scaled(orbit.path);
  const double size = std::sqrt((scaled.colwise() - scaled.rowwise().mean()).colwise().squaredNorm().mean());
  EXPECT_NEAR(shape_difference(orbit, moved, metric), 0.01 / size, 1e-9);
}

// With all natural modes kept the reduced model is the full one in other coordinates: every orbit carried over must be
// there, with the same period, multipliers and shape.
TEST(SkeletonCompare, AllModesKeepTheWholeSkeleton) {
  const Chain& c = chain();
  const pod::Basis basis = rom::lnm_basis(c.system.structure(), 10);
  const dynamics::HybridSystem reduced = rom::reduce(c.system, basis);
  const auto restrict = [&](const dynamics::State& state) {
    return rom::restrict_state(c.system.structure(), basis, state);
  };
  const Attractor attractor =
      record_attractor(reduced, restrict(c.attractor.passages.front()),
                       {.duration = 500.0, .sample = 1.0, .basis = basis, .metric = c.attractor.metric});
  SkeletonOptions options = Chain::options();
  options.returns.threshold = 1e-9;
  const Skeleton skeleton =
      find_skeleton(reduced, attractor, options, transferred_candidates(c.system, c.skeleton, restrict));
  const SkeletonComparison comparison = compare_skeletons(c.skeleton, skeleton, c.attractor.metric);
  EXPECT_THAT(comparison.missed, IsEmpty());
  EXPECT_THAT(comparison.extra, IsEmpty());
  for (const OrbitMatch& match : comparison.matched) {
    EXPECT_LT(std::abs(match.period), 1e-9);
    EXPECT_LT(std::abs(match.log_multiplier), 1e-6);
    EXPECT_LT(match.shape, 1e-7);
  }
}

// Orbits travel there and back: lifted to the full model, the reduced model's orbits are candidates for it.
TEST(SkeletonCompare, CandidatesTravelInSegments) {
  const Chain& c = chain();
  const auto same = [](const dynamics::State& state) { return state; };
  const auto candidates = transferred_candidates(c.system, c.skeleton, same, 1);
  ASSERT_EQ(candidates.size(), c.skeleton.orbits.size());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    EXPECT_EQ(static_cast<Eigen::Index>(candidates[k].nodes.size()), c.skeleton.orbits[k].length);
    EXPECT_EQ(candidates[k].period, c.skeleton.orbits[k].orbit.period);
  }
}

TEST(SkeletonCompare, RefusesBadInput) {
  const Skeleton& skeleton = chain().skeleton;
  const Metric& metric = chain().attractor.metric;
  EXPECT_THROW((void)compare_skeletons(skeleton, skeleton, metric, {.max_shape = 0.0}), InvalidInput);
  SkeletonOrbit coarse = skeleton.orbits.front();
  coarse.path = coarse.path.leftCols(3).eval();
  EXPECT_THROW((void)shape_difference(skeleton.orbits.front(), coarse, metric), InvalidInput);
  EXPECT_THROW((void)transferred_candidates(
                   chain().system, skeleton, [](const dynamics::State& s) { return s; }, 0),
               InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
