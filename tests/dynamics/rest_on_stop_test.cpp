// Structures at rest on stops without a gap, near to or far from what sets them in motion: the guard of such a stop
// leaves zero by any order of the time, or not at all.
#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/masses.hpp>

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace slipmode::dynamics {
namespace {

using friction::Clearance;
using friction::Contact;
using friction::Stop;

constexpr int kMasses = 6;

fem::Structure chain_of_six(double damping) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(kMasses, kMasses), K = M;
  K(0, 0) = 0.7;
  for (int i = 0; i < kMasses; ++i) M(i, i) = 0.4 + 0.1 * i;
  for (int i = 0; i + 1 < kMasses; ++i) {
    const double k = 1.0 + 0.13 * i;
    K.block<2, 2>(i, i) += (Eigen::Matrix2d() << k, -k, -k, k).finished();
  }
  return {fem::Matrix(M), fem::Matrix(Eigen::MatrixXd(damping * (M + K))), fem::Matrix(K)};
}

/// Without its spring to the ground, damped by its springs alone.
fem::Structure floating_chain_of_six(double damping) {
  const fem::Structure held = chain_of_six(0.0);
  Eigen::MatrixXd K = fem::to_dense(held.K());
  K(0, 0) -= 0.7;
  return {held.M(), fem::Matrix(Eigen::MatrixXd(damping * K)), fem::Matrix(K)};
}

std::vector<Contact> contacts_on_the_first() {
  const auto under = [](friction::Law law) {
    return Contact{.direction = Eigen::VectorXd::Unit(kMasses, 0), .law = std::move(law), .normal_load = 2.0};
  };
  std::vector<Contact> contacts{
      under(friction::CompliantCoulomb{.mu_s = 0.38, .mu_k = 0.37, .stiffness = 12.0}),
      under(friction::Coulomb{.mu_s = 0.38, .mu_k = 0.3}),
      under(friction::Stribeck{.mu_s = 0.38, .mu_k = 0.3, .alpha = 3.0}),
      under(friction::LuGre{.mu_s = 0.38, .mu_k = 0.3, .stribeck_speed = 0.1, .stiffness = 100.0, .damping = 1.0}),
      under(friction::TanhRegularised{.mu_s = 0.38, .mu_k = 0.3, .alpha = 3.0, .epsilon = 0.05})};
  contacts.front().normal_load.slope = 0.4;
  return contacts;
}

std::vector<Clearance> stops_without_gap() {
  const Stop undamped{.stiffness = 56.0}, damped{.stiffness = 40.0, .damping = 0.3};
  return {{.left = {}, .right = undamped}, {.left = damped, .right = {}}, {.left = undamped, .right = damped}};
}

/// A belt that begins to move at 2.3, either way; forces on the first mass that begin at zero, either way.
std::vector<friction::Drive> drives_from_rest() {
  const auto belt = [](double to) {
    return friction::Belt{.speed = 0.0, .end_speed = to, .ramp_begin = 2.3, .ramp_end = 9.0};
  };
  const auto force = [](double phase) { return friction::Force{0.69, {{.amplitude = 0.3, .phase = phase}}}; };
  return {belt(0.63), belt(-0.63), force(0.0), force(std::numbers::pi)};
}

TEST(RestOnAStop, IsLeftAsFromBesideIt) {
  // Beside the same motion from 1e-10 before the stop, or on it: the paths are the same to what stops and friction make
  // of that. Half of these runs ended in a Zeno.
  constexpr double kBeside = 1e-10;
  int moved = 0;
  for (std::size_t law = 0; law < 5; ++law)
    for (std::size_t stop = 0; stop < 3; ++stop)
      for (std::size_t drive = 0; drive < 4; ++drive)
        for (const int at : {0, 1, 2, 5})
          for (const double damping : {0.0, 0.03}) {
            SCOPED_TRACE(testing::Message() << "law " << law << ", stop " << stop << " at " << at << ", drive " << drive
                                            << ", damping " << damping);
            const Contact clearance{.direction = Eigen::VectorXd::Unit(kMasses, at), .law = stops_without_gap()[stop]};
            const HybridSystem system(chain_of_six(damping), {contacts_on_the_first()[law], clearance},
                                      drives_from_rest()[drive], {},
                                      Eigen::MatrixXd(Eigen::VectorXd::Unit(kMasses, 0)));
            State beside = system.rest();
            beside.q(at) = stop == 0 ? -kBeside : kBeside;
            const SimulateOptions options{.duration = 12.0, .sample = 0.1};
            Trajectory here, there;
            ASSERT_NO_THROW(here = simulate(system, system.rest(), options));
            ASSERT_NO_THROW(there = simulate(system, beside, options));
            const double size = std::max(there.q.cwiseAbs().maxCoeff(), 1e-3);
            EXPECT_LT((here.q - there.q).cwiseAbs().maxCoeff(), 1e-6 * size);
            if (size > 1e-3) {
              ++moved;
              EXPECT_LT(std::abs(here.audit.residual()), 1e-9);
              // Far from the drive stops are met and left by rounding, 1e-21 or so, before there is a motion.
              EXPECT_LE(here.statistics.events, 2 * there.statistics.events + 20);
            }
          }
  EXPECT_GT(moved, 300);  // of 480: some stay stuck
}

TEST(RestOnAStop, StopsOnSeveralMassesAreLeft) {
  // Two stops anywhere beside every law, with the drive at either end: those that move close their energy. What a guard
  // is by interpolation, by rounding of what a contact holds, and within a step's tolerance, was taken for motion: one
  // run in fifty ended in a Zeno.
  const Stop undamped{.stiffness = 56.0}, damped{.stiffness = 1e4, .damping = 0.3};
  const std::vector<Clearance> kinds{{.left = {}, .right = undamped, .loss = friction::ContactLoss::kGap},
                                     {.left = damped, .right = {}},
                                     {.left = undamped, .right = damped, .loss = friction::ContactLoss::kGap},
                                     {.left = undamped, .right = undamped}};
  std::vector<Contact> laws = contacts_on_the_first();
  laws.push_back({.direction = {}, .law = friction::Dahl{.mu = 0.3, .stiffness = 50.0}, .normal_load = 2.0});
  std::vector<friction::Drive> drives = drives_from_rest();
  drives.emplace_back(friction::Shaker{.amplitude = 0.1, .frequency_hz = 0.13});
  int moved = 0;
  for (std::size_t law = 0; law < laws.size(); ++law)
    for (std::size_t drive = 0; drive < drives.size(); ++drive)
      for (const int on : {0, 3})
        for (int pair = 0; pair < 36; ++pair) {
          SCOPED_TRACE(testing::Message() << "law " << law << " on " << on << ", drive " << drive << ", pair " << pair);
          std::vector<Contact> contacts{laws[law]};
          contacts[0].direction = Eigen::VectorXd::Unit(kMasses, on);
          for (const int at : {pair % kMasses, pair / kMasses})
            contacts.push_back({.direction = Eigen::VectorXd::Unit(kMasses, at),
                                .law = kinds[static_cast<std::size_t>(pair + at) % kinds.size()]});
          const HybridSystem system(chain_of_six(pair % 2 == 0 ? 0.0 : 0.03), contacts, drives[drive], {},
                                    Eigen::MatrixXd(Eigen::VectorXd::Unit(kMasses, pair % 3 == 0 ? 0 : 5)));
          Trajectory run;
          ASSERT_NO_THROW(run = simulate(system, system.rest(), {.duration = 6.0, .sample = 0.1}));
          if (run.q.cwiseAbs().maxCoeff() < 1e-3) continue;
          ++moved;
          EXPECT_LT(std::abs(run.audit.residual()), 1e-9);
        }
  EXPECT_GT(moved, 1500);  // of 2,160
}

TEST(RestOnAStop, ChainsThatGlideLeaveNoStopBetweenTheirMasses) {
  // A free chain at one velocity with stops without a gap between two of its masses: nothing ever presses them. Their
  // distance is the difference of two places that move by metres, and rattled by what those round by.
  const Stop undamped{.stiffness = 56.0}, damped{.stiffness = 40.0, .damping = 0.3};
  for (const double damping : {0.0, 0.03})
    for (int at = 1; at < kMasses; ++at)
      for (const auto& stops : {Clearance{.left = undamped, .right = damped},
                                Clearance{.left = damped, .right = {}, .loss = friction::ContactLoss::kGap}}) {
        SCOPED_TRACE(testing::Message() << "stop before " << at << ", damping " << damping);
        const Contact between{.direction = Eigen::VectorXd::Unit(kMasses, at) - Eigen::VectorXd::Unit(kMasses, at - 1),
                              .law = stops};
        const HybridSystem system(floating_chain_of_six(damping), {between}, friction::Belt{.speed = 0.3});
        State start = system.rest();
        start.v.setConstant(-0.47541766997);
        const Trajectory run = simulate(system, start, {.duration = 16.0});
        EXPECT_TRUE(run.events.empty());
        EXPECT_NEAR(run.final_state.q(at), -0.47541766997 * 16.0, 1e-12);
      }
}

TEST(RestOnAStop, IsMetAlikeFarFromTheOrigin) {
  // The same inner motion, 1e-3, of a free chain at the origin and 1,000 km from it, from a stop without a gap: places
  // round by 1e-10 there. Where zero is to be told by that, but not whether a stop is met.
  constexpr double kAway = 1e6, kSize = 1e-3;
  const Contact between{
      .direction = Eigen::VectorXd::Unit(kMasses, 2) - Eigen::VectorXd::Unit(kMasses, 1),
      .law = Clearance{.left = Stop{.stiffness = 50.0}, .right = Stop{.stiffness = 20.0, .damping = 0.1}}};
  const HybridSystem system(floating_chain_of_six(0.0), {between}, friction::Belt{.speed = 0.3});
  Random random(5);
  for (int draw = 0; draw < 20; ++draw) {
    SCOPED_TRACE(testing::Message() << "draw " << draw);
    State start = system.rest();
    for (int i = 0; i < kMasses; ++i) {
      start.q(i) = kSize * random.uniform(-1.0, 1.0);
      start.v(i) = kSize * random.uniform(-1.0, 1.0);
    }
    start.q(2) = start.q(1);
    const Trajectory here = simulate(system, start, {.duration = 10.0});
    start.q.array() += kAway;
    const Trajectory there = simulate(system, start, {.duration = 10.0});
    const Eigen::VectorXd apart = (there.final_state.q.array() - kAway).matrix() - here.final_state.q;
    EXPECT_LT(apart.cwiseAbs().maxCoeff(), 1e-4 * kSize);
  }
}

TEST(RestOnAStop, IsNotLeftWhereTwoContactsTakeAllOfAForce) {
  // A force on two masses that stick: nothing moves. The steady answer is a difference, of neither contact alone.
  for (int draw = 0; draw < 60; ++draw) {
    SCOPED_TRACE(testing::Message() << "draw " << draw);
    Random random = Random::stream(13, static_cast<std::uint64_t>(draw));
    const int held = static_cast<int>(random.uniform(0.0, kMasses - 1)),
              stop = static_cast<int>(random.uniform(0.0, kMasses));
    std::vector<Contact> contacts;
    for (const int at : {held, held + 1})
      contacts.push_back({.direction = Eigen::VectorXd::Unit(kMasses, at),
                          .law = friction::Coulomb{.mu_s = 0.4, .mu_k = 0.3},
                          .normal_load = 100.0});
    contacts.push_back(
        {.direction = Eigen::VectorXd::Unit(kMasses, stop),
         .law = Clearance{.left = Stop{.stiffness = 50.0}, .right = Stop{.stiffness = 20.0, .damping = 0.3}}});
    const Eigen::VectorXd along = random.uniform(0.2, 1.0) * Eigen::VectorXd::Unit(kMasses, held) +
                                  random.uniform(-1.0, 1.0) * Eigen::VectorXd::Unit(kMasses, held + 1);
    const HybridSystem system(chain_of_six(draw % 2 == 0 ? 0.0 : 0.03), contacts,
                              friction::Force{0.69, {{.amplitude = 1.0, .phase = draw % 5 == 0 ? 0.0 : 1.1}}}, {},
                              Eigen::MatrixXd(along));
    Trajectory run;
    ASSERT_NO_THROW(run = simulate(system, system.rest(), {.duration = 20.0}));
    EXPECT_LT(run.final_state.q.cwiseAbs().maxCoeff(), 1e-13);
  }
}

/// A chain with contacts, stops without a gap at or between its masses, and a drive, all of any kind; at rest on the
/// stops and anything elsewhere.
struct DrawnStart {
  std::optional<HybridSystem> system;  ///< none where contacts that stick say the same twice
  State start;
};

DrawnStart draw_start(std::uint64_t index) {
  Random random = Random::stream(77, index);
  const auto any = [&](int count) { return static_cast<int>(random.uniform(0.0, count)); };
  const int n = 2 + any(9);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n), K = M;
  if (any(2) == 0) K(0, 0) = random.uniform(0.3, 2.0);
  for (int i = 0; i < n; ++i) M(i, i) = random.uniform(0.3, 2.0);
  for (int i = 0; i + 1 < n; ++i) {
    const double k = random.uniform(0.3, 3.0);
    K.block<2, 2>(i, i) += (Eigen::Matrix2d() << k, -k, -k, k).finished();
  }
  const Eigen::MatrixXd C = (any(2) == 0 ? 0.0 : 0.03) * (any(2) == 0 ? K : Eigen::MatrixXd(M + K));
  const auto at_mass = [&](int i) -> Eigen::VectorXd { return Eigen::VectorXd::Unit(n, i); };

  std::vector<Contact> contacts;
  for (int left = 1 + any(3); left > 0; --left) {
    contacts.push_back(contacts_on_the_first()[static_cast<std::size_t>(any(any(8) == 0 ? 5 : 2))]);
    contacts.back().direction = at_mass(any(n));
  }
  const double speed = random.uniform(-0.5, 0.5);
  const std::vector<friction::Drive> drives{
      friction::Belt{.speed = speed},
      friction::Belt{.speed = 0.0, .end_speed = speed, .ramp_begin = 1.3, .ramp_end = 9.0},
      friction::Force{0.69, {{.amplitude = 0.3 * std::abs(speed), .phase = any(2) == 0 ? 0.0 : 2.2}}},
      friction::Shaker{.amplitude = 0.3 * std::abs(speed), .frequency_hz = 0.2, .phase = random.uniform(0.0, 6.0)}};
  const int drive = any(4);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(n), v = q;
  if (any(2) == 0)
    for (int i = 0; i < n; ++i) {
      if (any(2) == 0) q(i) = random.uniform(-0.4, 0.4);
      if (any(2) == 0) v(i) = drive == 0 ? speed : random.uniform(-0.3, 0.3);
    }
  const auto stop = [&] {
    return Stop{.stiffness = std::exp(random.uniform(0.0, 9.0)), .damping = any(2) == 0 ? 0.0 : 0.3};
  };
  for (int left = 1 + any(2); left > 0; --left) {
    Clearance stops{.left = stop(), .right = stop()};
    if (any(2) == 0) stops.loss = friction::ContactLoss::kGap;
    if (any(3) == 0) stops.left.reset();
    const int at = any(n);
    Eigen::VectorXd direction = at_mass(at);
    q(at) = v(at) = 0.0;
    if (at > 0 && any(3) == 0) {
      direction -= at_mass(at - 1);
      q(at - 1) = 0.0;
      v(at) = v(at - 1);
    }
    contacts.push_back({.direction = direction, .law = stops});
  }
  DrawnStart drawn;
  try {
    drawn.system.emplace(fem::Structure{fem::Matrix(M), fem::Matrix(C), fem::Matrix(K)}, contacts,
                         drives[static_cast<std::size_t>(drive)], Eigen::VectorXd(), at_mass(any(n)));
    drawn.start = drawn.system->rest();
    drawn.start.q = q;
    drawn.start.v = v;
  } catch (const InvalidInput&) {
    drawn.system.reset();
  }
  return drawn;
}

