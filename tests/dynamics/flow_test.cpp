// What a run promises whatever the scene: sampling, restarts, guards, repeatability, accuracy that follows tolerance.
#include <slipmode/core/errors.hpp>
#include "fixtures/against_reference.hpp"
#include "fixtures/shaken_scenes.hpp"

#include <gtest/gtest.h>
#include <cstring>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;

bool same_bytes(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

HybridSystem stribeck_chain() { return belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2)); }
HybridSystem coulomb_chain() { return belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.2)); }

TEST(Flow, ClosedFormAndCollocationAgree) {
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed, Laws::kCoulombOnly, 20);
    const SimulateOptions options{.duration = 8.0, .sample = 0.5};
    SimulateOptions exact = options, collocated = options;
    exact.flow = {.method = FlowMethod::kClosedForm};
    collocated.flow = {.method = FlowMethod::kCollocation, .tolerance = 1e-13};
    const Trajectory a = simulate(scene.system, scene.start, exact),
                     b = simulate(scene.system, scene.start, collocated);
    EXPECT_EQ(mode_changes(a.events).size(), mode_changes(b.events).size());
    EXPECT_LT((a.q - b.q).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((a.v - b.v).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((a.lambda - b.lambda).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(Flow, SamplingDoesNotChangeTheTrajectory) {
  for (const HybridSystem& chain : {stribeck_chain(), coulomb_chain()}) {
    const State start = swinging(10, 3, 1.0);
    const Trajectory plain = simulate(chain, start, {.duration = 500.0});
    for (const double sample : {0.013, 0.5, 7.7}) {
      const Trajectory sampled = simulate(chain, start, {.duration = 500.0, .sample = sample});
      EXPECT_TRUE(same_bytes(plain.final_state.q, sampled.final_state.q)) << sample;
      ASSERT_EQ(plain.events.size(), sampled.events.size());
      for (std::size_t i = 0; i < plain.events.size(); ++i) EXPECT_EQ(plain.events[i].time, sampled.events[i].time);
    }
  }
}

TEST(Flow, SamplesOfAnyDensityLieOnTheSameTrajectory) {
  const HybridSystem chain = stribeck_chain();
  const State start = swinging(10, 3, 1.0);
  const Trajectory fine = simulate(chain, start, {.duration = 60.0, .sample = 0.01});
  const Trajectory coarse = simulate(chain, start, {.duration = 60.0, .transient = 20.0, .sample = 0.25});
  ASSERT_GE(coarse.times.size(), 160);
  EXPECT_DOUBLE_EQ(coarse.times[0], 20.0);
  for (Eigen::Index k = 0; k < coarse.times.size(); ++k) {
    const Eigen::Index other = 2000 + 25 * k;
    ASSERT_NEAR(fine.times[other], coarse.times[k], 1e-10);
    ASSERT_LT((fine.q.col(other) - coarse.q.col(k)).cwiseAbs().maxCoeff(), 1e-11);
  }
  for (const Event& event : coarse.events) EXPECT_GE(event.time, 20.0);
}

TEST(Flow, SamplesAgreeWithTheReferenceBetweenEvents) {
  const HybridSystem chain = stribeck_chain();
  const State start = swinging(10, 6, 1.2);
  const Trajectory run = simulate(chain, start, {.duration = 40.0, .sample = 1.7, .flow = {.tolerance = 1e-13}});
  for (Eigen::Index k = 1; k < run.times.size(); ++k) {
    TaylorReference<long double> reference(reference_of(chain));
    const ReferenceRun expected = reference.run(start.q, start.v, 0.0, run.times[k]);
    ASSERT_LT((run.q.col(k) - expected.q).cwiseAbs().maxCoeff(), 1e-9) << run.times[k];
    ASSERT_LT((run.v.col(k) - expected.v).cwiseAbs().maxCoeff(), 1e-9) << run.times[k];
  }
}

TEST(Flow, ARunOfNoLengthHasItsStartForASample) {
  const HybridSystem system = fixtures::belt_chain(friction::Coulomb{0.4, 0.2}, friction::Belt::constant(0.3), 4);
  const State start = fixtures::swinging(4, 1, 1.0);
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const Trajectory run = simulate(system, start, {.duration = 0.0, .sample = 0.1, .flow = {.method = method}});
    ASSERT_EQ(run.times.size(), 1);
    EXPECT_LT((run.q.col(0) - start.q).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((run.v.col(0) - start.v).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Flow, ARunThatEndsAMomentAfterAnEventHasNoOther) {
  int ends = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    ends += end_a_moment_after_events(random_scene(seed, Laws::kAll, 6), 10.0, FlowMethod::kCollocation);
  }
  EXPECT_GT(ends, 1000);
}

TEST(Flow, ContactOutputIsTheProjectionOfTheFullOutput) {
  const HybridSystem chain = stribeck_chain();
  const State start = swinging(10, 3, 1.0);
  const Trajectory all = simulate(chain, start, {.duration = 100.0, .sample = 0.3});
  const Trajectory contacts =
      simulate(chain, start, {.duration = 100.0, .sample = 0.3, .output = SimulateOptions::Output::kContacts});
  EXPECT_EQ(contacts.q.size(), 0);
  ASSERT_EQ(contacts.contact_q.cols(), all.q.cols());
  EXPECT_LT((contacts.contact_q.row(0) - all.q.row(9)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((contacts.contact_v.row(0) - all.v.row(9)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((contacts.lambda - all.lambda).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Flow, ARestartFromAnEventReproducesTheRest) {
  for (const HybridSystem& chain : {stribeck_chain(), coulomb_chain()}) {
    std::vector<State> states;
    SimulateOptions options{.duration = 120.0, .flow = {.tolerance = 1e-13}};
    options.on_event = [&](const Event&, const State& at) {
      states.push_back(at);
      return true;
    };
    const Trajectory whole = simulate(chain, swinging(10, 1, 1.5), options);
    ASSERT_EQ(states.size(), whole.events.size());
    ASSERT_GE(states.size(), 8u);
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
      const Trajectory rest =
          simulate(chain, states[i], {.duration = 120.0 - states[i].time, .flow = {.tolerance = 1e-13}});
      ASSERT_EQ(rest.events.size(), whole.events.size() - i - 1) << "from event " << i;
      for (std::size_t j = 0; j < rest.events.size(); ++j) {
        EXPECT_NEAR(rest.events[j].time, whole.events[i + 1 + j].time, 1e-9);
        EXPECT_EQ(rest.events[j].kind, whole.events[i + 1 + j].kind);
      }
      EXPECT_LT((rest.final_state.q - whole.final_state.q).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(Flow, ARunGoesOnFromItsOwnEndWhereverThatIs) {
  // Ends in slip, in stick and between the nodes of a step alike; the whole run is the expected value.
  for (const HybridSystem& chain : {stribeck_chain(), coulomb_chain()}) {
    const FlowOptions flow{.tolerance = 1e-8};
    const State start = swinging(10, 1, 1.5);
    const Trajectory whole = simulate(chain, start, {.duration = 40.0, .flow = flow});
    int stuck = 0;
    for (double end = 0.37; end < 39.0; end += 1.31) {
      const Trajectory first = simulate(chain, start, {.duration = end, .flow = flow});
      stuck += first.final_state.modes.at(0) == ContactMode::kStick ? 1 : 0;
      const Trajectory rest = simulate(chain, first.final_state, {.duration = 40.0 - end, .flow = flow});
      EXPECT_EQ(first.events.size() + rest.events.size(), whole.events.size()) << "cut at " << end;
      EXPECT_LT((rest.final_state.q - whole.final_state.q).cwiseAbs().maxCoeff(), 1e-6) << "cut at " << end;
    }
    EXPECT_GE(stuck, 5);
  }
}

TEST(Flow, StopsWhereTheCallbackSaysSo) {
  int seen = 0;
  SimulateOptions options{.duration = 1000.0};
  options.on_event = [&](const Event&, const State&) { return ++seen < 3; };
  const Trajectory run = simulate(stribeck_chain(), swinging(10, 1, 1.5), options);
  ASSERT_EQ(run.events.size(), 3u);
  EXPECT_NEAR(run.final_state.time, run.events.back().time, 1e-12);
}

TEST(Flow, EventStatesLieOnTheirGuard) {
  const Trajectory run = simulate(stribeck_chain(), swinging(10, 1, 1.5), {.duration = 500.0, .event_states = true});
  ASSERT_EQ(run.event_v.cols(), static_cast<Eigen::Index>(run.events.size()));
  for (std::size_t i = 0; i < run.events.size(); ++i) {
    EXPECT_NEAR(run.event_v(9, static_cast<Eigen::Index>(i)), 0.2, 1e-13);
  }
}

TEST(Flow, AStartOnTheGuardIsDecidedByConsistency) {
  // One mass, k = 1, μ_s N = 0.4, belt 0.1, v = 0.1: sticks while |x| ≤ 0.4, else slips the way the spring pulls.
  for (const auto flow :
       {FlowOptions{.method = FlowMethod::kClosedForm}, FlowOptions{.method = FlowMethod::kCollocation}}) {
    const HybridSystem system = oscillator(1.0, 1.0, 0.0, Coulomb{0.4, 0.2}, 1.0, Belt::constant(0.1));
    const auto first_mode = [&](double x) {
      const State start = state(Eigen::VectorXd::Constant(1, x), Eigen::VectorXd::Constant(1, 0.1));
      return simulate(system, start, {.duration = 1e-3, .flow = flow}).final_state.modes.at(0);
    };
    EXPECT_EQ(first_mode(0.0), ContactMode::kStick);
    EXPECT_EQ(first_mode(-0.39), ContactMode::kStick);
    EXPECT_EQ(first_mode(0.39), ContactMode::kStick);
    EXPECT_EQ(first_mode(0.41), ContactMode::kSlipPositive);
    EXPECT_EQ(first_mode(-0.41), ContactMode::kSlipNegative);
    // Exactly at the limit with the force growing (belt moves up): it must let go, now or at the first event.
    EXPECT_EQ(first_mode(0.4), ContactMode::kSlipPositive);
    EXPECT_EQ(first_mode(-0.4), ContactMode::kStick);
  }
}

TEST(Flow, AStartThatViolatesItsModesIsRefused) {
  const HybridSystem system = oscillator(1.0, 1.0, 0.0, Coulomb{0.4, 0.2}, 1.0, Belt::constant(0.1));
  State start = state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.5));
  start.modes = {ContactMode::kStick};
  EXPECT_THROW((void)simulate(system, start, {.duration = 1.0}), InvalidInput);
  start.modes = {ContactMode::kSlipPositive};  // v_rel = −0.4
  EXPECT_THROW((void)simulate(system, start, {.duration = 1.0}), InvalidInput);
  start.modes = {ContactMode::kSlipNegative, ContactMode::kStick};
  EXPECT_THROW((void)simulate(system, start, {.duration = 1.0}), InvalidInput);
}

TEST(Flow, RepeatsByteForByte) {
  for (int which = 0; which < 2; ++which) {
    const auto make = [&] { return which == 0 ? stribeck_chain() : coulomb_chain(); };
    const State start = swinging(10, 9, 1.0);
    const HybridSystem first = make();
    const SimulateOptions options{.duration = 300.0, .sample = 0.5};
    const Trajectory a = simulate(first, start, options), b = simulate(first, start, options);
    const Trajectory c = simulate(make(), start, options);
    for (const Trajectory* other : {&b, &c}) {
      EXPECT_TRUE(same_bytes(a.q, other->q));
      EXPECT_TRUE(same_bytes(a.v, other->v));
      EXPECT_TRUE(same_bytes(a.lambda, other->lambda));
      EXPECT_EQ(a.audit.friction_loss, other->audit.friction_loss);
    }
  }
}

TEST(Flow, ASystemUnderAnotherDriveIsASystemBuiltWithThatDrive) {
  const State start = swinging(10, 9, 1.0);
  const HybridSystem shared = stribeck_chain().with_drive(Belt::constant(0.37));
  const HybridSystem built = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.37));
  const Trajectory a = simulate(shared, start, {.duration = 200.0}), b = simulate(built, start, {.duration = 200.0});
  EXPECT_TRUE(same_bytes(a.final_state.q, b.final_state.q));
}

TEST(Flow, ErrorShrinksWithTheTolerance) {
  const HybridSystem chain = stribeck_chain();
  const State start = swinging(10, 1, 1.5);
  TaylorReference<long double> reference(reference_of(chain));
  const ReferenceRun expected = reference.run(start.q, start.v, 0.0, 60.0);
  ASSERT_GE(expected.events.size(), 5u);
  double last = 1.0;
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11, 1e-13}) {
    const Trajectory run = simulate(
        chain, start, {.duration = 60.0, .flow = {.method = FlowMethod::kCollocation, .tolerance = tolerance}});
    const double error = (run.final_state.q - expected.q).cwiseAbs().maxCoeff();
    // Local errors add up over about 100 steps and grow a little with the flow: within 100 tolerances and rounding.
    EXPECT_LT(error, 100.0 * tolerance + 1e-11) << tolerance;
    // Loose tolerances are outdone: there the steepness of the law limits the steps.
    EXPECT_LE(error, std::max(last, 1e-11)) << tolerance;
    last = error;
  }
}

TEST(Flow, TheEnergyAuditDoesNotChangeTheTrajectory) {
  const State start = swinging(10, 9, 1.0);
  const Trajectory with = simulate(stribeck_chain(), start, {.duration = 300.0});
  const Trajectory without = simulate(stribeck_chain(), start, {.duration = 300.0, .flow = {.audit = false}});
  EXPECT_TRUE(same_bytes(with.final_state.q, without.final_state.q));
}

TEST(Flow, RegimesAreBuiltWhenFirstVisited) {
  // A belt far faster than the structure: the contact never sticks, so no stick regime is needed.
  const HybridSystem fast = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(50.0));
  const Trajectory run = simulate(fast, fast.rest(), {.duration = 100.0, .flow = {.method = FlowMethod::kClosedForm}});
  EXPECT_LE(run.statistics.regimes_built, 1);
  EXPECT_EQ(run.statistics.events, 0);
}

// A run stopped anywhere ends on its guards: stuck contacts move with the belt to rounding, and sliding ones slide as
// their mode says, so that it can be gone on from with the modes it had.
TEST(Flow, EndsInAStateThatARunCanStartFrom) {
  int stuck = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = random_scene(seed, Laws::kRigid, 12);
    const Trajectory run = simulate(scene.system, scene.start, {.duration = 3.0 + 0.01 * static_cast<double>(seed)});
    const State& end = run.final_state;
    const double belt = scene.system.drive().velocity(end.time);
    for (std::size_t c = 0; c < end.modes.size(); ++c) {
      const Eigen::VectorXd& w = scene.system.contacts()[c].direction;
      const double scale = std::abs(belt) + w.cwiseAbs().dot(end.v.cwiseAbs());
      const double sliding = belt - w.dot(end.v);
      if (end.modes[c] == ContactMode::kStick) {
        ++stuck;
        EXPECT_LE(std::abs(sliding), 1e-15 * scale);
      } else if (end.modes[c] == ContactMode::kSlipPositive) {
        EXPECT_GE(sliding, -1e-15 * scale);
      }
    }
    EXPECT_NO_THROW((void)simulate(scene.system, end, {.duration = 1.0}));
  }
  EXPECT_GT(stuck, 20);
}

// A mass pulled through a contact spring slides at a constant μ_k N < μ_s N, the spring's stretch at μ_k N / K_c:
// position, velocity and stretch are those of a stuck contact too. Handed on it goes on sliding, as one run does; with
// modes derived from position, velocity and stretch alone it would stick until μ_s N are reached.
TEST(Flow, HandsOnAContactThatSlidesBehindItsSpring) {
  const HybridSystem system = single_mass(
      1.0, 0.05, 1.0, {.direction = {}, .law = friction::CompliantCoulomb{0.6, 0.2, 20.0}, .normal_load = {1.0}},
      Belt::constant(0.4));
  State state = system.rest();
  for (int k = 0; k < 1000 && (state.modes.empty() || state.modes[0] != ContactMode::kSlipPositive); ++k)
    state = simulate(system, state, {.duration = 0.1}).final_state;
  ASSERT_EQ(state.modes[0], ContactMode::kSlipPositive);
  const State on = handed_on(system, state);
  EXPECT_EQ(on.time, 0.0);
  const State went = simulate(system, state, {.duration = 0.2}).final_state;
  EXPECT_LT((simulate(system, on, {.duration = 0.2}).final_state.q - went.q).norm(), 1e-12);
  State forgotten = on;
  forgotten.modes.clear();
  EXPECT_GT((simulate(system, forgotten, {.duration = 0.2}).final_state.q - went.q).norm(), 1e-5);
}

}  // namespace
}  // namespace slipmode::dynamics
