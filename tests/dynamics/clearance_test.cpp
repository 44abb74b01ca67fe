// Clearances and force drives: against an independent Runge-Kutta, closed forms, and the energy balance.
#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include "fixtures/clearance_reference.hpp"
#include "fixtures/clearance_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Clearance;
using friction::Contact;
using friction::ContactLoss;
using friction::Force;
using friction::Stop;

/// One mass on a spring k, damper c.
fem::Structure plain_oscillator(double k, double c) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  return {fem::Matrix(one), fem::Matrix(Eigen::MatrixXd(c * one)), fem::Matrix(Eigen::MatrixXd(k * one))};
}

void expect_reference(const HybridSystem& system, const State& start, double duration, double tolerance,
                      double step = 5e-4) {
  const Trajectory run = simulate(system, start, {.duration = duration});
  ClearanceReference reference(system, start);
  reference.run(static_cast<long double>(duration), static_cast<long double>(step));
  ASSERT_EQ(run.events.size(), reference.changes().size());
  for (std::size_t k = 0; k < run.events.size(); ++k) {
    EXPECT_NEAR(run.events[k].time, reference.changes()[k].time, tolerance);
    EXPECT_EQ(run.events[k].contact, reference.changes()[k].contact);
    EXPECT_EQ(run.events[k].kind, reference.changes()[k].pressing ? EventKind::kContact : EventKind::kSeparation);
  }
  EXPECT_LT((run.final_state.q - reference.q()).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((run.final_state.v - reference.v()).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
}

TEST(Clearance, SourcesAgreeWithRungeKutta) {
  // Over times within which these transients do not yet multiply the reference's truncation of 1e-13 by more than 1e4.
  expect_reference(backlash_mass(1.4), {0.0, Eigen::VectorXd::Constant(1, 3.0), Eigen::VectorXd::Zero(1)}, 30.0, 1e-9);
  expect_reference(backlash_mass(0.5, 1.0, ContactLoss::kGap), backlash_mass(0.5).rest(), 40.0, 1e-7);
  expect_reference(backlash_train(0.9), backlash_train(0.9).rest(), 60.0, 1e-8);
  expect_reference(clearance_pair(0.6), clearance_pair(0.6).rest(), 60.0, 1e-8);
}

TEST(Clearance, RandomStructuresAgreeWithRungeKutta) {
  int events = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const HybridSystem system = random_clearances(seed);
    expect_reference(system, system.rest(), 12.0, 1e-7, 1e-3);
    events += static_cast<int>(simulate(system, system.rest(), {.duration = 12.0}).statistics.events);
  }
  EXPECT_GT(events, 250);  // the scenes are not idle
}

TEST(Clearance, RandomStructuresCloseTheirEnergy) {
  for (unsigned seed = 1000; seed < 1200; ++seed) {
    SCOPED_TRACE(seed);
    const HybridSystem system = random_clearances(seed);
    EXPECT_LT(std::abs(simulate(system, system.rest(), {.duration = 50.0}).audit.residual()), 1e-10);
  }
}

TEST(Clearance, WithoutAGapItIsTheStiffLinearOscillator) {
  // Stops at zero on both sides, without damping: m q̈ + (k + k_s) q = A sin ωt from rest; closed form.
  const Stop stop{.stiffness = 3.0, .damping = 0.0, .gap = 0.0};
  const double omega = 1.3, own = std::sqrt(1.0 + 3.0);
  for (const ContactLoss loss : {ContactLoss::kZeroForce, ContactLoss::kGap}) {
    const HybridSystem system(plain_oscillator(1.0, 0.0),
                              {Contact{.direction = Eigen::VectorXd::Ones(1), .law = Clearance{stop, stop, loss}}},
                              Force{omega, {{.amplitude = 0.7}}}, {}, Eigen::MatrixXd::Ones(1, 1));
    const Trajectory run = simulate(system, system.rest(), {.duration = 40.0, .sample = 0.25});
    double worst = 0.0;
    for (Eigen::Index k = 0; k < run.times.size(); ++k) {
      const double t = run.times(k);
      const double q = 0.7 / (own * own - omega * omega) * (std::sin(omega * t) - omega / own * std::sin(own * t));
      worst = std::max(worst, std::abs(run.q(0, k) - q));
    }
    EXPECT_LT(worst, 1e-12);
  }
}

TEST(Clearance, AStopIsMetOnceHoweverNearItsEndThePlaceIs) {
  // A free mass between stops at zero swings at sqrt(k): an event, or two at one instant, each half period. Of a place
  // of 1e-124 no guard can be judged by the terms it is summed of.
  const Stop stop{.stiffness = 25.0, .damping = 0.0, .gap = 0.0};
  const double half = std::numbers::pi / 5.0;
  for (const ContactLoss loss : {ContactLoss::kZeroForce, ContactLoss::kGap})
    for (const double place : {0.0, 5e-324, 5e-124, -5e-124, 1e-30, -1e-30, 1e-17}) {
      const HybridSystem system(plain_oscillator(0.0, 0.0),
                                {Contact{.direction = Eigen::VectorXd::Ones(1), .law = Clearance{stop, stop, loss}}},
                                Force{1.0, {{.amplitude = 0.0}}}, {}, Eigen::MatrixXd::Ones(1, 1));
      const State start{0.0, Eigen::VectorXd::Constant(1, place), Eigen::VectorXd::Ones(1)};
      const Trajectory run = simulate(system, start, {.duration = 10.5 * half});
      std::size_t met = 0;
      for (const Event& e : run.events) {
        if (e.kind != EventKind::kContact || e.time < 1e-9) continue;
        EXPECT_NEAR(e.time, half * static_cast<double>(++met), 1e-13);
      }
      EXPECT_EQ(met, 10U) << place;
      EXPECT_LE(run.events.size(), 22U) << place;
    }
}

TEST(Clearance, ABounceThatDiesOutKeepsItsTimesBesideAStopFarAway) {
  // A stop without a gap, another one at 0.18. As long as that is not met the motion has no scale: expected the same
  // times whatever the speed at the start, to the phase that roots are located to. From 1e-9 on the third was off by
  // 8e-12, from 1e-11 on by 0.1: what a gap of 0.18 rounds by was held against it.
  const Clearance stops{.left = Stop{.stiffness = 32.0, .damping = 0.4},
                        .right = Stop{.stiffness = 1.5, .damping = 0.4, .gap = 0.18},
                        .loss = ContactLoss::kZeroForce};
  const HybridSystem system(plain_oscillator(900.0, 0.025), {{.direction = Eigen::VectorXd::Ones(1), .law = stops}},
                            friction::Belt::constant(1.0));
  const auto events = [&](double speed) {
    const State start{.q = Eigen::VectorXd::Zero(1), .v = Eigen::VectorXd::Constant(1, -speed)};
    return simulate(system, start, {.duration = 1.0}).events;
  };
  const std::vector<Event> expected = events(1e-2);
  ASSERT_GE(expected.size(), 8U);
  for (const double speed : {1e-6, 1e-9, 1e-11, 1e-13, 1e-20, 1e-60, 1e-120}) {
    const std::vector<Event> found = events(speed);
    ASSERT_EQ(found.size(), expected.size()) << speed;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k].time, expected[k].time, 1e-14) << speed;
      EXPECT_EQ(found[k].after, expected[k].after) << speed;
    }
  }
}