TEST(RestOnAStop, AnyStartIsLeft) {
  int moved = 0;
  for (std::uint64_t index = 0; index < 500; ++index) {
    SCOPED_TRACE(testing::Message() << "start " << index);
    const DrawnStart drawn = draw_start(index);
    if (!drawn.system) continue;
    Trajectory run;
    ASSERT_NO_THROW(run = simulate(*drawn.system, drawn.start, {.duration = 8.0, .sample = 0.1}));
    if (run.q.cwiseAbs().maxCoeff() < 1e-3) continue;
    ++moved;
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9);
  }
  EXPECT_GT(moved, 250);
}

/// Four masses of one in a row, on springs of one but to the ground.
fem::Structure row_of_four(double to_ground, double damping) {
  return fem::masses(
      {.mass = {1.0, 1.0, 1.0, 1.0},
       .links = {{0, 1, to_ground, damping}, {1, 2, 1.0, damping}, {2, 3, 1.0, damping}, {3, 4, 1.0, damping}}});
}

/// Stops without a gap on the first of them.
Contact stops_on_the_first() {
  const Stop stop{.stiffness = 4e4};
  return {Eigen::Vector4d::UnitX(), Clearance{.left = stop, .right = stop}};
}

TEST(RestOnAStop, AMotionThatHasJustBegunIsToldBesideItself) {
  // A force on the last of four masses presses the first one on a stop as t^7 through the others. Beside its steady
  // answer of half a metre and what is free, which cancel, the stop was met 6e-13 m deep, and bounced sixteen times.
  const HybridSystem system(row_of_four(1.0, 0.02), {stops_on_the_first()}, friction::Force{0.9, {{.amplitude = 0.5}}},
                            Eigen::VectorXd(), Eigen::MatrixXd(Eigen::Vector4d::UnitW()));
  const Trajectory run = simulate(system, system.rest(), {.duration = 2.0});
  ASSERT_FALSE(run.events.empty());
  EXPECT_LT(std::abs(run.events.front().displacement), 1e-14);
  EXPECT_LT(run.events.size(), 6U);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
}

