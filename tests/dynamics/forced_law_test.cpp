// Force drives beside laws whose force depends on the sliding speed: an independent reference, closed forms, the
// closed-form flow, tangents by differences, and the energy balance.
#include "dynamics/end_differences.hpp"
#include "fixtures/against_reference.hpp"
#include "fixtures/bristle_scenes.hpp"
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Coulomb;
using friction::Force;
using friction::ForceHarmonic;
using friction::LuGre;
using friction::Stribeck;

constexpr FlowOptions kFlow{.method = FlowMethod::kCollocation, .tolerance = 1e-12};

/// A scene's structure and contacts under forces along one or two directions, of one to three harmonics each.
HybridSystem forced(const RandomScene& scene, std::uint64_t seed) {
  Draws random(seed);
  const Eigen::Index n = scene.system.size();
  const int directions = random.integer(1, 2);
  Force force{0.2 * std::exp(random.uniform(0.0, 3.0)), {}};
  for (int d = 0; d < directions; ++d)
    for (int k = random.integer(1, 3); k > 0; --k)
      force.harmonics.push_back({random.uniform(0.1, 1.5), random.uniform(-3.0, 3.0), k, d});
  Eigen::MatrixXd along(n, directions);
  for (Eigen::Index i = 0; i < along.size(); ++i) along(i) = random.chance(0.5) ? random.uniform(-1.0, 1.0) : 0.0;
  return {scene.system.structure(), scene.system.contacts(), std::move(force), scene.system.load(), along};
}

TEST(ForcedLaws, AgreeWithTheTaylorReferenceOnRandomScenes) {
  std::size_t events = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed, Laws::kAll, 8);
    events += expect_near_reference(forced(scene, 3000 + seed), scene.start, 15.0, kFlow);
  }
  EXPECT_GT(events, 300u);
}

TEST(ForcedLaws, BristlesAgreeWithTheTaylorReference) {
  std::size_t events = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_bristles(seed, false, 6, 0.7);
    events += expect_near_reference(forced(scene, 4000 + seed), scene.start, 10.0, kFlow,
                                    {.event_time = HUGE_VAL, .state = 1e-8});
  }
  EXPECT_GT(events, 100u);
}

TEST(ForcedLaws, BothFlowsAgreeWhereLawsArePiecewiseLinear) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const RandomScene scene = random_scene(seed, Laws::kCoulombOnly, 12);
    const HybridSystem system = forced(scene, 5000 + seed);
    SimulateOptions options{.duration = 20.0, .sample = 0.7, .flow = kFlow};
    const Trajectory steps = simulate(system, scene.start, options);
    options.flow.method = FlowMethod::kClosedForm;
    const Trajectory exact = simulate(system, scene.start, options);
    EXPECT_EQ(mode_changes(steps.events).size(), mode_changes(exact.events).size()) << "seed " << seed;
    EXPECT_LT((steps.q - exact.q).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
    EXPECT_LT((steps.v - exact.v).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
    const EnergyAudit &a = steps.audit, &b = exact.audit;
    EXPECT_NEAR(a.force_work, b.force_work, 1e-9 * b.exchanged) << "seed " << seed;
    EXPECT_NEAR(a.contact_work, b.contact_work, 1e-9 * b.exchanged) << "seed " << seed;
    EXPECT_NEAR(a.viscous_loss, b.viscous_loss, 1e-9 * b.exchanged) << "seed " << seed;
  }
}

TEST(ForcedLaws, TheEnergyBalanceCloses) {
  int worked = 0;  // scenes in which forces matter to the balance
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    const bool bristles = seed % 2 == 0;
    const RandomScene scene = bristles ? random_bristles(seed, true, 12, 0.6) : random_scene(seed, Laws::kAll, 12);
    const HybridSystem system = forced(scene, 6000 + seed);
    const Trajectory run =
        simulate(system, scene.start, {.duration = 40.0, .flow = {.method = FlowMethod::kCollocation}});
    EXPECT_LT(std::abs(run.audit.residual()), 1e-10) << "seed " << seed;
    worked += std::abs(run.audit.force_work) > 0.1 * run.audit.exchanged ? 1 : 0;
    EXPECT_GE(run.audit.friction_loss, -1e-12 * run.audit.exchanged) << "seed " << seed;
  }
  EXPECT_GT(worked, 25);
}

