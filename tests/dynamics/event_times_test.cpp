// Event times and states against the Taylor reference of tests/fixtures/ (long double, no shared code), over horizons
// in which chaos does not amplify a difference of 1e-12 to the tolerance.
#include "fixtures/against_reference.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;
using friction::TanhRegularised;

constexpr FlowOptions kTightSteps{.method = FlowMethod::kCollocation, .tolerance = 1e-13};
constexpr FlowOptions kExact{.method = FlowMethod::kClosedForm};

void expect_close(const HybridSystem& system, const State& start, double duration, const FlowOptions& flow,
                  std::size_t least_events, double tolerance = 1e-9) {
  EXPECT_GE(expect_near_reference(system, start, duration, flow, {tolerance, tolerance}), least_events);
}

/// A run, its states at events, and how far from its end the ends are of the runs taken up at every so manyeth of them.
struct TakenUp {
  Trajectory run;
  std::vector<State> states;
  double apart = 0.0;

  TakenUp(const HybridSystem& system, const State& start, SimulateOptions options, std::size_t every) {
    options.on_event = [&](const Event&, const State& at) {
      states.push_back(at);
      return true;
    };
    run = simulate(system, start, options);
    options.on_event = {};
    const double end = start.time + options.duration;
    for (std::size_t k = 0; k < states.size(); k += every) {
      options.duration = end - states[k].time;
      apart = std::max(apart, (simulate(system, states[k], options).final_state.q - run.final_state.q).norm());
    }
  }
};

TEST(EventTimes, StribeckChainAgreesWithTheReference) {
  const HybridSystem chain = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2));
  expect_close(chain, chain.rest(), 150.0, kTightSteps, 4);
  for (const std::uint64_t seed : {1u, 2u, 3u}) expect_close(chain, swinging(10, seed, 1.5), 100.0, kTightSteps, 8);
}

TEST(EventTimes, CoulombChainAgreesWithTheReferenceByBothFlows) {
  const HybridSystem chain = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.2));
  for (const FlowOptions& flow : {kExact, kTightSteps}) {
    expect_close(chain, chain.rest(), 150.0, flow, 4);
    for (const std::uint64_t seed : {1u, 2u, 3u}) expect_close(chain, swinging(10, seed, 1.5), 100.0, flow, 8);
  }
}

TEST(EventTimes, HundredMassesOnGroundSpringsAgreeWithTheReference) {
  const HybridSystem chain =
      belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2), 100, 0.006, 3.0, std::vector<double>{0.25});
  expect_close(chain, chain.rest(), 100.0, kTightSteps, 10);
}

HybridSystem three_contacts(const friction::Law& a, const friction::Law& b, const friction::Law& c, Belt belt) {
  return {fem::chain({.masses = 8, .mass = {1, 2, 1, 0.5, 1, 1.5, 1, 1}, .damping = 0.01}),
          {{unit(8, 7), a, 1.0}, {unit(8, 3), b, 0.6}, {unit(8, 0), c, 0.4}},
          belt};
}

TEST(EventTimes, SeveralContactsAgreeWithTheReference) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const State start = swinging(8, seed, 1.0);
    const HybridSystem coulomb =
        three_contacts(Coulomb{0.5, 0.3}, Coulomb{0.3, 0.3}, Coulomb{0.6, 0.1}, Belt::constant(0.3));
    expect_close(coulomb, start, 60.0, kExact, 20);
    expect_close(coulomb, start, 60.0, kTightSteps, 20);
    expect_close(
        three_contacts(Stribeck{0.5, 0.3, 5.0}, Coulomb{0.3, 0.3}, Stribeck{0.6, 0.1, 2.0}, Belt::constant(0.3)), start,
        60.0, kTightSteps, 20);
  }
}

TEST(EventTimes, RampedBeltAgreesWithTheReference) {
  const Belt ramp = Belt::ramp(0.5, -0.3, 7.0, 61.0);
  expect_close(belt_chain(Stribeck{0.4, 0.2, 8.0}, ramp), swinging(10, 1, 1.0), 100.0, kTightSteps, 8);
  for (const FlowOptions& flow : {kExact, kTightSteps}) {
    expect_close(belt_chain(Coulomb{0.4, 0.2}, ramp), swinging(10, 2, 1.0), 100.0, flow, 8);
    expect_close(three_contacts(Coulomb{0.5, 0.3}, Coulomb{0.3, 0.3}, Coulomb{0.6, 0.1}, ramp), swinging(8, 3, 1.0),
                 60.0, flow, 15);
  }
}