TEST(RestOnAStop, AMotionThatABeltHasJustBegunIsToldBesideItself) {
  // A belt pulls the last of four masses by a spring, and presses the first one on a stop as t⁹. Beside what follows
  // the belt and what is free, which cancel, the stop was met 4e-14 m deep after 0.13 s, and bounced eight times.
  for (const double damping : {0.0, 0.02}) {
    const HybridSystem system(
        row_of_four(1.0, damping),
        {stops_on_the_first(), {Eigen::Vector4d::UnitW(), friction::CompliantCoulomb{1.0, 1.0, 2.0}, 1e12}},
        friction::Belt::constant(0.5));
    const Trajectory run = simulate(system, system.rest(), {.duration = 2.0});
    ASSERT_EQ(run.events.size(), 1U);
    EXPECT_EQ(run.events.front().after, ContactMode::kRightStop);
    EXPECT_LT(std::abs(run.events.front().displacement), 1e-15);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
  }
}

/// Of mass i, between a wall and a mass that is held 0.6 m off.
double resting_place(int n, int held, int i) {
  return 0.6 * (i <= held ? (i + 1.0) / (held + 1) : static_cast<double>(n - i) / (n - held));
}

/// A chain at rest between walls, friction holding one mass 0.6 m off, and a stop where another is then.
HybridSystem held_chain(fem::ChainOptions options, int held, int stopped, double stiffness,
                        const friction::Belt& belt = friction::Belt::constant(0.0)) {
  options.right_fixed = true;
  const int n = options.masses;
  const auto unit = [n](int i) { return Eigen::VectorXd(Eigen::VectorXd::Unit(n, i)); };
  const Stop stop{stiffness, 0.0, resting_place(n, held, stopped)};
  return {fem::chain(options),
          {{unit(held), friction::Coulomb{1.0, 0.9}, 10.0}, {unit(stopped), Clearance{.left = {}, .right = stop}}},
          belt};
}