TEST(Clearance, AStopOnWhatFrictionHoldsMovesNothingElse) {
  // Of two free masses one rubs under a force and presses on a stop, the other drifts. In any other coordinates the
  // direction of the stop leaves 1e-17 where friction holds it, which is no spring of what drifts.
  const Eigen::Vector2d rubs(1.0, 0.0), mass(0.8, 2.0);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(2, 2);
  for (const double damping : {0.0, 0.3}) {
    const auto system = [&](const Eigen::Matrix2d& T) {
      const Clearance stop{.left = std::nullopt,
                           .right = Stop{.stiffness = 9.0, .damping = damping, .gap = -0.05},
                           .loss = ContactLoss::kGap};
      const Eigen::VectorXd w = T.transpose() * rubs;
      return HybridSystem({Eigen::MatrixXd(T.transpose() * mass.asDiagonal() * T), none, none},
                          {{w, friction::Coulomb{0.5, 0.4}, 2.0}, {w, stop}}, Force{1.8, {{.amplitude = 1.7}}}, {}, w);
    };
    const State start{0.0, Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(0.0, 0.05)};
    const Trajectory plain = simulate(system(Eigen::Matrix2d::Identity()), start, {.duration = 20.0});
    EXPECT_GT(plain.events.size(), 10U);
    for (int k = 1; k < 12; ++k) {
      SCOPED_TRACE(k);
      const Eigen::Matrix2d T = Eigen::Rotation2Dd(0.27 * k).toRotationMatrix();
      const State turned{0.0, T.transpose() * start.q, T.transpose() * start.v};
      const Trajectory run = simulate(system(T), turned, {.duration = 20.0});
      ASSERT_EQ(run.events.size(), plain.events.size());
      for (std::size_t e = 0; e < run.events.size(); ++e) EXPECT_NEAR(run.events[e].time, plain.events[e].time, 1e-11);
    }
  }
}

