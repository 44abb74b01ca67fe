// The ends of every range: belt speeds 0, 1e-9 and huge, no friction, one and two masses, rigid-body modes, critical
// and heavy damping, simultaneous events, event storms.
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/masses.hpp>
#include "fixtures/against_reference.hpp"
#include "fixtures/uniform_chain.hpp"

#include <gtest/gtest.h>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;

constexpr FlowOptions kTightExtremes{.method = FlowMethod::kCollocation, .tolerance = 1e-13};
constexpr FlowOptions kExactExtremes{.method = FlowMethod::kClosedForm};

TEST(Extremes, OnABeltAtRestTheChainSettlesAndStaysStuck) {
  for (const friction::Law& law : {friction::Law(Coulomb{0.4, 0.2}), friction::Law(Stribeck{0.4, 0.2, 8.0})}) {
    const HybridSystem chain = belt_chain(law, Belt::constant(0.0), 10, 0.5);
    const State start = swinging(10, 1, 2.0);
    const Trajectory run = simulate(chain, start, {.duration = 2000.0, .sample = 2.0});
    ASSERT_FALSE(run.events.empty());
    EXPECT_EQ(run.final_state.modes.at(0), ContactMode::kStick);
    EXPECT_LT(run.final_state.v.cwiseAbs().maxCoeff(), 1e-12);
    double last = chain.energy(start);
    for (Eigen::Index k = 0; k < run.times.size(); ++k) {
      const double energy = chain.energy(state(run.q.col(k), run.v.col(k)));
      ASSERT_LE(energy, last * (1.0 + 1e-12)) << "energy grew on a belt at rest, t = " << run.times[k];
      last = energy;
    }
  }
}

TEST(Extremes, AStuckChainAtRestStaysForTenMillionUnits) {
  const HybridSystem chain = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.0));
  const State start = state(Eigen::VectorXd::LinSpaced(10, 0.05, 0.5), Eigen::VectorXd::Zero(10));
  const Trajectory run = simulate(chain, start, {.duration = 1e7});
  EXPECT_TRUE(run.events.empty());
  EXPECT_LT((run.final_state.q - start.q).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_DOUBLE_EQ(run.final_state.time, 1e7);
  EXPECT_LT(run.statistics.steps, 2'000'000'000) << "steps are counted without overflow";
}

TEST(Extremes, ABeltOfOneNanometrePerSecondCarriesTheMassAlong) {
  for (const FlowOptions& flow : {kExactExtremes, kTightExtremes}) {
    const HybridSystem chain = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(1e-9));
    const Trajectory run = simulate(chain, chain.rest(), {.duration = 1000.0, .sample = 10.0, .flow = flow});
    EXPECT_EQ(run.final_state.modes.at(0), ContactMode::kStick);
    // After the tiny slip of the start (v_rel = 1e-9, deceleration 0.6) it moves as the belt does.
    EXPECT_NEAR(run.final_state.q[9], 1e-6, 1e-14);
    EXPECT_NEAR(run.final_state.v[9], 1e-9, 1e-16);
  }
}

TEST(Extremes, SlowBeltsAgreeWithTheReference) {
  for (const double speed : {0.0, 1e-9, -1e-9, 1e-3}) {
    const HybridSystem coulomb = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(speed));
    const HybridSystem stribeck = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(speed));
    for (const std::uint64_t seed : {1u, 2u}) {
      const State start = swinging(10, seed, 1.5);
      for (const auto& [system, flow] : {std::pair{&coulomb, kExactExtremes}, std::pair{&coulomb, kTightExtremes},
                                         std::pair{&stribeck, kTightExtremes}}) {
        const ReferenceGap gap = gap_to_reference(*system, start, 60.0, flow);
        EXPECT_EQ(gap.mismatch, "") << "belt " << speed << " seed " << seed;
        EXPECT_LT(gap.event_time, 1e-9);
        EXPECT_LT(gap.state, 1e-9);
        EXPECT_GE(gap.events, 3u);
      }
    }
  }
}