State held_start(const HybridSystem& system, int held) {
  State start = system.rest();
  for (int i = 0; i < system.size(); ++i) start.q(i) = resting_place(static_cast<int>(system.size()), held, i);
  return start;
}

TEST(RestOnAStop, WhatALongChainRoundsByIsNoEvent) {
  // Its place comes back to rest off by 1e-13 each time, as the fastest of 200 modes is 127 times as fast as the
  // slowest: told from zero by 64 ε of the place, it pressed and let go 285 times.
  const HybridSystem system = held_chain({.masses = 200}, 99, 49, 10.0);
  const Trajectory run = simulate(system, held_start(system, 99), {.duration = 2000.0});
  EXPECT_TRUE(run.events.empty());
  EXPECT_EQ(run.statistics.certified, run.statistics.steps);
}

TEST(RestOnAStop, WhatVibratesByLessThanCanBeToldTakesNoSteps) {
  // Speeds of 1e-13 m/s beside places of 0.6 m, eleven masses of 0.01 kg among those of 1 kg: 226 steps at most in
  // forty runs, as long as the stop's force is known to stay below what can be told; in steps by bounds on its second
  // and third derivative it took up to 1.8 million.
  fem::ChainOptions options{.masses = 40, .mass = std::vector<double>(40, 1.0)};
  for (const int light : {2, 9, 10, 15, 17, 18, 22, 27, 28, 32, 37})
    options.mass[static_cast<std::size_t>(light)] = 0.01;
  const HybridSystem system = held_chain(options, 5, 39, 1e8);
  Random random = Random::stream(1, 0);
  for (int trial = 0; trial < 20; ++trial) {
    State start = held_start(system, 5);
    for (const int i : {10, 16}) start.v(i) = -5e-13 * random.normal();
    const Trajectory run = simulate(system, start, {.duration = 300.0});
    EXPECT_LT(run.events.size(), 200U);
    EXPECT_LT(run.statistics.steps, 1000);
  }
}

