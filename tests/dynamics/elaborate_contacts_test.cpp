// Contact springs, stops, tilt and loads that vary under the collocation flow, alone and beside laws that depend on the
// sliding speed.
#include <slipmode/core/errors.hpp>
#include "fixtures/against_reference.hpp"
#include "fixtures/differences.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <string>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Clearance;
using friction::CompliantCoulomb;
using friction::ContactLoss;
using friction::Stop;

/// One to five masses in a row, each on a spring of its own.
fem::Structure masses_in_a_row(Draws& random, int n) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(n, n), K = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    M(i, i) = random.uniform(0.5, 2.0);
    K(i, i) += random.uniform(0.2, 1.5);
    if (i + 1 == n) continue;
    const double link = random.uniform(0.5, 2.0);
    K(i, i) += link;
    K(i + 1, i + 1) += link;
    K(i, i + 1) = K(i + 1, i) = -link;
  }
  return {M, Eigen::MatrixXd(0.02 * M + 0.03 * K), K};
}

Clearance random_stops(Draws& random) {
  const auto stop = [&] {
    const double stiffness = random.uniform(0.5, 50.0), damping = random.chance(0.5) ? 0.0 : random.uniform(0.0, 0.5);
    return Stop{stiffness, damping, random.uniform(0.05, 0.6)};
  };
  Clearance law;
  law.loss = random.chance(0.5) ? ContactLoss::kGap : ContactLoss::kZeroForce;
  const int sides = random.integer(0, 2);
  if (sides != 1) law.left = stop();
  if (sides != 2) law.right = stop();
  return law;
}

struct Coefficients {
  double mu_s, mu_k;
};
Coefficients random_coefficients(Draws& random) {
  const double mu_k = random.uniform(0.1, 0.4);
  return {random.chance(0.5) ? mu_k : mu_k + random.uniform(0.0, 0.3), mu_k};
}

friction::Law random_spring(Draws& random) {
  const auto [mu_s, mu_k] = random_coefficients(random);
  return CompliantCoulomb{mu_s, mu_k, random.uniform(0.5, 30.0)};
}

RandomScene under_some_drive(Draws& random, const fem::Structure& structure, std::vector<friction::Contact> contacts) {
  const Eigen::Index n = structure.size();
  friction::Drive drive;
  Eigen::MatrixXd directions;
  const int kind = random.integer(0, 2);
  if (kind == 0) drive = friction::Belt::constant(random.uniform(0.02, 0.4));
  if (kind == 1) {
    const double amplitude = random.uniform(0.1, 0.8);
    drive = friction::Shaker{amplitude, random.uniform(0.05, 0.4)};
  }
  if (kind == 2) {
    const double omega = random.uniform(0.3, 2.0);
    drive = friction::Force{omega, {{.amplitude = random.uniform(0.2, 1.5)}}};
    directions = unit(n, n - 1);
  }
  return {HybridSystem(structure, std::move(contacts), drive, {}, directions), random_state(random, n, 0.4)};
}

/// What the closed form holds too: springs, stops, rigid contacts, some tilted, some under a load that varies with y.
RandomScene piecewise_linear(std::uint64_t seed) {
  Draws random(7000 + seed);
  const int n = random.integer(1, 5), count = random.integer(1, std::min(n, 3));
  const fem::Structure structure = masses_in_a_row(random, n);
  std::vector<friction::Contact> contacts;
  for (int c = 0; c < count; ++c) {
    const int kind = random.integer(0, 2);
    if (kind == 0) {
      contacts.push_back({unit(n, c), random_stops(random)});
      continue;
    }
    const auto [mu_s, mu_k] = random_coefficients(random);
    const friction::Law law = kind == 1 ? random_spring(random) : friction::Coulomb{mu_s, mu_k};
    contacts.push_back({unit(n, c), law});
    friction::Contact& contact = contacts.back();
    if (random.chance(0.25)) {
      const double constant = random.uniform(0.5, 1.5);
      contact.normal_load = {constant, random.uniform(-1.0, 1.0)};
    } else if (random.chance(0.25)) {
      contact.tilt = random.uniform(-0.1, 0.1);
    }
  }
  return under_some_drive(random, structure, contacts);
}