TEST(Extremes, AHugeBeltOnlyShiftsTheEquilibrium) {
  // v_rel never comes near zero: λ = μ_k N for both laws (e^{−8e6} = 0), a free chain about K⁻¹ w μ_k N = 0.6 i.
  const UniformChain free{10, 0.006};
  const Eigen::VectorXd shift = 0.6 * Eigen::VectorXd::LinSpaced(10, 1.0, 10.0);
  const State start = swinging(10, 3, 1.0);
  const auto expected = free.motion(start.q - shift, start.v, 200.0);
  for (const double speed : {1e6, -1e6}) {
    const double side = speed > 0 ? 1.0 : -1.0;
    const auto moved = free.motion(start.q - side * shift, start.v, 200.0);
    for (const friction::Law& law : {friction::Law(Coulomb{0.4, 0.2}), friction::Law(Stribeck{0.4, 0.2, 8.0})}) {
      const Trajectory run = simulate(belt_chain(law, Belt::constant(speed)), start, {.duration = 200.0});
      EXPECT_TRUE(run.events.empty());
      EXPECT_LT((run.final_state.q - moved.q - side * shift).cwiseAbs().maxCoeff(), 1e-10);
    }
  }
  EXPECT_GT(expected.q.norm(), 0.0);
}

TEST(Extremes, OneAndTwoMassesAgreeWithTheReference) {
  for (const int n : {1, 2}) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const State start = swinging(n, seed, 2.0);
      const ReferenceGap rough =
          gap_to_reference(belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2), n), start, 60.0, kTightExtremes);
      EXPECT_EQ(rough.mismatch, "");
      EXPECT_LT(rough.event_time, 1e-9);
      for (const FlowOptions& flow : {kExactExtremes, kTightExtremes}) {
        const ReferenceGap gap =
            gap_to_reference(belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.2), n), start, 60.0, flow);
        EXPECT_EQ(gap.mismatch, "");
        EXPECT_LT(gap.event_time, 1e-9);
      }
    }
  }
}

TEST(Extremes, EqualCoefficientsNeverJumpAndAgreeWithTheReference) {
  const State start = swinging(10, 2, 1.5);
  for (const FlowOptions& flow : {kExactExtremes, kTightExtremes}) {
    const ReferenceGap gap = gap_to_reference(belt_chain(Coulomb{0.3, 0.3}, Belt::constant(0.2)), start, 80.0, flow);
    EXPECT_EQ(gap.mismatch, "");
    EXPECT_LT(gap.event_time, 1e-9);
  }
}

TEST(Extremes, AFreeFreeChainUnderLoadMovesItsCentreOfMassAsNewtonSays) {
  // Free at both ends on a belt at rest, load 0.5 on each of three masses of 1, 2, 1.5; sliding friction μ_k N = 0.3.
  const HybridSystem system(fem::chain({.masses = 3, .mass = {1.0, 2.0, 1.5}, .damping = 0.01, .left_fixed = false}),
                            {{unit(3, 1), Coulomb{0.4, 0.2}, 1.5}}, Belt::constant(0.0),
                            Eigen::VectorXd::Constant(3, 0.5));
  const State start = state(Eigen::VectorXd::Zero(3), Eigen::VectorXd::Constant(3, 1.0));
  for (const FlowOptions& flow : {kExactExtremes, kTightExtremes}) {
    const Trajectory run = simulate(system, start, {.duration = 50.0, .sample = 1.0, .flow = flow});
    EXPECT_TRUE(run.events.empty());
    const Eigen::Vector3d mass(1.0, 2.0, 1.5);
    for (Eigen::Index k = 0; k < run.times.size(); ++k) {
      const double t = run.times[k], centre = mass.dot(run.q.col(k)) / mass.sum();
      EXPECT_NEAR(centre, t + 0.5 * (3 * 0.5 - 0.3) / 4.5 * t * t, 1e-10 * (1.0 + t * t));
    }
    const ReferenceGap gap = gap_to_reference(system, swinging(3, 1, 2.0), 30.0, flow);
    EXPECT_EQ(gap.mismatch, "");
    EXPECT_LT(gap.state, 1e-9);
  }
}