TEST(RestOnAStop, IsTakenUpBeforeItIsTold) {
  // What swings by metres in the long run presses the first mass on its stop as a power of the time, and is told when
  // that is 1e-12 of them. Until then the place is beyond the stop, at t = 0.15 by more than a share of what has moved.
  const Contact pulled{Eigen::Vector4d::UnitW(), friction::CompliantCoulomb{1.0, 1.0, 2.0}, 1e2};
  for (const double damping : {0.02, 3.0}) {
    const fem::Structure row = row_of_four(1e-3, damping);
    const std::vector<HybridSystem> systems{
        {row,
         {stops_on_the_first()},
         friction::Force{0.1, {{.amplitude = 0.5, .phase = 1.0}}},
         Eigen::VectorXd(),
         Eigen::MatrixXd(Eigen::Vector4d::UnitW())},
        {row, {stops_on_the_first(), pulled}, friction::Shaker{.amplitude = 10.0, .frequency_hz = 0.3}}};
    for (const HybridSystem& system : systems) {
      const Trajectory whole = simulate(system, system.rest(), {.duration = 2.0});
      ASSERT_FALSE(whole.events.empty());
      for (int k = 1; k < 40; ++k) {
        const double cut = k / 40.0 * whole.events.front().time;
        const State state = simulate(system, system.rest(), {.duration = cut}).final_state;
        Trajectory rest;
        ASSERT_NO_THROW(rest = simulate(system, state, {.duration = 2.0 - cut})) << damping << " " << cut;
        EXPECT_LT((rest.final_state.q - whole.final_state.q).norm(), 1e-10 * whole.final_state.q.norm());
      }
      State wrong = system.rest();
      wrong.q(0) = 1e-6;
      wrong.modes.assign(system.contacts().size(), ContactMode::kStick);
      wrong.modes[0] = ContactMode::kGap;
      EXPECT_THROW(static_cast<void>(simulate(system, wrong, {.duration = 2.0})), InvalidInput);
    }
  }
}