friction::Law speed_dependent(Draws& random) {
  const double mu_k = random.uniform(0.1, 0.4), drop = random.uniform(0.05, 0.3);
  switch (random.integer(0, 3)) {
    case 0:
      return friction::TanhRegularised{mu_k + drop, mu_k, 2.0, 0.05};
    case 1:
      return friction::Dahl{mu_k, random.uniform(5.0, 50.0)};
    case 2: {
      const double stiffness = random.uniform(5.0, 50.0);
      return friction::LuGre{mu_k + drop, mu_k, 0.2, stiffness, random.uniform(0.0, 1.0), 0.1};
    }
    default:
      return friction::Stribeck{mu_k + drop, mu_k, random.uniform(0.5, 5.0)};
  }
}

/// A law of the sliding speed on the first mass; springs, stops and rigid Coulomb friction on others. @param shared  a
/// stop on the first mass too
RandomScene mixed(std::uint64_t seed, bool shared) {
  Draws random(17000 + seed);
  const int n = random.integer(2, 5), others = random.integer(1, std::min(n - 1, 2));
  const fem::Structure structure = masses_in_a_row(random, n);
  std::vector<friction::Contact> contacts = {{unit(n, 0), speed_dependent(random)}};
  if (shared) contacts.push_back({unit(n, 0), random_stops(random)});
  for (int c = 1; c <= others; ++c) {
    const int kind = random.integer(0, 4);
    const auto [mu_s, mu_k] = random_coefficients(random);
    const friction::Law law = kind < 2   ? random_spring(random)
                              : kind < 4 ? friction::Law(random_stops(random))
                                         : friction::Coulomb{mu_s, mu_k};
    contacts.push_back({unit(n, c), law});
  }
  return under_some_drive(random, structure, contacts);
}

constexpr FlowOptions kFine{.method = FlowMethod::kCollocation, .tolerance = 1e-12};

TEST(ElaborateContacts, TheTwoFlowsAgreeWhereLawsArePiecewiseLinear) {
  std::size_t events = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const RandomScene scene = piecewise_linear(seed);
    SimulateOptions options{.duration = 20.0, .sample = 0.37};
    options.flow.method = FlowMethod::kClosedForm;
    const Trajectory exact = simulate(scene.system, scene.start, options);
    options.flow = kFine;
    const Trajectory run = simulate(scene.system, scene.start, options);
    ASSERT_EQ(run.events.size(), exact.events.size()) << "seed " << seed;
    for (std::size_t k = 0; k < run.events.size(); ++k) {
      EXPECT_EQ(run.events[k].contact, exact.events[k].contact) << "seed " << seed;
      EXPECT_EQ(run.events[k].kind, exact.events[k].kind) << "seed " << seed;
      EXPECT_EQ(run.events[k].after, exact.events[k].after) << "seed " << seed;
      EXPECT_NEAR(run.events[k].time, exact.events[k].time, 1e-9) << "seed " << seed;
    }
    EXPECT_LT((run.q - exact.q).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
    EXPECT_LT((run.v - exact.v).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
    if (exact.final_state.internal.size() > 0) {
      EXPECT_LT((run.final_state.internal - exact.final_state.internal).cwiseAbs().maxCoeff(), 1e-9);
    }
    events += run.events.size();
  }
  EXPECT_GT(events, 1500U);
}

TEST(ElaborateContacts, AgreeWithTheTaylorReferenceBesideLawsOfTheSpeed) {
  std::size_t events = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = mixed(seed, seed % 3 == 0);
    events += expect_near_reference(scene.system, scene.start, 15.0, kFine, {.state = 1e-10});
  }
  EXPECT_GT(events, 1000U);
}