TEST(EventTimes, ContactDirectionOverSeveralMassesAgreesWithTheReference) {
  // A direction that touches several masses, scaled: nothing in the theory asks for a unit vector.
  Eigen::VectorXd w = Eigen::VectorXd::Zero(6);
  w << 0.0, 0.3, 0.0, -0.7, 0.0, 2.0;
  const HybridSystem system(fem::chain({.masses = 6, .damping = 0.02}), {{w, Stribeck{0.4, 0.25, 4.0}, 1.2}},
                            Belt::constant(0.25));
  for (const std::uint64_t seed : {1u, 2u}) expect_close(system, swinging(6, seed, 0.8), 80.0, kTightSteps, 8);
}

TEST(EventTimes, ReversalsUnderNextToNoFrictionAreLocatedAndTakenUp) {
  // A chain that swings by 1 m/s. Collocation located a reversal until what is left was little beside the curvature
  // that friction makes: 9e-10 s off; putting the contact at rest there hid it.
  for (const double load : {1e-6, 1e-9}) {
    const friction::Coulomb weak{0.5, 0.3};
    const HybridSystem system(
        fem::chain({.masses = 6, .ground_stiffness = {0.3}, .damping = 0.01}),
        {{Eigen::VectorXd::Unit(6, 1), weak, 2.0 * load}, {Eigen::VectorXd::Unit(6, 4), weak, load}},
        Belt::constant(0.0));
    const State start = swinging(6, 2, 0.7);
    const double duration = 30.0;
    const Trajectory exact = simulate(system, start, {.duration = duration});
    EXPECT_EQ(exact.events.size(), 20U);
    for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
      const TakenUp again(system, start, {.duration = duration, .flow = {.method = method}}, 1);
      ASSERT_EQ(again.run.events.size(), exact.events.size());
      for (std::size_t k = 0; k < exact.events.size(); ++k)
        EXPECT_NEAR(again.run.events[k].time, exact.events[k].time, 1e-13) << "event " << k << ", load " << load;
      EXPECT_LT(again.apart, 1e-13);
    }
  }
}

TEST(EventTimes, AtALateClockWhatAGuardRoundsByIsNoFurtherEvent) {
  // At t = 10^5 a phase is told to 10^-11. A speed left off its guard by that was another zero at once, and again, 200
  // times under a force; runs taken up at such an event turned twice.
  Draws random(7);
  for (int trial = 0; trial < 240; ++trial) {
    SCOPED_TRACE(trial);
    const bool forced = trial % 2 == 0;
    const auto power = [&](double least, double most) { return std::pow(10.0, random.uniform(least, most)); };
    const auto masses = static_cast<Eigen::Index>(random.uniform(2.0, 7.0));
    const Coulomb law{random.uniform(0.3, 0.8), random.uniform(0.1, 0.3)};
    const double load = power(-6.0, 0.3), omega = random.uniform(0.3, 3.0);
    const std::vector<friction::Contact> contacts{{Eigen::VectorXd::Unit(masses, masses - 1), law, load},
                                                  {Eigen::VectorXd::Unit(masses, 0), law, 0.7 * load}};
    const fem::Structure chain =
        fem::chain({.masses = static_cast<int>(masses), .ground_stiffness = {0.4}, .damping = 1e-3});
    const friction::Force force{omega, {{.amplitude = 1.5, .phase = 1.0}, {.amplitude = 0.6, .order = 3}}};
    const HybridSystem system =
        forced ? HybridSystem(chain, contacts, force, {}, Eigen::MatrixXd(Eigen::VectorXd::Unit(masses, 0)))
               : HybridSystem(chain, contacts, friction::Shaker{power(-2.0, 1.0), omega / 6.28, 2.0});
    State start = state(random.vector(masses, 1.0), random.vector(masses, 1.0));
    start.time = 1e5;
    const TakenUp again(system, start, {.duration = 12.0, .flow = {.method = FlowMethod::kClosedForm}}, 5);
    EXPECT_LT(std::abs(again.run.audit.residual()), 1e-9);
    EXPECT_LT(again.apart, 1e-8);
  }
}