TEST(RestOnAStop, IsTakenUpBeforeCollocationTellsIt) {
  // A belt pulls the last of sixteen masses, and the fifth passes its stop as t^26: by as much as friction on the last
  // one may be off by, which is the tolerance, before that is told.
  for (const double tolerance : {1e-11, 1e-9}) {
    const int held = 15;
    const HybridSystem system = held_chain({.masses = 16, .damping = 0.006}, held, 4, 4.2,
                                           {.speed = 0.0, .end_speed = 0.8, .ramp_begin = 0.0, .ramp_end = 5.0});
    const auto run = [&](const State& from, double duration) {
      return simulate(system, from,
                      {.duration = duration, .flow = {.method = FlowMethod::kCollocation, .tolerance = tolerance}});
    };
    const State start = held_start(system, held);
    const Trajectory whole = run(start, 6.0);
    ASSERT_FALSE(whole.events.empty());
    const double told = whole.events.front().time;
    for (int k = 1; k < 60; ++k) {
      const State state = run(start, k / 60.0 * told).final_state;
      Trajectory rest;
      ASSERT_NO_THROW(rest = run(state, 6.0 - state.time)) << tolerance << " " << state.time;
      EXPECT_LT((rest.final_state.q - whole.final_state.q).norm(), 100.0 * tolerance * whole.final_state.q.norm());
    }
  }
}

