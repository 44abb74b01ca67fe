// Closed forms: every expected value is an elementary formula of tests/fixtures/, derived by hand.
#include <slipmode/fem/masses.hpp>
#include "fixtures/belt_oscillator.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/uniform_chain.hpp"

#include <gtest/gtest.h>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;

/// Both flows must meet every closed form of a piecewise-linear law.
class ClosedForms : public ::testing::TestWithParam<FlowMethod> {
 protected:
  [[nodiscard]] FlowOptions flow() const { return {.method = GetParam(), .tolerance = 1e-12}; }
};

INSTANTIATE_TEST_SUITE_P(BothFlows, ClosedForms, ::testing::Values(FlowMethod::kClosedForm, FlowMethod::kCollocation),
                         [](const auto& test) {
                           return test.param == FlowMethod::kClosedForm ? "ClosedForm" : "Collocation";
                         });

HybridSystem system_of(const BeltOscillator& b) {
  return oscillator(b.mass, b.stiffness, 0.0, friction::Coulomb{b.mu_s, b.mu_k}, b.load,
                    friction::Belt::constant(b.belt));
}

TEST_P(ClosedForms, BeltOscillatorFollowsItsLimitCycle) {
  for (const BeltOscillator b :
       {BeltOscillator{}, BeltOscillator{2.0, 3.0, 1.5, 0.7, 0.1, 0.5}, BeltOscillator{1.0, 1.0, 1.0, 0.4, 0.399, 0.3},
        BeltOscillator{1.0, 1.0, 1.0, 2.0, 0.1, 0.01}}) {
    State start = state(Eigen::VectorXd::Constant(1, b.release_position()), Eigen::VectorXd::Constant(1, b.belt));
    start.modes = {ContactMode::kSlipPositive};
    const int cycles = 20;
    const double duration = (cycles + 0.3) * b.period();
    const Trajectory run =
        simulate(system_of(b), start, {.duration = duration, .sample = duration / 997.0, .flow = flow()});
    const double scale = b.amplitude();
    for (Eigen::Index k = 0; k < run.times.size(); ++k) {
      ASSERT_NEAR(run.q(0, k), b.position(run.times[k]), 1e-10 * scale) << "t = " << run.times[k];
      ASSERT_NEAR(run.v(0, k), b.velocity(run.times[k]), 1e-10 * scale * b.omega()) << "t = " << run.times[k];
    }
    ASSERT_EQ(run.events.size(), 2u * cycles + (b.slip_time() < 0.3 * b.period() ? 1u : 0u));
    for (std::size_t i = 0; i < run.events.size(); ++i) {
      const Event& event = run.events[i];
      const bool sticks = i % 2 == 0;
      const double expected =
          static_cast<double>(i / 2 + (sticks ? 0 : 1)) * b.period() + (sticks ? b.slip_time() : 0.0);
      EXPECT_NEAR(event.time, expected, 1e-10 * expected);
      EXPECT_EQ(event.kind, sticks ? EventKind::kStick : EventKind::kRelease);
      EXPECT_EQ(event.before, sticks ? ContactMode::kSlipPositive : ContactMode::kStick);
      EXPECT_EQ(event.after, sticks ? ContactMode::kStick : ContactMode::kSlipPositive);
      EXPECT_NEAR(event.displacement, sticks ? b.stick_position() : b.release_position(), 1e-10 * scale);
      EXPECT_NEAR(event.velocity, b.belt, 1e-12);
      EXPECT_NEAR(event.force, sticks ? b.stiffness * b.stick_position() : b.mu_k * b.load, 1e-10 * b.load);
    }
  }
}

TEST_P(ClosedForms, BeltOscillatorSpendsItsStickTimeSticking) {
  const BeltOscillator b;
  State start = state(Eigen::VectorXd::Constant(1, b.release_position()), Eigen::VectorXd::Constant(1, b.belt));
  start.modes = {ContactMode::kSlipPositive};
  const Trajectory run = simulate(system_of(b), start, {.duration = 7.0 * b.period() - 1e-6, .flow = flow()});
  ASSERT_EQ(run.statistics.stick_time.size(), 1u);
  EXPECT_NEAR(run.statistics.stick_time[0], 7.0 * b.stick_time() - 1e-6, 1e-9);
}

TEST_P(ClosedForms, DampedOscillatorLetsGoWhereSpringAndDashpotTogetherReachTheStaticLimit) {
  // Trap of the design: with a dashpot c stick ends at x = (μ_s N − c V)/k, not at μ_s N/k.
  const double c = 0.3, V = 0.2, F = 0.4;
  const HybridSystem system = oscillator(1.0, 2.0, c, friction::Coulomb{0.4, 0.2}, 1.0, friction::Belt::constant(V));
  const State start = state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, V));
  const Trajectory run = simulate(system, start, {.duration = 1.0, .flow = flow()});
  ASSERT_FALSE(run.events.empty());
  EXPECT_EQ(run.events[0].kind, EventKind::kRelease);
  EXPECT_NEAR(run.events[0].displacement, (F - c * V) / 2.0, 1e-12);
  EXPECT_NEAR(run.events[0].time, (F - c * V) / 2.0 / V, 1e-11);
}