TEST(Clearance, QuickContactsAtStiffStopsAreNotTakenForZeno) {
  // Without a gap and damping the mass swings at √k: an event each half period, far more often than 200 within what is
  // short for a mass that floats in the gap.
  const Stop stop{.stiffness = 1e10, .damping = 0.0, .gap = 0.0};
  const HybridSystem system(plain_oscillator(0.0, 0.01),
                            {Contact{.direction = Eigen::VectorXd::Ones(1), .law = Clearance{stop, stop}}},
                            Force{1.0, {{.amplitude = 1.0}}}, {}, Eigen::MatrixXd::Ones(1, 1));
  const State start{0.0, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)};
  const double half = std::numbers::pi / 1e5;
  const Trajectory run = simulate(system, start, {.duration = 1000.5 * half});
  // Each end of contact is a beginning on the other side; the gap between them has no width.
  EXPECT_NEAR(static_cast<double>(run.events.size()), 2000.0, 2.0);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
}

TEST(Clearance, ASlipThatBeginsUnderAForceIsTakenUpThere) {
  // The counterpart rests, so at the start of a slip both speeds are rounding alone.
  const HybridSystem gap = backlash_train(0.9);
  std::vector<Contact> contacts = gap.contacts();
  contacts.push_back(
      {.direction = Eigen::VectorXd::Unit(4, 0), .law = friction::Coulomb{0.3, 0.2}, .normal_load = 0.5});
  const HybridSystem system(gap.structure(), contacts, gap.drive(), {}, gap.force_directions());
  const Trajectory run = simulate(system, system.rest(), {.duration = 60.0});
  int slips = 0;
  for (const Event& e : run.events) {
    if (e.contact != 1) continue;
    const State at = simulate(system, system.rest(), {.duration = e.time}).final_state;
    const State onward = simulate(system, at, {.duration = 60.0 - e.time}).final_state;
    EXPECT_LT((onward.q - run.final_state.q).norm(), 1e-7);
    ++slips;
  }
  EXPECT_GE(slips, 10);
}

// Two masses that nothing connects or holds; one slides under a load that grows along its way, which is the only rate
// there is, the other flies to its stop. That one's displacement was scaled by 1e-308: bounds overflowed, what was no
// number counted as proved, and the stop was passed.
TEST(Clearance, AFreeFlightBesideSlidingThatGrowsEndsAtTheStop) {
  constexpr double kSpeed = 0.8, kWay = 0.5;
  for (const ContactLoss loss : {ContactLoss::kGap, ContactLoss::kZeroForce}) {
    for (const double slope : {0.05, 1.5, 40.0}) {
      SCOPED_TRACE(slope);
      const Stop stop{.stiffness = 7.0, .damping = 0.35, .gap = 0.0};
      std::vector<Contact> contacts(2);
      contacts[0] = {Eigen::VectorXd::Unit(2, 0),
                     Clearance{Stop{.stiffness = 6.0, .damping = 0.35, .gap = 0.7}, stop, loss}};
      contacts[1] = {Eigen::VectorXd::Unit(2, 1), friction::Coulomb{0.4, 0.2}, friction::NormalLoad{0.7, slope}};
      const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(2, 2);
      const HybridSystem system(
          fem::Structure(Eigen::MatrixXd(Eigen::Vector2d(0.5, 1.3).asDiagonal()), none, Eigen::MatrixXd(none)),
          contacts, friction::Shaker{.amplitude = 1e3, .frequency_hz = 0.01});
      for (const double from : {-kWay, -0.75}) {  // in the gap, and pressing on the stop behind
        const Trajectory run =
            simulate(system, {0.0, Eigen::Vector2d(from, 0.0), Eigen::Vector2d(kSpeed, 0.1)}, {.duration = 1.2});
        const bool pressed = from < -0.7;
        ASSERT_GE(run.events.size(), pressed ? 2U : 1U);
        const Event& met = run.events[pressed ? 1 : 0];
        const double way = pressed && loss == ContactLoss::kGap ? 0.7 : pressed ? -run.events[0].displacement : kWay;
        const double left = pressed ? run.events[0].time : 0.0, speed = pressed ? run.events[0].velocity : kSpeed;
        EXPECT_EQ(met.kind, EventKind::kContact);
        EXPECT_NEAR(met.time, left + way / speed, 1e-13);
        EXPECT_NEAR(met.velocity, speed, 1e-13);
        EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
      }
    }
  }
}