TEST(RestOnAStop, WhatHardlyAnythingHoldsIsToldByWhatMovesNow) {
  // Sliding friction pulls the third of four masses, which a spring of 1e-8 holds, and presses the first one on a stop
  // as t⁶. Beside how far friction will have moved them in the end, 3e7 m, the stop was met 3e-11 m deep.
  const HybridSystem system(row_of_four(1e-8, 0.0),
                            {stops_on_the_first(), {Eigen::Vector4d::UnitZ(), friction::Coulomb{0.5, 0.4}, 1.0}},
                            friction::Belt::constant(0.5));
  const Trajectory run = simulate(system, system.rest(), {.duration = 0.5});
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(run.events.front().after, ContactMode::kRightStop);
  EXPECT_LT(std::abs(run.events.front().displacement), 1e-15);
}

TEST(RestOnAStop, IsPressedFromTheFirstInstantOn) {
  // A force that pushes a chain at rest into a stop without a gap: the event is at once, as by the reference. Sought as
  // a root, it came 1e-8 to 6e-8 s late.
  const friction::Force push{1.3, {{.amplitude = 0.1, .phase = 0.4}}};
  for (const auto loss : {friction::ContactLoss::kGap, friction::ContactLoss::kZeroForce})
    for (const double side : {-1.0, 1.0})
      for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
        SCOPED_TRACE(testing::Message() << static_cast<int>(loss) << " " << side << " " << static_cast<int>(method));
        const Clearance stops{
            .left = Stop{.stiffness = 40.0}, .right = Stop{.stiffness = 56.0, .damping = 0.3}, .loss = loss};
        const HybridSystem system(chain_of_six(0.03), {{.direction = Eigen::VectorXd::Unit(kMasses, 2), .law = stops}},
                                  push, side * 0.2 * Eigen::VectorXd::Unit(kMasses, 2),
                                  Eigen::MatrixXd(Eigen::VectorXd::Unit(kMasses, 2)));
        const Trajectory run = simulate(system, system.rest(), {.duration = 20.0, .flow = {.method = method}});
        ASSERT_FALSE(run.events.empty());
        EXPECT_EQ(run.events[0].time, 0.0);
        EXPECT_EQ(run.events[0].after, side < 0.0 ? ContactMode::kLeftStop : ContactMode::kRightStop);
        EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
      }
}

}  // namespace
}  // namespace slipmode::dynamics
