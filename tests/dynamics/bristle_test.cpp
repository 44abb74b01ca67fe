// Dahl's and the LuGre law on the collocation flow.
#include <slipmode/core/errors.hpp>
#include "fixtures/against_reference.hpp"
#include "fixtures/bristle_scenes.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Dahl;
using friction::LuGre;
using friction::Shaker;

constexpr FlowOptions kTight{.tolerance = 1e-12};

/// A mass no friction can move: its relative velocity is the drive's.
HybridSystem held(friction::Law law, double load, friction::Drive drive) {
  return oscillator(1e15, 1e-3, 0.0, std::move(law), load, drive);
}

TEST(Bristle, DahlAtConstantSpeedYieldsExponentially) {
  // s = V: z = (μN/σ)(1 − e^{−σ V t/(μN)}).
  const double mu = 0.3, load = 2.0, sigma = 40.0, V = 0.2;
  const HybridSystem system = held(Dahl{mu, sigma}, load, Belt::constant(V));
  const Trajectory run = simulate(system, system.rest(), {.duration = 2.0, .sample = 0.013, .flow = kTight});
  for (Eigen::Index i = 0; i < run.times.size(); ++i)
    EXPECT_NEAR(run.lambda(0, i), mu * load * (1.0 - std::exp(-sigma * V * run.times(i) / (mu * load))), 1e-11);
  EXPECT_NEAR(run.final_state.internal(0), run.lambda(0, run.times.size() - 1) / sigma, 1e-3 * mu * load / sigma);
}

TEST(Bristle, DahlsHysteresisLoopDependsOnTheWayOnly) {
  // dz/dx = 1 ∓ z/z_m, z_m = μN/σ: under x = A sin(ωt + φ) the steady loop turns at z = z_m tanh(A/z_m) and encloses
  // 2σ (2A z_m − (z_m + z_t) z_m (1 − e^{−2A/z_m})).
  const double mu = 0.3, load = 2.0, sigma = 4.0, A = 0.1;
  const double z_m = mu * load / sigma, z_t = z_m * std::tanh(A / z_m);
  const double area = 2.0 * sigma * (2.0 * A * z_m - (z_m + z_t) * z_m * (1.0 - std::exp(-2.0 * A / z_m)));
  for (const double frequency : {0.05, 3.0}) {
    const Shaker shaker{A, frequency, -std::numbers::pi / 2.0};
    const HybridSystem system = held(Dahl{mu, sigma}, load, shaker);
    State start = system.rest();
    start.v(0) = shaker.velocity(0.0);
    start.internal = Eigen::VectorXd::Constant(1, -z_t);  // at the lower turning point
    start.v(0) = 0.0;
    const double period = shaker.period();
    const Trajectory run =
        simulate(system, start, {.duration = 3.25 * period, .sample = period / 64.0, .flow = kTight});
    ASSERT_EQ(run.events.size(), 6u);
    for (std::size_t i = 0; i < run.events.size(); ++i) {
      EXPECT_EQ(run.events[i].kind, EventKind::kReversal);
      EXPECT_NEAR(run.events[i].time, 0.5 * static_cast<double>(i + 1) * period, 1e-10 * period);
      EXPECT_NEAR(run.events[i].force, (i % 2 == 0 ? 1.0 : -1.0) * sigma * z_t, 1e-10);
    }
    for (Eigen::Index i = 0; i < run.times.size(); ++i) {
      const double x = shaker.displacement(run.times(i));
      const double way = (i / 32) % 2 == 0 ? x + A : A - x, sign = (i / 32) % 2 == 0 ? 1.0 : -1.0;
      EXPECT_NEAR(run.lambda(0, i), sign * sigma * (z_m - (z_m + z_t) * std::exp(-way / z_m)), 1e-10);
    }
    const Trajectory loop = simulate(system, start, {.duration = period, .flow = kTight});
    EXPECT_NEAR(loop.audit.friction_loss, area, 1e-10);
  }
}