TEST(Clearance, AnUndampedStopReturnsTheSpeedItWasHitWith) {
  // No force but the stop's: the mass flies back with its speed after half a period of the contact's own vibration.
  const Stop stop{.stiffness = 9.0, .damping = 0.0, .gap = 0.5};
  const HybridSystem system(plain_oscillator(0.0, 0.0),
                            {Contact{.direction = Eigen::VectorXd::Ones(1), .law = Clearance{stop, stop}}},
                            Force{1.0, {}}, {}, Eigen::MatrixXd::Ones(1, 1));
  const State start{0.0, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 2.0)};
  const Trajectory run = simulate(system, start, {.duration = 100.0});
  ASSERT_GE(run.events.size(), 100U);
  const double flight = 1.0 / 2.0, contact = std::numbers::pi / 3.0;
  for (std::size_t k = 0; k < run.events.size(); ++k) {
    const double hit = flight / 2.0 + static_cast<double>(k / 2) * (flight + contact);
    EXPECT_NEAR(run.events[k].time, k % 2 == 0 ? hit : hit + contact, 1e-11);
    EXPECT_NEAR(std::abs(run.events[k].velocity), 2.0, 1e-12);
  }
}

TEST(Clearance, AMassAtRestOnItsStopRests) {
  // Beside one that hits its own stops. Nothing holds or moves it: on which side of its stop it is, rounding would say.
  const auto system = [](ContactLoss loss, double damping) {
    const Eigen::Matrix2d M = Eigen::Vector2d(1.0, 0.652).asDiagonal(), K = Eigen::Vector2d(1.0, 0.0).asDiagonal();
    const Stop hard{.stiffness = 40.0, .damping = 0.1, .gap = 0.2};
    const Stop rested{.stiffness = 14.7657, .damping = damping, .gap = 0.28461878757894254};
    return HybridSystem(fem::Structure(fem::Matrix(Eigen::MatrixXd(M)), fem::Matrix(Eigen::MatrixXd(0.02 * K)),
                                       fem::Matrix(Eigen::MatrixXd(K))),
                        {Contact{.direction = Eigen::Vector2d(1.0, 0.0), .law = Clearance{hard, hard}},
                         Contact{.direction = Eigen::Vector2d(0.0, 1.0), .law = Clearance{rested, std::nullopt, loss}}},
                        Force{1.1, {{.amplitude = 0.7}}}, {}, Eigen::Vector2d(1.0, 0.0));
  };
  for (const ContactLoss loss : {ContactLoss::kGap, ContactLoss::kZeroForce}) {
    for (const double damping : {0.0, 0.25}) {
      SCOPED_TRACE(damping);
      const HybridSystem resting = system(loss, damping);
      State start{0.0, Eigen::Vector2d(0.1, -0.28461878757894254), Eigen::Vector2d::Zero()};
      const Trajectory run = simulate(resting, start, {.duration = 200.0});
      EXPECT_GT(run.events.size(), 100U);
      for (const Event& event : run.events) EXPECT_EQ(event.contact, 0) << event.time;
      EXPECT_LT(std::abs(run.final_state.q(1) - start.q(1)), 1e-15);
      EXPECT_LT(run.statistics.steps, 40 * run.statistics.events);

      // A speed of 1e-9 is more than rounding: the mass flies off, or is in contact at once and for half a period.
      start.v(1) = 1e-9;
      EXPECT_NEAR(simulate(resting, start, {.duration = 200.0}).final_state.q(1) - start.q(1), 2e-7, 1e-14);
      if (damping > 0.0) continue;
      start.v(1) = -1e-9;
      const Trajectory pressed = simulate(resting, start, {.duration = 3.0});
      std::vector<double> times;
      for (const Event& event : pressed.events)
        if (event.contact == 1) times.push_back(event.time);
      ASSERT_EQ(times.size(), 1U);
      EXPECT_NEAR(times[0], std::numbers::pi / std::sqrt(14.7657 / 0.652), 1e-6);
    }
  }
}

}  // namespace
}  // namespace slipmode::dynamics