TEST(Extremes, CriticalNearCriticalAndHeavyDampingFollowTheirClosedForms) {
  // ẍ + 2 d ẋ + x = 0 from x = 1, ẋ = −0.3 without friction.
  const auto expected = [](double d, double t) {
    if (d == 1.0) return (1.0 + 0.7 * t) * std::exp(-t);
    const double root = std::sqrt(std::abs(d * d - 1.0));
    const double b = (-0.3 + d) / root;
    return std::exp(-d * t) *
           (d < 1.0 ? std::cos(root * t) + b * std::sin(root * t) : std::cosh(root * t) + b * std::sinh(root * t));
  };
  const State start = state(Eigen::VectorXd::Constant(1, 1.0), Eigen::VectorXd::Constant(1, -0.3));
  for (const FlowOptions& flow : {kExactExtremes, kTightExtremes}) {
    for (const double d : {1.0, 1.0 + 1e-5, 1.0 - 1e-5, 0.5, 3.0}) {
      const HybridSystem system = oscillator(1.0, 1.0, 2.0 * d, Coulomb{0.0, 0.0}, 1.0, Belt::constant(9.0));
      const Trajectory run = simulate(system, start, {.duration = 8.0, .sample = 0.5, .flow = flow});
      for (Eigen::Index k = 0; k < run.times.size(); ++k) {
        // The formula itself loses ε/√|d²−1| near critical damping.
        const double slack = d == 1.0 ? 0.0 : 1e-15 / std::sqrt(std::abs(d * d - 1.0));
        ASSERT_NEAR(run.q(0, k), expected(d, run.times[k]), 1e-12 + 10.0 * slack) << d << " at " << run.times[k];
      }
    }
    // Next to critical: within the first-order change of the critical solution.
    for (const double d : {1.0 + 1e-12, 1.0 - 1e-12, 1.0 + 1e-9, 1.0 - 1e-9}) {
      const HybridSystem system = oscillator(1.0, 1.0, 2.0 * d, Coulomb{0.0, 0.0}, 1.0, Belt::constant(9.0));
      const Trajectory run = simulate(system, start, {.duration = 8.0, .sample = 0.5, .flow = flow});
      for (Eigen::Index k = 0; k < run.times.size(); ++k) {
        ASSERT_NEAR(run.q(0, k), expected(1.0, run.times[k]), 1e-12 + 10.0 * std::abs(d - 1.0)) << d;
      }
    }
  }
}

TEST(Extremes, HeavilyDampedChainsAgreeWithTheReference) {
  for (const double damping : {0.5, 1.0, 10.0}) {
    const State start = swinging(6, 1, 2.0);
    const HybridSystem coulomb = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.2), 6, damping);
    for (const FlowOptions& flow : {kExactExtremes, kTightExtremes}) {
      const ReferenceGap gap = gap_to_reference(coulomb, start, 40.0, flow);
      EXPECT_EQ(gap.mismatch, "") << damping;
      EXPECT_LT(gap.event_time, 1e-9) << damping;
      EXPECT_LT(gap.state, 1e-9) << damping;
    }
  }
}

TEST(Extremes, SymmetricContactsChangeTogetherAndTheMotionStaysSymmetric) {
  const HybridSystem system(fem::chain({.masses = 5, .damping = 0.01, .right_fixed = true}),
                            {{unit(5, 1), Coulomb{0.4, 0.2}, 1.0}, {unit(5, 3), Coulomb{0.4, 0.2}, 1.0}},
                            Belt::constant(0.15));
  for (const FlowOptions& flow : {kExactExtremes, kTightExtremes}) {
    const Trajectory run = simulate(system, system.rest(), {.duration = 60.0, .sample = 0.1, .flow = flow});
    const auto changes = mode_changes(run.events);
    ASSERT_GE(changes.size(), 8u);
    ASSERT_EQ(changes.size() % 2, 0u);
    for (std::size_t i = 0; i + 1 < changes.size(); i += 2) {
      EXPECT_NEAR(changes[i].time, changes[i + 1].time, 1e-11);
      EXPECT_EQ(changes[i].contact + changes[i + 1].contact, 1);
      EXPECT_EQ(changes[i].after, changes[i + 1].after);
    }
    EXPECT_LT((run.q - run.q.colwise().reverse()).cwiseAbs().maxCoeff(), 1e-10);
    const ReferenceGap gap = gap_to_reference(system, system.rest(), 60.0, flow);
    EXPECT_LT(gap.state, 1e-9);
  }
}