void expect_decay(const CoulombDecay& d, const FlowOptions& flow) {
  const HybridSystem system = oscillator(d.mass, d.stiffness, d.dashpot, friction::Coulomb{d.mu_s, d.mu_k}, d.load,
                                         friction::Belt::constant(0.0));
  const State start = state(Eigen::VectorXd::Constant(1, d.start), Eigen::VectorXd::Zero(1));
  const int turns = d.last_turn();
  const Trajectory run = simulate(system, start, {.duration = (turns + 3) * d.half_period(), .flow = flow});
  ASSERT_EQ(run.events.size(), static_cast<std::size_t>(turns));
  for (int k = 1; k <= turns; ++k) {
    const Event& event = run.events[k - 1];
    const double side = k % 2 == 0 ? 1.0 : -1.0;
    EXPECT_NEAR(event.time, k * d.half_period(), 1e-10 * k);
    EXPECT_NEAR(event.displacement, side * d.amplitude(k), 1e-10 * d.start);
    EXPECT_EQ(event.kind, k == turns ? EventKind::kStick : EventKind::kReversal);
  }
  EXPECT_NEAR(run.final_state.q[0], (turns % 2 == 0 ? 1.0 : -1.0) * d.amplitude(turns), 1e-10 * d.start);
  EXPECT_NEAR(run.final_state.v[0], 0.0, 1e-13);
}

TEST_P(ClosedForms, FreeCoulombDecayLosesTwiceTheDeadZonePerHalfCycleAndStops) {
  expect_decay({.start = 10.1}, flow());
  expect_decay({.mass = 3.0, .stiffness = 0.7, .load = 0.5, .mu_s = 0.3, .mu_k = 0.3, .start = 7.7}, flow());
}

TEST_P(ClosedForms, FreeCoulombDecayWithDashpotShrinksGeometricallyAsWell) {
  expect_decay({.dashpot = 0.1}, flow());
  expect_decay({.dashpot = 1.2, .mu_s = 0.02, .mu_k = 0.01}, flow());
}

TEST_P(ClosedForms, ChainWithoutFrictionFollowsItsTextbookModes) {
  Draws random(11);
  for (const double damping : {0.0, 0.006, 0.9, 30.0}) {
    const UniformChain chain{10, damping};
    const Eigen::VectorXd q0 = random.vector(10, 1.0), v0 = random.vector(10, 1.0);
    for (const bool weightless : {false, true}) {
      const friction::Law law = friction::Coulomb{weightless ? 0.4 : 0.0, weightless ? 0.2 : 0.0};
      const HybridSystem system = belt_chain(law, friction::Belt::constant(0.2), 10, damping, weightless ? 0.0 : 3.0);
      const Trajectory run = simulate(system, state(q0, v0), {.duration = 100.0, .sample = 0.37, .flow = flow()});
      for (Eigen::Index k = 0; k < run.times.size(); ++k) {
        const auto expected = chain.motion(q0, v0, run.times[k]);
        ASSERT_LT((run.q.col(k) - expected.q).cwiseAbs().maxCoeff(), 1e-10) << damping << " at " << run.times[k];
        ASSERT_LT((run.v.col(k) - expected.v).cwiseAbs().maxCoeff(), 1e-10) << damping << " at " << run.times[k];
      }
    }
  }
}

TEST_P(ClosedForms, WhatFloatsAndHardlyFeelsADamperGoesStraightOn) {
  // Two masses on one spring, both at speed 1, the first on a damper c: |q̈| ≤ c/m of either, so q = t up to c t²/2m.
  for (const double c : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const HybridSystem pair(
        fem::masses({.mass = {1.0, 2.0}, .links = {{1, 2, 1.0, 0.0}, {.first = 0, .second = 1, .damping = c}}}),
        {{unit(2, 1), friction::Coulomb{0.3, 0.3}, 0.0}}, friction::Belt::constant(0.0));
    for (const double t : {0.01, 1.0}) {
      const Trajectory run =
          simulate(pair, state(Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones()), {.duration = t, .flow = flow()});
      EXPECT_LE((run.final_state.q.array() - t).abs().maxCoeff(), c * t * t / 2.0 + 1e-14 * t) << c;
      EXPECT_LE((run.final_state.v.array() - 1.0).abs().maxCoeff(), c * t + 1e-14) << c;
    }
  }
}