TEST(ElaborateContacts, AStopBesideRigidFrictionAtOnePlaceInBothFlows) {
  // A stop that presses as the contact is held on the belt: its force changes though nothing is free to move.
  std::size_t events = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Draws random(27000 + seed);
    const int n = random.integer(1, 3);
    const fem::Structure structure = masses_in_a_row(random, n);
    const auto [mu_s, mu_k] = random_coefficients(random);
    const Clearance stops = random_stops(random);
    const RandomScene scene =
        under_some_drive(random, structure, {{unit(n, 0), friction::Coulomb{mu_s, mu_k}}, {unit(n, 0), stops}});
    const Trajectory exact = simulate(scene.system, scene.start, {.duration = 20.0});
    const Trajectory run = simulate(scene.system, scene.start, {.duration = 20.0, .flow = kFine});
    EXPECT_EQ(run.events.size(), exact.events.size()) << "seed " << seed;
    EXPECT_LT((run.final_state.q - exact.final_state.q).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
    EXPECT_LT((run.final_state.v - exact.final_state.v).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
    EXPECT_LT(std::abs(exact.audit.residual()), 1e-10) << "seed " << seed;
    EXPECT_LT(std::abs(run.audit.residual()), 1e-10) << "seed " << seed;
    events += exact.events.size();
  }
  EXPECT_GT(events, 500U);
}

TEST(ElaborateContacts, ARunThatEndsAMomentAfterAnEventHasNoOther) {
  int ends = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene linear = piecewise_linear(seed);
    ends += end_a_moment_after_events(linear, 10.0, FlowMethod::kClosedForm) +
            end_a_moment_after_events(linear, 10.0, FlowMethod::kCollocation) +
            end_a_moment_after_events(mixed(seed, seed % 2 == 0), 10.0, FlowMethod::kCollocation);
  }
  EXPECT_GT(ends, 1000);
}

TEST(ElaborateContacts, ALoadMayHaveNoConstantPart) {
  // N = wᵀq and N = wᵀq + 1e-9: what its force is compared with must not vanish with it.
  for (const double constant : {1.0, 1e-9, 0.0}) {
    friction::Contact contact{unit(2, 1), friction::Coulomb{0.4, 0.2}, friction::NormalLoad(constant, 1.0)};
    contact.offset = 1.0 - constant;
    for (const double offset : {contact.offset, 0.0}) {
      contact.offset = offset;
      const HybridSystem system(fem::chain({.masses = 2, .damping = 0.02}), {contact}, friction::Belt::constant(0.1));
      const State start = fixtures::state(Eigen::Vector2d(0.5, 1.0), Eigen::Vector2d::Zero());
      const Trajectory exact = simulate(system, start, {.duration = 20.0});
      const Trajectory run = simulate(system, start, {.duration = 20.0, .flow = kFine});
      EXPECT_EQ(run.events.size(), exact.events.size()) << constant;
      EXPECT_LT((run.final_state.q - exact.final_state.q).cwiseAbs().maxCoeff(), 1e-9) << constant;
      EXPECT_LT(run.statistics.steps, 4000) << constant;
    }
  }
}

TEST(ElaborateContacts, AStopThatIsNotReachedCostsNoSteps) {
  // Under a force drive, whose harmonics are followed to a share of the least limit: a stop has none.
  std::vector<friction::Contact> contacts = {{unit(4, 3), friction::Stribeck{0.4, 0.2, 2.0}, 1.0}};
  std::array<std::int64_t, 2> steps{};
  for (std::int64_t& count : steps) {
    const HybridSystem system(fem::chain({.masses = 4, .damping = 0.02}), contacts,
                              friction::Force{1.0, {{.amplitude = 1.0, .order = 8}}}, {}, unit(4, 0));
    count = simulate(system, fixtures::swinging(4, 1, 1.0), {.duration = 50.0}).statistics.steps;
    const friction::Stop far{.stiffness = 1.0, .gap = 1e3};
    contacts.push_back({unit(4, 1), friction::Clearance{far, far}});
  }
  EXPECT_EQ(steps[0], steps[1]);
}

