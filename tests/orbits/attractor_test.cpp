#include <slipmode/orbits/attractor.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/rom/reduce.hpp>
#include "fixtures/belt_oscillator.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/shaken_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

using fixtures::BeltOscillator;

dynamics::HybridSystem system_of(const BeltOscillator& o) {
  return fixtures::oscillator(o.mass, o.stiffness, 0.0, friction::Coulomb{o.mu_s, o.mu_k}, o.load,
                              friction::Belt::constant(o.belt));
}

dynamics::State released(const BeltOscillator& o) {
  return fixtures::state(Eigen::VectorXd::Constant(1, o.release_position()), Eigen::VectorXd::Constant(1, o.belt));
}

// The closed form of tests/fixtures/belt_oscillator.hpp: stick begins once per period, at stick_position.
TEST(Attractor, PassesItsSectionOncePerPeriodOfTheBeltOscillator) {
  const BeltOscillator o;
  const Attractor attractor = record_attractor(
      system_of(o), released(o), {.transient = 3.0 * o.period(), .duration = 10.0 * o.period(), .sample = 0.01});
  ASSERT_EQ(attractor.passages.size(), 10U);
  for (std::size_t k = 0; k < 10; ++k) {
    const auto turns = static_cast<double>(k) + 3.0;
    EXPECT_NEAR(attractor.passages[k].time, turns * o.period() + o.slip_time(), 1e-9);
    EXPECT_NEAR(attractor.points(0, static_cast<Eigen::Index>(k)), o.stick_position(), 1e-10);
    EXPECT_NEAR(attractor.points(1, static_cast<Eigen::Index>(k)), o.belt, 1e-10);
  }
}

TEST(Attractor, MetricMakesEveryCoordinateCountAlike) {
  const BeltOscillator o;
  const Attractor attractor =
      record_attractor(system_of(o), released(o), {.duration = 20.0 * o.period(), .sample = 0.01});
  const Eigen::MatrixXd scaled = attractor.metric.scaled(attractor.samples);
  const auto count = static_cast<double>(scaled.cols());
  EXPECT_NEAR(scaled.colwise().squaredNorm().sum() / count, 1.0, 1e-12);
  EXPECT_NEAR(scaled.row(0).squaredNorm() / count, 0.5, 1e-12);
  EXPECT_LT(scaled.rowwise().mean().norm(), 1e-12);
}

TEST(Attractor, MetricLeavesOutCoordinatesAtRest) {
  Eigen::MatrixXd samples(2, 3);
  samples << 1.0, 2.0, 3.0, 5.0, 5.0, 5.0;
  const Metric metric = Metric::of(samples);
  EXPECT_EQ(metric.scaled(Eigen::Vector2d(2.0, 6.0)).norm(), 0.0);
}

// Steady sliding motion of a linear oscillator under a shaker is x = X sin(ωt + φ) + const at most; seen once per
// period it does not move.
TEST(Attractor, StroboscopicSectionOfPeriodicMotionIsOnePoint) {
  const double period = 2.0 * std::numbers::pi / 0.7;
  const auto system =
      fixtures::single_mass(1.0, 0.4, 1.0, {.direction = {}, .law = friction::Coulomb{0.3, 0.3}, .normal_load = 1.0},
                            friction::Shaker{.amplitude = 3.0, .frequency_hz = 1.0 / period});
  const Attractor attractor = record_attractor(
      system, system.rest(), {.transient = 60.0 * period, .duration = 5.0 * period, .sample = period / 64.0});
  ASSERT_EQ(attractor.passages.size(), 5U);
  EXPECT_TRUE(attractor.section.is_stroboscopic());
  EXPECT_EQ(attractor.samples.cols(), 5 * 64);
  const Eigen::MatrixXd scaled = attractor.metric.scaled(attractor.points);
  EXPECT_LT((scaled.colwise() - scaled.col(0)).norm(), 1e-8);
}

// With all natural modes kept the reduced model is the full one to rounding, so its lifted record must be the same.
TEST(Attractor, OfAReducedModelIsLifted) {
  const auto full = fixtures::belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, friction::Belt::constant(0.45), 3);
  const pod::Basis basis = rom::lnm_basis(full.structure(), 3);
  AttractorOptions options{.duration = 60.0, .sample = 0.5};
  const Attractor of_full = record_attractor(full, full.rest(), options);
  options.basis = basis;
  const dynamics::HybridSystem reduced = rom::reduce(full, basis);
  const Attractor of_reduced = record_attractor(reduced, reduced.rest(), options);
  ASSERT_EQ(of_full.points.cols(), of_reduced.points.cols());
  EXPECT_LT((of_full.points - of_reduced.points).norm(), 1e-7);
  EXPECT_LT((of_full.samples - of_reduced.samples).norm(), 1e-6);
}

TEST(Attractor, SaysThatTheSectionIsNeverMet) {
  const auto resting =
      fixtures::oscillator(1.0, 1.0, 0.1, friction::Coulomb{0.4, 0.2}, 1.0, friction::Belt::constant(5.0));
  EXPECT_THROW((void)record_attractor(resting, resting.rest(), {.duration = 50.0, .sample = 1.0}), NumericalFailure);
}

TEST(Attractor, RefusesOptionsOutOfRange) {
  const auto system = fixtures::belt_chain(friction::Coulomb{0.4, 0.2}, friction::Belt::constant(0.2), 2);
  EXPECT_THROW((void)record_attractor(system, system.rest(), {.duration = 0.0, .sample = 1.0}), InvalidInput);
  EXPECT_THROW((void)record_attractor(system, system.rest(), {.duration = 1.0, .sample = 0.0}), InvalidInput);
  EXPECT_THROW((void)record_attractor(system, system.rest(),
                                      {.section = Section::stroboscopic(), .duration = 1.0, .sample = 0.1}),
               InvalidInput);
  EXPECT_THROW(
      (void)record_attractor(system, system.rest(), {.section = Section{.contact = 3}, .duration = 1.0, .sample = 0.1}),
      InvalidInput);
}

TEST(Attractor, StopsWhenAsked) {
  const auto system = fixtures::belt_chain(friction::Coulomb{0.4, 0.2}, friction::Belt::constant(0.2), 2);
  const StopFlag stop{true};
  EXPECT_THROW((void)record_attractor(system, system.rest(), {.duration = 100.0, .sample = 1.0, .stop = &stop}),
               Interrupted);
}

}  // namespace
}  // namespace slipmode::orbits