TEST_P(ClosedForms, WhatFloatsAndHardlyFeelsADamperIsPulledAlong) {
  // The same two masses from rest, the second pulled by friction F: no speed exceeds F t, so of F t²/2 the damper takes
  // c F t³/6 at most.
  constexpr double kForce = 0.3;
  for (const double c : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const HybridSystem pair(
        fem::masses({.mass = {1.0, 2.0}, .links = {{1, 2, 1.0, 0.0}, {.first = 0, .second = 1, .damping = c}}}),
        {{unit(2, 1), friction::Coulomb{kForce, kForce}, 1.0}}, friction::Belt::constant(100.0));
    for (const double t : {0.01, 1.0, 20.0}) {
      const Trajectory run = simulate(pair, pair.rest(), {.duration = t, .flow = flow()});
      const double way = run.final_state.q(0) + 2.0 * run.final_state.q(1), free = kForce * t * t / 2.0;
      EXPECT_LE(std::abs(way - free), c * kForce * t * t * t / 6.0 + 1e-13 * free) << c << ' ' << t;
    }
  }
}

TEST(ClosedFormFlow, WhatABeltHasJustBegunToPullIsItsPowerSeries) {
  // Three masses at rest, the last on a spring K that a belt of speed V pulls from t = 0: q = Σ a_n tⁿ with M a_{n+2}
  // (n + 2)(n + 1) = K V e₃ [n = 1] − C a_{n+1} (n + 1) − (K + K e₃e₃ᵀ) a_n, of which q is of the order t³. As the sum
  // of what is free and what follows the belt, it was 1e-5 of itself off at ωt = 1e-5, and 500 times itself at 1e-9.
  constexpr double kSpeed = 0.7;
  constexpr int kTerms = 60;
  const Eigen::Vector3d place = Eigen::Vector3d::UnitZ();
  for (const double damper : {0.0, 0.3, 50.0})
    for (const double spring : {2.0, 1e6}) {
      const fem::Structure structure =
          fem::masses({.mass = {1.2, 0.8, 1.0},
                       .links = {{0, 1, 1.3, damper}, {1, 2, 0.9, 0.1 * damper}, {2, 3, 1.1, 0.2 * damper}}});
      const HybridSystem system(structure, {{place, friction::CompliantCoulomb{1.0, 1.0, spring}, 1e12}},
                                friction::Belt::constant(kSpeed));
      const Eigen::Matrix3d M = fem::to_dense(structure.M()), C = fem::to_dense(structure.C()),
                            K = fem::to_dense(structure.K()) + spring * place * place.transpose();
      std::vector<Eigen::Vector3d> a(kTerms, Eigen::Vector3d::Zero());
      for (std::size_t n = 0; n + 2 < kTerms; ++n) {
        const double order = static_cast<double>(n);
        const Eigen::Vector3d pull = n == 1 ? Eigen::Vector3d(spring * kSpeed * place) : Eigen::Vector3d::Zero();
        a[n + 2] = M.inverse() * (pull - (order + 1.0) * C * a[n + 1] - K * a[n]) / ((order + 2.0) * (order + 1.0));
      }
      for (const double phase : {1e-9, 1e-7, 1e-5, 1e-3, 1e-2, 0.1, 0.5}) {
        SCOPED_TRACE(testing::Message() << "damper " << damper << ", spring " << spring << ", phase " << phase);
        const double t = phase / std::sqrt(spring + 1.0);
        Eigen::Vector3d q = Eigen::Vector3d::Zero(), v = q;
        for (std::size_t n = kTerms - 1; n > 0; --n) {
          q = q * t + a[n];
          v = v * t + static_cast<double>(n) * a[n];
        }
        q *= t;
        const State end = simulate(system, system.rest(), {.duration = t}).final_state;
        EXPECT_LT((end.v - v).norm(), 3e-14 * v.norm());
        // Complex modes hold speeds and places in one: these round by a radian of those.
        EXPECT_LT((end.q - q).norm(), 3e-14 * (q.norm() + (damper == 0.0 ? 0.0 : v.norm())));
      }
    }
}

TEST_P(ClosedForms, UndampedChainWithoutFrictionKeepsItsEnergy) {
  Draws random(5);
  const HybridSystem system = belt_chain(friction::Coulomb{0.0, 0.0}, friction::Belt::constant(0.2), 25, 0.0);
  const State start = random_state(random, 25, 1.0);
  const Trajectory run = simulate(system, start, {.duration = 1e4, .flow = flow()});
  EXPECT_NEAR(system.energy(run.final_state) / system.energy(start), 1.0, 1e-10);
}