TEST(ElaborateContacts, AStopWithoutAGapMeetsNothingWhileFrictionHoldsTheMassThere) {
  // The mass is moved by rounding alone, to and fro through the gap's end, until the force a sin(t + phase) has grown
  // to the static limit.
  const double a = 1.6, limit = 0.9, phase = 0.3, let_go = std::asin(limit / a) - phase;
  const fem::Structure structure(Eigen::MatrixXd::Identity(1, 1), Eigen::MatrixXd::Constant(1, 1, 0.04),
                                 Eigen::MatrixXd::Zero(1, 1));
  const friction::Stop stop{.stiffness = 3.3, .damping = 0.09};
  for (const ContactLoss loss : {ContactLoss::kGap, ContactLoss::kZeroForce}) {
    const Clearance left{.left = stop, .right = std::nullopt, .loss = loss};
    const HybridSystem system(structure, {{unit(1, 0), friction::Stribeck{0.3, 0.1, 13.0}, 3.0}, {unit(1, 0), left}},
                              friction::Force{1.0, {{.amplitude = a, .phase = phase}}}, {}, unit(1, 0));
    for (const double tolerance : {1e-7, 1e-9, 1e-10, 1e-11, 1e-12}) {
      const Trajectory run =
          simulate(system, system.rest(), {.duration = let_go - 1e-9, .flow = {.tolerance = tolerance}});
      EXPECT_EQ(run.events.size(), 0U) << tolerance;
    }
  }
}

TEST(ElaborateContacts, EnergyBalancesAtTheDefaultTolerance) {
  for (std::uint64_t seed = 200; seed < 300; ++seed) {
    const RandomScene scene = mixed(seed, seed % 2 == 0);
    const Trajectory run = simulate(scene.system, scene.start, {.duration = 30.0});
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9) << "seed " << seed;
  }
}

TEST(ElaborateContacts, TangentsAreThoseOfTheClosedForm) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const RandomScene scene = piecewise_linear(seed);
    const TangentResult exact = tangent_flow(scene.system, scene.start, 6.0, {.method = FlowMethod::kClosedForm});
    const TangentResult run = tangent_flow(scene.system, scene.start, 6.0, kFine);
    const double size = std::max(1.0, exact.monodromy.cwiseAbs().maxCoeff());
    EXPECT_LT((run.monodromy - exact.monodromy).cwiseAbs().maxCoeff(), 1e-8 * size) << "seed " << seed;
    EXPECT_LT((run.rate - exact.rate).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
  }
}

TEST(ElaborateContacts, TangentsBesideLawsOfTheSpeedAreDifferences) {
  // Central differences of a step of 1e-6: their own error is its square and 1e-12 over the step. Scenes whose events
  // are not the same on both sides say nothing.
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const RandomScene scene = mixed(seed, seed % 2 == 0);
    const TangentResult run = tangent_flow(scene.system, scene.start, 4.0, kFine);
    bool same = true;
    const auto end_of = [&](const State& from) {
      const Trajectory moved = simulate(scene.system, from, {.duration = 4.0, .flow = kFine});
      same &= moved.events.size() == run.events.size() &&
              std::ranges::equal(moved.events, run.events, [](const Event& a, const Event& b) {
                return a.contact == b.contact && a.after == b.after && std::abs(a.time - b.time) < 1e-4;
              });
      return stacked(moved.final_state);
    };
    const Eigen::MatrixXd differences = slopes(scene.start, end_of, 1e-6, 2);
    if (!same) continue;
    ++compared;
    const double size = std::max(1.0, differences.cwiseAbs().maxCoeff());
    const Eigen::Index given = differences.cols();  // starts have nothing of the contacts' own
    const Eigen::MatrixXd off = run.monodromy.topLeftCorner(given, given) - differences.topRows(given);
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-5 * size) << "seed " << seed;
  }
  EXPECT_GT(compared, 30);
}

TEST(ElaborateContacts, ANormalOscillatorBesideALawOfTheSpeedIsRefused) {
  friction::Contact pressed{unit(2, 1), friction::Coulomb{0.4, 0.3}};
  pressed.normal_load = {1.0,
                         friction::NormalOscillator{.mass = 1.0, .support_stiffness = 1.0, .spring_stiffness = 1.0}};
  Draws random(1);
  const HybridSystem system(masses_in_a_row(random, 2), {{unit(2, 0), friction::Stribeck{0.4, 0.3, 2.0}}, pressed},
                            friction::Belt::constant(0.1));
  try {
    (void)simulate(system, system.rest(), {.duration = 1.0});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("contact 2 has a normal oscillator"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace slipmode::dynamics