TEST(ForcedLaws, AnUndampedModeAtResonanceGrowsAsItsClosedForm) {
  // m q̈ + k q = A sin ωt, ω² = k/m, from rest, by variation of constants: q = A (sin ωt − ωt cos ωt)/(2k).
  const double m = 2.0, k = 0.5, A = 0.3, omega = std::sqrt(k / m);
  const HybridSystem plain = oscillator(m, k, 0.0, Coulomb{0.0, 0.0}, 1.0, friction::Belt::constant(0.0));
  const HybridSystem system(plain.structure(), plain.contacts(), Force{omega, {{A, 0.0, 1, 0}}}, {},
                            Eigen::MatrixXd::Ones(1, 1));
  const Trajectory run = simulate(system, system.rest(), {.duration = 400.0, .sample = 0.77, .flow = kFlow});
  for (Eigen::Index i = 0; i < run.times.size(); ++i) {
    const double phase = omega * run.times(i);
    EXPECT_NEAR(run.q(0, i), A * (std::sin(phase) - phase * std::cos(phase)) / (2.0 * k), 1e-11 * (1.0 + phase));
  }
  EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
  EXPECT_NEAR(run.audit.force_work, run.audit.energy_end, 1e-11 * run.audit.exchanged);
}

TEST(ForcedLaws, TheTangentFlowAgreesWithDifferences) {
  const HybridSystem belt(fem::chain({.masses = 3, .damping = 0.02}),
                          {{unit(3, 2), Stribeck{0.4, 0.2, 2.0}, 1.5}, {unit(3, 0), Coulomb{0.3, 0.15}, 0.7}},
                          friction::Belt::constant(0.0));
  const HybridSystem system(belt.structure(), belt.contacts(), Force{0.8, {{0.9, 0.2, 1, 0}, {0.4, 1.0, 3, 0}}}, {},
                            Eigen::Vector3d(0.3, 1.0, 0.0));
  const FlowOptions flow{.tolerance = 1e-13};
  const State start = swinging(3, 2, 1.5);
  const TangentResult tangent = tangent_flow(system, start, 12.0, flow);
  EXPECT_GE(tangent.events.size(), 3u);
  EXPECT_LT((tangent.monodromy - slopes_of_end(system, start, 12.0, flow)).cwiseAbs().maxCoeff(), 1e-7);
  // The rate at the end, by the motion a little later.
  const auto later = [&](double dt) {
    return stacked(simulate(system, start, {.duration = 12.0 + dt, .flow = flow}).final_state);
  };
  EXPECT_LT((tangent.rate - slope(later, 1e-3)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ForcedLaws, ThousandTimesAsStrongAsFrictionStaysWithinTolerance) {
  // Errors are held against friction as long as forces are not far larger: each decade of tolerance counts.
  const RandomScene scene = random_scene(7, Laws::kAll, 5);
  const HybridSystem system(scene.system.structure(), scene.system.contacts(), Force{1.3, {{800.0, 0.4, 2, 0}}}, {},
                            Eigen::MatrixXd::Ones(scene.system.size(), 1));
  for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
    const ReferenceGap gap =
        gap_to_reference(system, scene.start, 5.0, {.method = FlowMethod::kCollocation, .tolerance = tolerance});
    EXPECT_EQ(gap.mismatch, "");
    EXPECT_LT(gap.state, 1e3 * tolerance + 1e-10) << tolerance;
  }
}

}  // namespace
}  // namespace slipmode::dynamics