HybridSystem free_block(friction::NormalLoad load, friction::Law law, friction::Drive drive) {
  const fem::Matrix one = Eigen::MatrixXd::Constant(1, 1, 1.0), none = Eigen::MatrixXd::Zero(1, 1);
  return {fem::Structure(one, none, none), {{unit(1, 0), std::move(law), load}}, std::move(drive)};
}

TEST(NormalOscillators, FeelABlockThatFloatsToItsLastDigits) {
  // A block that starts at belt speed V keeps it, held or let go: y = y0 + V t, and of its oscillator's
  // z̈ + d ż + k z = l y, N = N0 + k_e (s y − z), everything is known. N vanishes at every event.
  const double V = 0.37, y0 = -1.1, N0 = 0.3;
  Draws random(11);
  int events = 0;
  for (int draw = 0; draw < 20; ++draw) {
    const friction::NormalOscillator own{.mass = random.uniform(0.5, 2.0),
                                         .support_stiffness = random.uniform(0.2, 2.0),
                                         .support_damping = random.uniform(0.0, 0.1),
                                         .spring_stiffness = random.uniform(0.5, 2.0),
                                         .slope = random.uniform(-0.8, -0.3)};
    const HybridSystem system = free_block({N0, own}, friction::Coulomb{0.7, 0.3}, friction::Belt::constant(V));
    State start = system.rest();
    start.q(0) = y0;
    start.v(0) = V;
    const double k = (own.support_stiffness + own.spring_stiffness) / own.mass, d = own.support_damping / own.mass,
                 l = own.spring_stiffness * own.slope / own.mass;
    const double drift = l * V / k, place = (l * y0 - d * drift) / k, w = std::sqrt(k - 0.25 * d * d);
    start.internal = Eigen::Vector2d(l * y0 / k, 0.0);
    const double a = start.internal(0) - place, b = (0.5 * d * a - drift) / w;
    const auto z = [&](double t) {
      return place + drift * t + std::exp(-0.5 * d * t) * (a * std::cos(w * t) + b * std::sin(w * t));
    };
    const Trajectory run = simulate(system, start, {.duration = 12.0});
    EXPECT_NEAR(run.final_state.internal(0), z(12.0), 1e-13);
    for (const Event& event : run.events) {
      const double N = N0 + own.spring_stiffness * (own.slope * (y0 + V * event.time) - z(event.time));
      EXPECT_NEAR(N, 0.0, 1e-13) << "draw " << draw << " at " << event.time;
      ++events;
    }
  }
  EXPECT_GT(events, 20);
}

TEST_P(ClosedForms, ABlockOnAShakenTableReversesTwiceACycle) {
  // m v' = ± mu N: the speed is a triangle, whose turns are half a period apart on the table's own speed, so at ± mu
  // N/m T/4. It has no natural period by which many events could be too many.
  const double mu = 0.1, load = 10.0, frequency = 1.0, cycles = 400.0;
  const HybridSystem system =
      free_block({load}, friction::Coulomb{mu, mu}, friction::Shaker{.amplitude = 0.1, .frequency_hz = frequency});
  const Trajectory run = simulate(system, system.rest(), {.duration = cycles / frequency, .flow = flow()});
  EXPECT_NEAR(static_cast<double>(run.events.size()), 2.0 * cycles, 2.0);
  const double turn = mu * load / (4.0 * frequency);
  for (std::size_t k = run.events.size() - 100; k < run.events.size(); ++k) {
    EXPECT_EQ(run.events[k].kind, EventKind::kReversal);
    EXPECT_NEAR(std::abs(run.events[k].velocity), turn, 1e-10);
  }
  EXPECT_LT(std::abs(run.audit.residual()), 1e-10);
}

TEST_P(ClosedForms, ABlockThatIsCarriedAwayLosesItsLoadOnce) {
  // Stuck on a belt of speed V, y = V t and no force: N = N0 + s y is zero at t = -N0/(s V), and the limit of the force
  // with it. From there on it flies.
  const double V = -0.75, N0 = 2.5, slope = 0.32;
  for (const double mu_k : {0.0, 0.2}) {
    const HybridSystem system = free_block({N0, slope}, friction::Coulomb{0.45, mu_k}, friction::Belt::constant(V));
    State start = state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, V));
    start.modes = {ContactMode::kStick};
    const Trajectory run = simulate(system, start, {.duration = 20.0, .flow = flow()});
    ASSERT_EQ(run.events.size(), 1U) << mu_k;
    EXPECT_EQ(run.events[0].kind, EventKind::kSeparation);
    EXPECT_NEAR(run.events[0].time, -N0 / (slope * V), 1e-12);
    EXPECT_NEAR(run.final_state.q(0), 20.0 * V, 1e-12);
  }
}

}  // namespace
}  // namespace slipmode::dynamics