TEST(EventTimes, ContactsThatAShakerTurnsAlmostAtOnceTurnInTheirOrder) {
  // Next to no friction: two to five contacts turn where the shaker does, 1e-11 to 1e-7 s apart; on a chain, or on
  // masses of their own of which the last rings on a spring of up to 10^5. At any event, none is past its own turn by
  // more than what speeds of this size, and a shaker's at this time, are told from zero to.
  Draws random(11);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const auto power = [&](double least, double most) { return std::pow(10.0, random.uniform(least, most)); };
    const auto masses = static_cast<Eigen::Index>(random.uniform(2.0, 6.0));
    const bool rings = trial % 2 == 1;
    const double load = power(-9.0, rings ? -5.0 : -3.0);
    std::vector<friction::Contact> contacts;
    for (Eigen::Index c = 0; c < masses; ++c)
      contacts.push_back({Eigen::VectorXd::Unit(masses, c), Coulomb{random.uniform(0.3, 0.8), random.uniform(0.1, 0.3)},
                          load * random.uniform(0.5, 1.5)});
    const friction::Shaker shaker{power(-3.0, 2.0), random.uniform(0.05, 0.5), 2.0};
    Eigen::VectorXd springs = Eigen::VectorXd::Constant(masses, 1.0) + random.vector(masses, 0.8);
    springs(masses - 1) = power(1.0, 5.0);
    const fem::Structure structure =
        rings
            ? fem::Structure{fem::Matrix(Eigen::MatrixXd::Identity(masses, masses)),
                             fem::Matrix(1e-3 * Eigen::MatrixXd::Identity(masses, masses)),
                             fem::Matrix(springs.asDiagonal().toDenseMatrix())}
            : fem::chain({.masses = static_cast<int>(masses), .ground_stiffness = {0.4}, .damping = power(-4.0, -1.0)});
    const HybridSystem system(structure, contacts, shaker);
    State start = system.rest();
    if (rings) start.v = shaker.amplitude * random.vector(masses, power(-9.0, -5.0));
    if (!rings && trial % 3 > 0) start.time = power(0.0, 5.0);
    std::size_t events = 0;
    for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
      const TakenUp again(system, start, {.duration = 10.0, .flow = {.method = method, .tolerance = 1e-12}}, 3);
      EXPECT_LT(again.apart, 1e-9 * again.run.final_state.q.norm());
      EXPECT_TRUE(events == 0 || events == again.states.size()) << events << " and " << again.states.size();
      events = again.states.size();
      for (const State& at : again.states)
        for (std::size_t c = 0; c < contacts.size(); ++c) {
          const double rounding =
              2e-12 * shaker.amplitude * shaker.omega() + 1e-15 * std::abs(shaker.acceleration(at.time)) * at.time;
          const double sliding = shaker.velocity(at.time) - contacts[c].direction.dot(at.v);
          EXPECT_GE(sign_of(at.modes[c]) * sliding, -rounding) << "contact " << c << " at t = " << at.time;
        }
    }
  }
}

TEST(EventTimes, ARunThatEndsBesideAnEventHasItOrNot) {
  for (int trial = 0; trial < 24; ++trial)
    for (const FlowOptions& flow : {kExact, FlowOptions{.method = FlowMethod::kCollocation, .tolerance = 1e-11}}) {
      SCOPED_TRACE(trial);
      const int masses = 1 + trial % 4;
      const HybridSystem chain = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.3), masses, 0.006, 0.5);
      const State start = swinging(masses, 7 + static_cast<std::uint64_t>(trial / 4), 1.0);
      const Trajectory run = simulate(chain, start, {.duration = 10.0, .flow = flow});
      for (std::size_t k = 0; k < run.events.size(); ++k)
        for (const double beside : {-1e-6, -1e-8, -1e-10, 1e-10, 1e-8, 1e-6}) {
          const double end = run.events[k].time + beside;
          const Trajectory part = simulate(chain, start, {.duration = end, .flow = flow});
          EXPECT_EQ(part.events.size(), beside < 0.0 ? k : k + 1) << beside << " beside t = " << run.events[k].time;
          EXPECT_EQ(part.final_state.time, end);
          const Trajectory rest = simulate(chain, part.final_state, {.duration = 10.0 - end, .flow = flow});
          EXPECT_EQ(part.events.size() + rest.events.size(), run.events.size());
          EXPECT_LT((rest.final_state.q - run.final_state.q).norm(), 1e-8);
        }
    }
}