TEST(Extremes, TooManyEventsInTooShortATimeAreReportedWithTimeAndState) {
  const HybridSystem chain = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.2));
  const State start = swinging(10, 1, 1.5);
  const Trajectory calm = simulate(chain, start, {.duration = 100.0});
  ASSERT_GE(calm.events.size(), 4u);
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const FlowOptions strict{.method = method, .max_events_per_window = 3, .zeno_window = 100.0};
    try {
      (void)simulate(chain, start, {.duration = 100.0, .flow = strict});
      FAIL() << "four events within 100 units passed where three are allowed";
    } catch (const NumericalFailure& failure) {
      EXPECT_GE(failure.time, calm.events[2].time - 1e-6);
      EXPECT_LE(failure.time, calm.events[3].time + 1e-6);
      // The fourth event is on the belt's speed: the state is (q, v) of ten masses, the last one driven.
      ASSERT_EQ(failure.state.size(), 20);
      EXPECT_NEAR(failure.state[19], 0.2, 1e-10);
    }
  }
}

TEST(Extremes, AStickOnAMassOfAStiffPairHoldsUntilASoftSpringReachesItsLimit) {
  // The first mass moves with the belt, the other behind the stiff spring too, and rings: the ground spring pulls with
  // k V (t − sin(ωt)/ω), which never falls. Steps are a millionth of a second, in which the stick's force is told by
  // speeds to 1e-10 of its limit, and worse in shorter ones.
  const double stiff = 1e13, soft = 1e3, limit = 1.0, omega = std::sqrt(stiff + soft);
  const Eigen::Matrix2d pair{{1.0, -1.0}, {-1.0, 1.0}}, ground{{0.0, 0.0}, {0.0, 1.0}};
  const HybridSystem system(fem::Structure(Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(2, 2),
                                           Eigen::MatrixXd(stiff * pair + soft * ground)),
                            {{Eigen::Vector2d(1.0, 0.0), Stribeck{1.0, 0.5, 3.0}, limit}}, Belt::constant(1.0));
  double before = 0.0, release = 2e-3;
  while (release - before > 1e-15) {
    const double t = 0.5 * (before + release);
    (soft * (t - std::sin(omega * t) / omega) < limit ? before : release) = t;
  }
  for (const double tolerance : {1e-7, 1e-9, 1e-12}) {
    const FlowOptions flow{.method = FlowMethod::kCollocation, .tolerance = tolerance};
    const Trajectory run =
        simulate(system, state(Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones()), {.duration = 1.2e-3, .flow = flow});
    ASSERT_EQ(run.events.size(), 1U) << tolerance;
    EXPECT_EQ(run.events[0].kind, EventKind::kRelease);
    EXPECT_NEAR(run.events[0].time, release, 1e-8);  // K's rounding: 2e-16 · stiff/soft of the time
    EXPECT_LT(run.statistics.steps, 50'000);
  }
}

TEST(Extremes, AMassThatHardlyAnythingHoldsLosesNothing) {
  // Friction 1 moves a mass 1 on a spring k for 50 units, by 2/k sin²(wt/2), w² = k: little of the 1/k at which the
  // spring would hold it. As the sum of that and of free motion, both 10¹² m, the place would be off by 1e-4. A second
  // mass that all but moves with the belt makes windows short.
  const double duration = 50.0;
  for (const double k : {1e-6, 1e-9, 1e-12}) {
    SCOPED_TRACE(k);
    const HybridSystem system(
        fem::masses({.mass = {1.0, 1.0}, .links = {{0, 1, k, 0.0}, {0, 2, 1.0, 0.0}}}),
        {{Eigen::VectorXd::Unit(2, 0), Coulomb{1.0, 1.0}, 1.0}, {Eigen::VectorXd::Unit(2, 1), Coulomb{0.5, 0.5}, 1.0}},
        Belt::constant(60.0));
    const Trajectory run =
        simulate(system, state(Eigen::Vector2d(0.0, 0.5), Eigen::Vector2d(0.0, 59.9)), {.duration = duration});
    EXPECT_TRUE(run.events.empty());
    EXPECT_GT(run.statistics.steps, 10);
    const double w = std::sqrt(k), half = std::sin(w * duration / 2.0);
    EXPECT_NEAR(run.final_state.q(0), 2.0 / k * half * half, 1e-11);
    EXPECT_NEAR(run.final_state.v(0), std::sin(w * duration) / w, 1e-12);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-13);
  }
}