TEST(Bristle, LuGreSlidesSteadilyAtItsStribeckCurve) {
  const LuGre law{0.5, 0.3, 0.1, 200.0, 2.0, 0.4};
  for (const double V : {0.02, 0.1, -0.5}) {
    const HybridSystem system = held(law, 2.0, Belt::constant(V));
    const Trajectory run = simulate(system, system.rest(), {.duration = 40.0, .sample = 40.0, .flow = kTight});
    const double g = 2.0 * (0.3 + 0.2 * std::exp(-(V / 0.1) * (V / 0.1)));
    EXPECT_NEAR(run.lambda(0, 1), std::copysign(g, V) + 0.4 * V, 1e-10);
  }
}

TEST(Bristle, TurningPointsTendToCoulombsAtFirstOrderAsTheBristleStiffens) {
  // Free decay from 5: Coulomb's turning points are −(5 − 2d), 5 − 4d, ... with d = μN/k. The bristle turns over within
  // a way of the order of μN/σ₀, so that energies, hence turning points, differ at first order in 1/σ₀. (Times differ
  // by its square root: that way begins at zero speed.)
  const State start = state(Eigen::VectorXd::Constant(1, 5.0), Eigen::VectorXd::Zero(1));
  const auto turns = [&](const friction::Law& law) {
    const HybridSystem system = oscillator(1.0, 1.0, 0.0, law, 1.0, Belt::constant(0.0));
    const Trajectory run = simulate(system, start, {.duration = 11.0, .flow = kTight});
    EXPECT_EQ(run.events.size(), 3u);
    return Eigen::Vector3d(run.events[0].displacement, run.events[1].displacement, run.events[2].displacement);
  };
  const Eigen::Vector3d limit(-4.2, 3.4, -2.6);
  double before = 0.0;
  for (const double stiffness : {1e3, 2e3, 4e3, 8e3}) {
    const double error = (turns(Dahl{0.4, stiffness}) - limit).norm();
    const double lugre = (turns(LuGre{0.4, 0.4, 0.1, stiffness, 0.0, 0.0}) - limit).norm();
    EXPECT_NEAR(lugre, error, 1e-9);  // Dahl's law is this LuGre law
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 2.0, 0.05);
    }
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(Bristle, AgreesWithTheTaylorReferenceOnRandomScenes) {
  std::size_t events = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_bristles(seed, false, 5);
    events += expect_near_reference(scene.system, scene.start, 8.0, kTight, {.event_time = 1e-8});
  }
  EXPECT_GT(events, 60u);
}

TEST(Bristle, FindsReversalsWhereTheFrictionRisesBetweenTheNodes) {
  // A stiff bristle follows g(s), and g rises threefold within v_s = 0.006, the last hundredth of a way from 0.7 on.
  // Seen at the nodes alone, it was constant: the first reversal came 2.3e-3 late, at tolerance 1e-9 as at 1e-6.
  const HybridSystem system =
      oscillator(1.0, 1.0, 0.0129, LuGre{0.27, 0.08, 0.006, 5700.0, 69.0, 0.06}, 1.0, Belt::constant(-0.0035));
  const State start = state(Eigen::VectorXd::Constant(1, -0.12), Eigen::VectorXd::Constant(1, 0.73));
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const ReferenceGap gap = gap_to_reference(system, start, 20.0, {.tolerance = tolerance});
    EXPECT_EQ(gap.mismatch, "") << tolerance;
    EXPECT_GE(gap.events, 6u);
    EXPECT_LT(gap.event_time, 300.0 * tolerance) << tolerance;
    EXPECT_LT(gap.state, 300.0 * tolerance) << tolerance;
  }
}

TEST(Bristle, ErrorsFollowTheTolerance) {
  const RandomScene scene = random_bristles(3, false, 6);
  const auto end = [&](double tolerance) {
    return stacked(
        simulate(scene.system, scene.start, {.duration = 20.0, .flow = {.tolerance = tolerance}}).final_state);
  };
  const Eigen::VectorXd exact = end(1e-14);
  for (const double tolerance : {1e-6, 1e-8, 1e-10})
    EXPECT_LT((end(tolerance) - exact).norm(), 300.0 * tolerance) << tolerance;
}