TEST(EventTimes, WhatTurnsWhereARunGoesOnIsAnEventThere) {
  // Cut so shortly before a turn that the rest starts with it: told by neither part before, and in no monodromy.
  int events = 0;
  for (const friction::Law& law : std::vector<friction::Law>{Coulomb{0.4, 0.2}, Stribeck{0.4, 0.2, 8.0}})
    for (const FlowOptions& flow : {kExact, kTightSteps}) {
      if (flow.method == FlowMethod::kClosedForm && !std::holds_alternative<Coulomb>(law)) continue;
      for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        const HybridSystem chain = belt_chain(law, Belt::constant(0.3), 3, 0.02, 0.5);
        const State start = swinging(3, seed, 1.0);
        const TangentResult whole = tangent_flow(chain, start, 8.0, flow);
        for (std::size_t k = 0; k < whole.events.size(); ++k) {
          SCOPED_TRACE(whole.events[k].time);
          if (whole.events[k].before == ContactMode::kStick) continue;  // a limit is reached, not turned at
          ++events;
          const double cut = whole.events[k].time - 1e-13;
          const TangentResult first = tangent_flow(chain, start, cut, flow);
          const TangentResult rest = tangent_flow(chain, first.end, 8.0 - cut, flow);
          EXPECT_EQ(first.events.size(), k);
          ASSERT_EQ(first.events.size() + rest.events.size(), whole.events.size());
          EXPECT_NEAR(rest.events[0].time, whole.events[k].time, 2e-13);
          EXPECT_EQ(rest.events[0].kind, whole.events[k].kind);
          EXPECT_LT((rest.monodromy * first.monodromy - whole.monodromy).norm(), 1e-8 * whole.monodromy.norm());
        }
      }
    }
  EXPECT_GT(events, 20);
}

TEST(EventTimes, WhatStartsToStickOffTheBeltsSpeedIsPutOnIt) {
  // A step of 1e-14 s held it there by a force beyond its limit: a release that was none.
  for (const double load : {1.0, 1e-2})
    for (const double off : {1e-14, 1e-13, 3e-13})
      for (const double duration : {1e-14, 1.0})
        for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
          const HybridSystem system(fem::chain({.masses = 1, .ground_stiffness = {0.4}, .damping = 0.0}),
                                    {{unit(1, 0), Coulomb{0.5, 0.3}, load}}, Belt::constant(0.0));
          State start = state(Eigen::VectorXd::Constant(1, 0.4 * load / 1.4), Eigen::VectorXd::Constant(1, off));
          start.modes = {ContactMode::kStick};
          const Trajectory run =
              simulate(system, start, {.duration = duration, .flow = {.method = method, .tolerance = 1e-12}});
          EXPECT_TRUE(run.events.empty()) << off << " in " << duration;
          EXPECT_EQ(run.final_state.v(0), 0.0);
        }
}

TEST(EventTimes, WhatStartsAMomentPastAShakersSpeedGoesOn) {
  // Its turn was told again and again at the start: it was not told from zero, and kept its sign.
  for (const double place : {-1.0, -10.0})
    for (const double off : {1e-12, 1e-13, 2e-14, -1e-13})
      for (const double duration : {1e-14, 1e-13, 1.0}) {
        const HybridSystem system(fem::chain({.masses = 1, .ground_stiffness = {0.4}, .damping = 0.01}),
                                  {{unit(1, 0), Coulomb{0.1, 0.1}, 0.2}}, friction::Shaker{0.02, 0.4, 1.8});
        const State start = state(Eigen::VectorXd::Constant(1, place),
                                  Eigen::VectorXd::Constant(1, system.drive().velocity(0.0) - off));
        const auto end = [&](FlowMethod method) {
          return simulate(system, start, {.duration = duration, .flow = {.method = method, .tolerance = 1e-12}})
              .final_state;
        };
        const State exact = end(FlowMethod::kClosedForm), stepped = end(FlowMethod::kCollocation);
        EXPECT_NEAR(stepped.q(0), exact.q(0), 1e-10 * std::abs(place));
        EXPECT_NEAR(stepped.v(0), exact.v(0), 1e-10 * std::abs(place));
      }
}

TEST(EventTimes, TanhLawAgreesWithTheReference) {
  for (const double epsilon : {0.3, 0.03}) {
    const HybridSystem chain = belt_chain(TanhRegularised{0.4, 0.2, 8.0, epsilon}, Belt::constant(0.2));
    expect_close(chain, swinging(10, 1, 1.0), 40.0, kTightSteps, 0);
  }
}

TEST(EventTimes, PeriodOneOrbitHasThePeriodOfTheReference) {
  // Belt speed 0.45: period 45.10211 by an independent fixed-step program, 45.102108972 from the Taylor
  // reference after 60,000 units from rest.
  const HybridSystem chain = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.45));
  const Trajectory run =
      simulate(chain, chain.rest(), {.duration = 60000.0, .transient = 59000.0, .flow = {.tolerance = 1e-11}});
  std::vector<const Event*> releases;
  for (const Event& event : run.events) {
    if (event.kind == EventKind::kRelease) releases.push_back(&event);
  }
  ASSERT_GE(releases.size(), 20u);
  EXPECT_NEAR((releases.back()->time - releases.front()->time) / static_cast<double>(releases.size() - 1), 45.102108972,
              1e-7);
  EXPECT_NEAR(releases.back()->displacement, 10.757284, 1e-5);
}

}  // namespace
}  // namespace slipmode::dynamics