TEST(Extremes, ALooseToleranceMakesNoEventStormOfARelease) {
  // Sliding starts as a double root of v_rel: an error of the first step must not be taken for its end.
  // Slips per unit of time: 0.098 by an independent fixed-step program; records this long scatter by 0.0018 (standard
  // deviation over 24 starts), four of which are allowed.
  const HybridSystem chain = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2));
  for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
    const Trajectory run = simulate(
        chain, chain.rest(),
        {.duration = 1e5, .transient = 5e3, .flow = {.method = FlowMethod::kCollocation, .tolerance = tolerance}});
    const auto slips = std::count_if(run.events.begin(), run.events.end(),
                                     [](const Event& e) { return e.kind == EventKind::kRelease; });
    EXPECT_NEAR(static_cast<double>(slips) / 9.5e4, 0.098, 0.0073) << tolerance;
  }
}

TEST(Extremes, ALongChainStartsWithoutFormingShapes) {
  const HybridSystem chain =
      belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2), 400, 0.006, 3.0, std::vector<double>{0.25});
  const State start = chain.rest();
  const Trajectory all = simulate(chain, start, {.duration = 60.0, .sample = 5.0});
  const Trajectory contacts =
      simulate(chain, start, {.duration = 60.0, .sample = 5.0, .output = SimulateOptions::Output::kContacts});
  ASSERT_GE(all.events.size(), 4u);
  ASSERT_EQ(all.events.size(), contacts.events.size());
  for (std::size_t i = 0; i < all.events.size(); ++i) EXPECT_NEAR(all.events[i].time, contacts.events[i].time, 1e-8);
  EXPECT_LT((all.contact_q - contacts.contact_q).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Extremes, ThousandsOfMassesMoveAtFirstAsAHundredDo) {
  // Nothing travels faster than about one mass per unit of time: until a wave is back from the far end (after some 2n
  // units), the length of the chain cannot be felt.
  const auto motion = [](int masses) {
    const HybridSystem chain = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2), masses, 0.006, 3.0, {0.25});
    return simulate(
        chain, chain.rest(),
        {.duration = 30.0, .sample = 0.5, .output = SimulateOptions::Output::kContacts, .flow = {.tolerance = 1e-12}});
  };
  const Trajectory expected = motion(100);
  ASSERT_GE(expected.events.size(), 4u);
  for (const int masses : {1000, 10000}) {
    const Trajectory found = motion(masses);
    ASSERT_EQ(found.events.size(), expected.events.size()) << masses;
    for (std::size_t i = 0; i < found.events.size(); ++i)
      EXPECT_NEAR(found.events[i].time, expected.events[i].time, 1e-9) << masses;
    EXPECT_LT((found.contact_q - expected.contact_q).cwiseAbs().maxCoeff(), 1e-9) << masses;
  }
}

}  // namespace
}  // namespace slipmode::dynamics