TEST(Bristle, TheEnergyBalanceClosesAndBristlesArePassive) {
  // ∫ λ s dt ≥ what the bristle stores less what it held at the start: ½σ₀z² (for σ₁ below the passivity bound
  // σ₁ ż s ≥ −σ₀κz² is guaranteed only for small σ₁; with σ₁ = 0 always).
  for (std::uint64_t seed = 100; seed < 130; ++seed) {
    const RandomScene scene = random_bristles(seed, seed % 2 == 0, 10);
    const Trajectory run = simulate(scene.system, scene.start, {.duration = 20.0});
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9) << "seed " << seed;
    double stored = 0.0;
    bool undamped = true;
    for (std::size_t c = 0; c < scene.system.contacts().size(); ++c) {
      const auto i = static_cast<Eigen::Index>(c);
      const friction::Law& law = scene.system.contacts()[c].law;
      const auto* lugre = std::get_if<LuGre>(&law);
      undamped = undamped && (lugre == nullptr || lugre->damping == 0.0);
      const double stiffness = lugre != nullptr ? lugre->stiffness : std::get<Dahl>(law).stiffness;
      const double z0 = scene.start.internal(i), z1 = run.final_state.internal(i);
      stored += 0.5 * stiffness * (z1 * z1 - z0 * z0);
      EXPECT_LE(std::abs(z1) * stiffness,
                friction::static_coefficient(law) * scene.system.contacts()[c].normal_load.constant * (1 + 1e-9));
    }
    if (undamped) {
      EXPECT_GE(run.audit.friction_loss, stored - 1e-10 * run.audit.exchanged) << "seed " << seed;
    }
  }
}

TEST(Bristle, RestStaysRest) {
  const HybridSystem system = belt_chain(LuGre{0.5, 0.3, 0.1, 1e4, 50.0, 0.1}, Belt::constant(0.0), 4);
  const Trajectory run = simulate(system, system.rest(), {.duration = 1e3});
  EXPECT_TRUE(run.events.empty());
  EXPECT_EQ(run.final_state.q.norm() + run.final_state.v.norm(), 0.0);
}

TEST(Bristle, SettlingInPreslidingIsNotZeno) {
  // Small swings on stiff bristles die out to rounding. What is left: springs in balance, speed 0.
  const HybridSystem system = belt_chain(LuGre{0.5, 0.3, 0.1, 1e4, 50.0, 0.1}, Belt::constant(0.0), 3, 0.5);
  const Trajectory run = simulate(system, swinging(3, 1, 0.3), {.duration = 400.0});
  EXPECT_LT(run.final_state.v.norm(), 1e-9);
  EXPECT_LT(run.events.size(), 20000u);
}

TEST(Bristle, StartsFromRestTheWayItsAccelerationLeads) {
  // A mass at belt speed a little short of its spring's rest, z = 0: s̈ + Ω² s = k V/m, ṡ(0) = −kδ/m, Ω² = (k + σ)/m, up
  // to |s| κ z of 1e-15. s is negative until 2/Ω atan(δΩ/V), long before a step ends, and positive after. Found at 0.6
  // of that before, what was left of s was taken out, and 4e-8 of the energy with it.
  const double m = 1.0, k = 1.0, V = 0.5, delta = 1e-4, sigma = 100.0, Omega = std::sqrt((k + sigma) / m);
  for (const friction::Law& law : {friction::Law(Dahl{0.3, sigma}), friction::Law(LuGre{0.4, 0.3, 0.1, sigma})}) {
    const HybridSystem system = oscillator(m, k, 0.0, law, 1.0, Belt::constant(V));
    State start = system.rest();
    start.q(0) = -delta;
    start.v(0) = V;
    const Trajectory run = simulate(system, start, {.duration = 0.01, .flow = kTight});
    ASSERT_EQ(run.events.size(), 1u);
    EXPECT_EQ(run.events[0].before, ContactMode::kSlipNegative);
    EXPECT_EQ(run.events[0].after, ContactMode::kSlipPositive);
    EXPECT_NEAR(run.events[0].time, 2.0 / Omega * std::atan(delta * Omega / V), 1e-10);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-14);
  }
}

TEST(Bristle, TheClosedFormFlowIsRefused) {
  const HybridSystem system = belt_chain(Dahl{0.4, 100.0}, Belt::constant(0.1), 3);
  EXPECT_THROW((void)simulate(system, system.rest(), {.duration = 1.0, .flow = {.method = FlowMethod::kClosedForm}}),
               InvalidInput);
}

}  // namespace
}  // namespace slipmode::dynamics
