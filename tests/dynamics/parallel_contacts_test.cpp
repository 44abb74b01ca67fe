// Several contacts on one degree of freedom: those behind springs and stops add their forces.
#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/masses.hpp>
#include "dynamics/internal/drive_overlay.hpp"
#include "fixtures/cantilever_beam.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// One mass on a spring under 0.7 sin 0.8t, Jenkins elements (limit, stiffness) side by side, and a stop of
/// so many equal parts.
HybridSystem on_elements(const std::vector<std::pair<double, double>>& elements, int stops) {
  std::vector<friction::Contact> contacts;
  for (const auto& [limit, stiffness] : elements)
    contacts.push_back({Eigen::VectorXd::Ones(1), friction::CompliantCoulomb{limit, limit, stiffness}, 1.0});
  for (int part = 0; part < stops; ++part)
    contacts.push_back(
        {Eigen::VectorXd::Ones(1), friction::Clearance{{}, friction::Stop{.stiffness = 5.0 / stops, .gap = 0.4}}});
  return {fem::masses({.links = {{.stiffness = 1.0, .damping = 0.05}}}),
          contacts,
          friction::Force{0.8, {{.amplitude = 0.7}}},
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

const ModalModel& slipping_of(const HybridSystem& system) { return system.cache().tables(system, false).model; }

Regime regime_of(const HybridSystem& system, const std::vector<ContactRole>& roles) {
  return {system, slipping_of(system), roles};
}

/// A contact spring at one of so many degrees of freedom.
friction::Contact spring_at(Eigen::Index size, Eigen::Index at, double stiffness) {
  return {Eigen::VectorXd::Unit(size, at), friction::CompliantCoulomb{1.0, 1.0, stiffness}, 1.0};
}

TEST(ParallelContacts, PartsOfAnElementMoveAsTheWhole) {
  for (const int stops : {0, 1, 2}) {
    const HybridSystem whole = on_elements({{0.3, 1.0}}, std::min(stops, 1)),
                       parts = on_elements({{0.12, 0.4}, {0.18, 0.6}}, stops);
    const Trajectory one = simulate(whole, whole.rest(), {.duration = 300.0});
    const Trajectory two = simulate(parts, parts.rest(), {.duration = 300.0});
    EXPECT_GT(one.events.size(), 100U);
    EXPECT_NEAR(one.final_state.q[0], two.final_state.q[0], 1e-12);
    EXPECT_NEAR(one.final_state.v[0], two.final_state.v[0], 1e-12);
    EXPECT_LT(std::abs(two.audit.residual()), 1e-12);
  }
}

TEST(ParallelContacts, PartsOfAnElementOnALongChainStretchAlike) {
  // What each part exerts is told from the others by its stretch alone. Where 60 masses' modes were asked to tell them
  // apart, parts drifted by 1e-8 from one another, until a limit was reached again and again at one time.
  const auto chain = [](const std::vector<double>& shares) {
    std::vector<friction::Contact> contacts;
    for (const double share : shares)
      contacts.push_back({Eigen::VectorXd::Unit(60, 29), friction::CompliantCoulomb{0.3, 0.3, 20.0 * share}, share});
    return HybridSystem(fem::chain({.masses = 60, .damping = 0.01}), contacts, friction::Belt::constant(0.2));
  };
  const HybridSystem whole = chain({1.0}), parts = chain({0.1, 0.15, 0.2, 0.25, 0.3});
  State start = whole.rest();
  for (Eigen::Index i = 0; i < 60; ++i) start.v(i) = 0.5 * std::sin(0.7 * static_cast<double>(i * i));
  const Trajectory one = simulate(whole, start, {.duration = 60.0}), two = simulate(parts, start, {.duration = 60.0});
  EXPECT_GT(one.events.size(), 30U);
  EXPECT_EQ(two.events.size(), 5 * one.events.size());
  EXPECT_LT((one.final_state.q - two.final_state.q).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::VectorXd stretch = two.final_state.internal;
  EXPECT_LT((stretch.array() - one.final_state.internal(0)).abs().maxCoeff(), 1e-14);
}

TEST(ParallelContacts, AddUpAsAProgramOfFixedStepsAddsThem) {
  // Runge-Kutta's rule with stretches marched as stop operators: first order where a slope jumps, some 1e-8 with
  // 1,000,000 steps.
  const std::vector<std::pair<double, double>> elements = {{0.05, 0.3}, {0.1, 0.3}, {0.2, 0.4}};
  const HybridSystem system = on_elements(elements, 1);
  const Trajectory run = simulate(system, system.rest(), {.duration = 100.0});
  constexpr int kSteps = 1000000;
  constexpr double h = 100.0 / kSteps;
  std::vector<double> force(elements.size(), 0.0);
  double q = 0.0, v = 0.0;
  const auto at = [&](std::size_t k, double way) {
    return std::clamp(force[k] - elements[k].second * way, -elements[k].first, elements[k].first);
  };
  for (int step = 0; step < kSteps; ++step) {
    const double t = h * step;
    const auto acceleration = [&](double ahead, double there, double speed) {
      double sum = 0.7 * std::sin(0.8 * (t + ahead)) - there - 0.05 * speed - 5.0 * std::max(0.0, there - 0.4);
      for (std::size_t k = 0; k < elements.size(); ++k) sum += at(k, there - q);
      return sum;
    };
    const double v1 = v, a1 = acceleration(0.0, q, v1);
    const double v2 = v + 0.5 * h * a1, a2 = acceleration(0.5 * h, q + 0.5 * h * v1, v2);
    const double v3 = v + 0.5 * h * a2, a3 = acceleration(0.5 * h, q + 0.5 * h * v2, v3);
    const double v4 = v + h * a3, a4 = acceleration(h, q + h * v3, v4);
    const double way = h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    for (std::size_t k = 0; k < elements.size(); ++k) force[k] = at(k, way);
    q += way;
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  EXPECT_NEAR(run.final_state.q[0], q, 1e-7);
  EXPECT_NEAR(run.final_state.v[0], v, 1e-7);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
}

TEST(ParallelContacts, StretchAlikeUnderADriveHoweverSoft) {
  // λ_c/K_c is one number, d − y, to rounding. Where forces were solved for side by side, a soft spring's was a
  // difference of its neighbours', and beside a stiff one on a force's way all of them differences of what the force
  // would move without them: limits of 4e-9 N were passed by 4e-8 of them.
  const friction::Shaker shaker{.amplitude = 0.7, .frequency_hz = 0.2, .phase = 0.3};
  const friction::Force force{1.3, {{.amplitude = 0.7, .phase = 0.3}}};
  const auto spread = [](const std::vector<double>& stiffness, const friction::Drive& drive) {
    std::vector<friction::Contact> contacts;
    for (const double k : stiffness) contacts.push_back(spring_at(8, 2, k));
    const HybridSystem system(fem::chain({.masses = 8, .damping = 0.01}), contacts, drive, {},
                              drive.shaker() ? Eigen::MatrixXd() : Eigen::MatrixXd(Eigen::MatrixXd::Ones(8, 1)));
    const Regime regime = regime_of(system, std::vector<ContactRole>(stiffness.size(), ContactRole::kSprung));
    const DriveOverlay overlay(regime, slipping_of(system), drive);
    const Eigen::ArrayXd k = Eigen::Map<const Eigen::ArrayXd>(stiffness.data(), std::ssize(stiffness));
    double worst = 0.0;
    for (const Eigen::MatrixXd* part : {&overlay.force.c, &overlay.force.s}) {
      const Eigen::ArrayXd stretch = part->col(0).array() / k;
      worst = std::max(worst, (stretch - stretch.mean()).abs().maxCoeff() / std::abs(stretch.mean()));
    }
    return worst;
  };
  EXPECT_LT(spread({1e-9, 20.0, 1e-3, 5.0}, shaker), 1e-14);
  EXPECT_LT(spread({20.0, 1e-9, 1e-3}, shaker), 1e-14);
  EXPECT_LT(spread({1e-9, 20.0, 1e-3, 5.0}, force), 1e-14);
  EXPECT_LT(spread({1e2, 3e4, 7e6}, force), 1e-14);
  EXPECT_LT(spread({7e9, 1e2, 1e-6}, force), 1e-14);
}

TEST(ParallelContacts, ASoftSpringBesideAHeldContactIsItsStretch) {
  // λ = K (d − y) of every pair, whatever the held contact's force, 1e5 times as large. By the equations of all pairs
  // alone its row was off by 1e-9, its limit passed again and again.
  const fem::Beam beam(fixtures::source_beam(12));
  for (const double K : {0.1, 78.0, 1e4}) {
    const std::vector<friction::Contact> contacts{
        {beam.displacement_row(0.31), friction::Coulomb{0.5, 0.5}, 1.0},
        {beam.displacement_row(0.2), friction::CompliantCoulomb{0.5, 0.5, K}, 1.0}};
    const HybridSystem system(beam.structure(), contacts, friction::Belt{});
    const Regime regime = regime_of(system, {ContactRole::kHeld, ContactRole::kSprung});
    const Eigen::VectorXd own = -K * regime.displacement_row.col(1);
    EXPECT_LT((regime.force_row.col(1) - own).norm(), 1e-12 * own.norm()) << K;
  }
}

TEST(ParallelContacts, RowsOnBothSidesOfAHeldMassAreExact) {
  // λ of the held one is K q + C q̇ of its row, of springs on either side K (d − y). What the pairs of one side do to
  // the spring of the other is rounding, 1e-16 of anything, and no measure for the rest: weighed by it, the held one's
  // force was off by 1e-8.
  const fem::Structure structure = fem::masses({.mass = {1.96, 0.6, 2.4, 1.02, 2.0, 0.71, 0.35, 1.52},
                                                .links = {{0, 1, 1.95, 0.0},
                                                          {1, 2, 0.0, 0.146},
                                                          {0, 2, 0.91, 0.0},
                                                          {2, 3, 1.86, 0.084},
                                                          {1, 4, 1.88, 0.102},
                                                          {4, 5, 2.87, 0.012},
                                                          {3, 6, 1.35, 0.029},
                                                          {5, 7, 0.9, 0.057},
                                                          {6, 8, 0.0, 0.063}}});
  for (const auto& [first, second] : {std::pair(66.0, 21.0), std::pair(1e4, 0.3), std::pair(5e-3, 2e6)}) {
    const std::vector<friction::Contact> contacts{
        {Eigen::VectorXd::Unit(8, 2), friction::Coulomb{0.5, 0.5}, 1.0},
        {Eigen::VectorXd::Unit(8, 6), friction::CompliantCoulomb{0.5, 0.5, first}, 1.0},
        {Eigen::VectorXd::Unit(8, 7), friction::CompliantCoulomb{0.5, 0.5, second}, 1.0}};
    const HybridSystem system(structure, contacts, friction::Belt{});
    const ModalModel& slipping = slipping_of(system);
    const Regime regime = regime_of(system, {ContactRole::kHeld, ContactRole::kSprung, ContactRole::kSprung});
    const Eigen::MatrixXd q = slipping.to_q * regime.to_slipping, v = slipping.to_v * regime.to_slipping;
    const Eigen::VectorXd held =
        (fem::to_dense(structure.K()).row(2) * q + fem::to_dense(structure.C()).row(2) * v).transpose();
    EXPECT_LT((regime.force_row.col(0) - held).norm(), 1e-13 * held.norm()) << first;
    for (const auto& [c, K] : {std::pair(1, first), std::pair(2, second)}) {
      const Eigen::VectorXd stretch = -K * regime.displacement_row.col(c);
      EXPECT_LT((regime.force_row.col(c) - stretch).norm(), 1e-12 * stretch.norm()) << K;
    }
  }
}

TEST(ParallelContacts, SteadyForcesBesideAHeldMassAreThoseOfTheStructure) {
  // Mass 1 held, mass 3 behind a spring, along the way of one or the other, or of both in time at unit speed: K x =
  // forces, with what damps −C x' under it. K_c w wᵀ as a matrix pushed in all directions by its rounding: both forces
  // were off by 4e-17 K_c, and the energy balance of two stuck contacts by 9e-9.
  using Long = long double;
  using Two = Eigen::Matrix<Long, 2, 1>;
  Eigen::MatrixXd K(3, 3), C = Eigen::MatrixXd::Zero(3, 3);
  K << 3.0, -1.0, 0.0, -1.0, 2.5, -1.2, 0.0, -1.2, 1.6;
  C.diagonal() << 0.3, 0.9, 1.3;
  const Eigen::Vector3d m(0.9, 0.3, 0.5);
  const fem::Structure structure(fem::Matrix(Eigen::MatrixXd(m.asDiagonal())), fem::Matrix(C), fem::Matrix(K));
  for (const double spring : {1e-3, 1.0, 1e3, 1e5, 1e7, 1e9}) {
    SCOPED_TRACE(spring);
    const HybridSystem system(
        structure, {{Eigen::VectorXd::Unit(3, 0), friction::Coulomb{1.0, 1.0}, 1.0}, spring_at(3, 2, spring)},
        friction::Belt::constant(1.0));
    const Regime regime = regime_of(system, {ContactRole::kHeld, ContactRole::kSprung});
    Eigen::Matrix<Long, 2, 2> free = K.bottomRightCorner(2, 2).cast<Long>();
    free(1, 1) += spring;
    const auto places = [&](const Two& forces) -> Two { return free.fullPivLu().solve(forces); };
    const Eigen::Vector2d c(C(1, 1), C(2, 2));
    const Two by_held = places(Two(-K(0, 1), 0.0L)), by_spring = places(Two(0.0L, spring)), speed = by_held + by_spring,
              lag = places(-(c.cast<Long>().cwiseProduct(speed)));
    const auto expect = [&](Eigen::Index input, Long held_place, const Two& x, Long damped_held, Long damped) {
      const Long held = K(0, 0) * held_place + K(0, 1) * x(0) + damped_held,
                 sprung = K(2, 1) * x(0) + K(2, 2) * x(1) + damped;
      EXPECT_NEAR(regime.steady_force(input, 0), static_cast<double>(held), 1e-14 + 1e-16 * std::sqrt(spring));
      EXPECT_NEAR(regime.steady_force(input, 1), static_cast<double>(sprung), 1e-14 + 1e-16 * std::sqrt(spring));
    };
    expect(0, 1.0L, by_held, 0.0L, 0.0L);
    expect(1, 0.0L, by_spring, 0.0L, 0.0L);
    expect(regime.speed_input(), 0.0L, lag, C(0, 0), C(2, 2) * speed(1));
  }
}

TEST(ParallelContacts, SteadyForcesOfSpringsThatCarryAFloatingMassAddUpToNone) {
  // Springs k_i on one mass that nothing else holds, K of them all: along the way of k_j the mass goes by k_j / K, and
  // each exerts k_i (δ_ij − k_j / K). By its row, the stiff one's force was 3e-17 of its stiffness out.
  for (const double stiff : {1e3, 1e5, 1e8}) {
    SCOPED_TRACE(stiff);
    const Eigen::Vector3d k(79.0, 0.7, stiff);
    const HybridSystem system(fem::masses({.mass = {0.317}, .links = {{.damping = 0.0137}}}),
                              {spring_at(1, 0, k(0)), spring_at(1, 0, k(1)), spring_at(1, 0, k(2))},
                              friction::Belt::constant(1.0));
    const Regime regime = regime_of(system, std::vector<ContactRole>(3, ContactRole::kSprung));
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const double moved = i == j ? k((j + 1) % 3) + k((j + 2) % 3) : -k(j), force = k(i) / k.sum() * moved;
        EXPECT_NEAR(regime.steady_force(j, i), force, 2e-13 * std::abs(force)) << j << " " << i;
      }
  }
}

TEST(ParallelContacts, WhatGoesAlongWithTheWaysOfSpringsMovesNothing) {
  // Masses 1 and 4 stick behind springs, 2 and 3 hang on them by a damper. Where 1 and 4 have come as far as the
  // springs' ends, nothing is stretched and nothing moves: ẋ = G x + B ways = 0. The slow decay of 2 and 3 was refined
  // as if it had no rate, by equations of rounding: 2e-11 out, states 5e-10 after 3 s.
  for (const double damper : {1e-6, 1e-3, 0.146, 10.0}) {
    SCOPED_TRACE(damper);
    const fem::Structure structure = fem::masses(
        {.mass = {1.75, 2.46, 0.96, 0.57}, .links = {{1, 2, 0.0, damper}, {2, 3, 1.56, 0.069}, {1, 4, 2.81, 0.144}}});
    const HybridSystem system(structure, {spring_at(4, 0, 12.1), spring_at(4, 3, 2.19), spring_at(4, 0, 4.38)},
                              friction::Belt::constant(1.0));
    const Regime regime = regime_of(system, std::vector<ContactRole>(3, ContactRole::kSprung));
    const auto np = regime.pairs.np;
    const Eigen::VectorXd x = regime.from_slipping * (slipping_of(system).from_q * Eigen::Vector4d(1.0, 0.0, 0.0, 1.0)),
                          by_ways = regime.B.leftCols(3).rowwise().sum();
    const ModalModel& g = regime.pairs;
    const Eigen::VectorXd first = g.g11.cwiseProduct(x.head(np)) + g.g12.cwiseProduct(x.tail(np)),
                          second = g.g21.cwiseProduct(x.head(np)) + g.g22.cwiseProduct(x.tail(np));
    EXPECT_LT((first + by_ways.head(np)).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((second + by_ways.tail(np)).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(ParallelContacts, AllWaysAtOnceStretchSpringsByWhatTheStructureResists) {
  // Each mass behind a spring: λ = K q, q = 1 − λ_c / K_c for ends that have all come by 1, so (I + K diag(1/K_c)) λ =
  // K 1. Way by way the force is the sum of columns of size K_c: 1e-7 of the structure's out at 1e9. A belt that pulls
  // ends of 5 m by that was off by as much in each of thousands of short stays, to one side.
  Eigen::MatrixXd K(3, 3);
  K << 2.3, -1.1, -0.4, -1.1, 1.9, -0.5, -0.4, -0.5, 0.9;
  const fem::Structure structure{fem::Matrix(Eigen::MatrixXd(Eigen::Vector3d(1.2, 0.7, 2.1).asDiagonal())),
                                 fem::Matrix(Eigen::MatrixXd(0.03 * K)), fem::Matrix(K)};
  for (const double spring : {1.0, 1e3, 1e6, 1e9}) {
    SCOPED_TRACE(spring);
    const Eigen::Vector3d springs(3.0, spring, 0.4 * spring);
    const HybridSystem system(structure,
                              {spring_at(3, 0, springs(0)), spring_at(3, 1, springs(1)), spring_at(3, 2, springs(2))},
                              friction::Belt::constant(1.0));
    const Regime regime = regime_of(system, std::vector<ContactRole>(3, ContactRole::kSprung));
    const Eigen::Vector3d force =
        (Eigen::Matrix3d::Identity() + K * springs.cwiseInverse().asDiagonal()).inverse() * K.rowwise().sum();
    Eigen::VectorXd inputs = Eigen::VectorXd::Zero(regime.inputs());
    inputs.head(3).setConstant(5.0);
    for (Eigen::Index c = 0; c < 3; ++c) {
      EXPECT_NEAR(regime.steady_together(c), force(c), 1e-13);
      EXPECT_NEAR(regime.held_force(c, inputs), 5.0 * force(c), 5e-13);
    }
  }
}

TEST(ParallelContacts, PlacesOfWhatFloatsHaveNoForceOfSprings) {
  // Three parts that hang on dampers alone beside one that a spring holds: their places are nothing to it. As K_c times
  // what its own row rounds by, the force was 3e-16 K_c of the place, and left so where that is no small share of the
  // row's largest entry, of a coordinate in other units.
  const fem::Structure structure = fem::masses({.mass = {0.387, 2.138, 0.455, 1.669, 0.673, 0.894, 1.437},
                                                .links = {{0, 1, 1.578, 0.055},
                                                          {1, 2, 0.631, 0.074},
                                                          {0, 2, 0.444, 0.080},
                                                          {1, 3, 0.0, 0.131},
                                                          {3, 4, 0.0, 0.102},
                                                          {3, 5, 1.842, 0.101},
                                                          {2, 6, 0.0, 0.136},
                                                          {3, 7, 0.0, 0.0022}}});
  for (double spring = 30.0; spring < 1e8; spring *= 1.3) {
    SCOPED_TRACE(spring);
    const HybridSystem system(structure, {spring_at(7, 4, spring)}, friction::Belt::constant(1.0));
    const Regime regime = regime_of(system, {ContactRole::kSprung});
    int places = 0;
    for (Eigen::Index i = 0; i < regime.pairs.n; ++i) {
      if (regime.pairs.g11(i) != 0.0 || regime.pairs.g21(i) != 0.0) continue;
      ++places;
      const double far = (slipping_of(system).to_q * regime.to_slipping.col(i)).cwiseAbs().maxCoeff();
      EXPECT_LT(std::abs(regime.force_row(i, 0)), 1e-16 * std::sqrt(spring) * far) << i;
    }
    EXPECT_EQ(places, 3);
  }
}

TEST(ParallelContacts, OfStiffSpringsTurnOnceWhereTheMassDoes) {
  // Elements that stretch by 1e-10 m down to 1e-15 m before they slide, under a mass that moves by metres: where the
  // speed turns, each ceases to slide and begins to, once. By collocation as in the closed form, and as by hand. Where
  // a stretch was a difference of places, and of times by the clock, elements that had just ceased to slide found
  // themselves beyond their limit again and again.
  using friction::Drive;
  for (const Drive& drive :
       {Drive(friction::Shaker{.amplitude = 1.0, .frequency_hz = 0.3, .phase = 0.4}), Drive(friction::Belt{})})
    for (const double limit : {1e-4, 1e-7, 1e-9})
      for (const double tolerance : {1e-9, 1e-12}) {
        SCOPED_TRACE(testing::Message() << drive.period().has_value() << " " << limit << " " << tolerance);
        std::vector<friction::Contact> contacts;
        for (const double part : {1.0, 2.0, 3.0})
          contacts.push_back(
              {Eigen::VectorXd::Ones(1), friction::CompliantCoulomb{part * limit, part * limit, 1e6}, 1.0});
        const HybridSystem system(fem::masses({.links = {{.stiffness = 1.0}}}), contacts, drive);
        State start = system.rest();
        start.q(0) = 1.0;
        start.v(0) = 0.5;
        const auto run = [&](FlowMethod method) {
          return simulate(system, start, {.duration = 40.0, .flow = {.method = method, .tolerance = tolerance}});
        };
        const Trajectory exact = run(FlowMethod::kClosedForm), by_nodes = run(FlowMethod::kCollocation);
        ASSERT_EQ(by_nodes.events.size(), exact.events.size());
        EXPECT_EQ(std::ranges::count(by_nodes.events, EventKind::kJump, &Event::kind), 0);
        // Turned by an acceleration a, an element slides again when it has gone 2 L/k: after √(4 L/(k a)).
        double turned = 0.0, acceleration = 0.0;
        for (std::size_t k = 0; k < exact.events.size(); ++k) {
          const Event& event = by_nodes.events[k];
          if (limit > 1e-8) {  // below, its places round by more
            EXPECT_NEAR(event.time, exact.events[k].time, 2e-9);
          }
          if (event.kind == EventKind::kStick) {
            turned = event.time;
            acceleration = std::abs(drive.acceleration(turned) + event.displacement);
          } else if (turned > 0.0) {
            const double after = std::sqrt(4.0 * (event.contact + 1) * limit / 1e6 / acceleration);
            EXPECT_NEAR((event.time - turned) / after, 1.0, 6.0 * limit + 1e-6);  // beside a: the three forces
          }
        }
        EXPECT_NEAR(by_nodes.final_state.q(0), exact.final_state.q(0), 1e-11);
        EXPECT_LT(std::abs(by_nodes.audit.residual()), 1e-12);
      }
}

TEST(ParallelContacts, OfAStiffStopOnAHeldMassLeaveTheMotionItsDigits) {
  // Two masses, the second held by friction on a shaker A sin ωt and pressed against a stop of stiffness k: it moves as
  // the shaker does, however large the force k A sin ωt that friction bears.
  const friction::Shaker shaker{.amplitude = 0.6, .frequency_hz = 0.05, .phase = 0.4};
  const double omega = shaker.omega();
  for (const double k : {1e2, 1e6}) {
    SCOPED_TRACE(k);
    const Eigen::VectorXd held = Eigen::VectorXd::Unit(2, 1);
    const HybridSystem system(fem::chain({.masses = 2, .damping = 0.04}),
                              {{held, friction::Coulomb{1.0, 1.0}, 10.0 * k},
                               {held, friction::Clearance{{}, friction::Stop{.stiffness = k, .gap = -2.0}}}},
                              shaker);
    State start = system.rest();
    start.q << 0.1, shaker.amplitude * std::sin(shaker.phase);
    start.v << 0.05, shaker.amplitude * omega * std::cos(shaker.phase);
    const Trajectory run = simulate(system, start, {.duration = 5.0, .sample = 0.1});
    EXPECT_EQ(run.events.size(), 0U);
    EXPECT_LT((run.q.col(0) - start.q).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((run.v.col(0) - start.v).cwiseAbs().maxCoeff(), 1e-15);
    for (Eigen::Index i = 0; i < run.times.size(); ++i) {
      EXPECT_NEAR(run.q(1, i), shaker.amplitude * std::sin(omega * run.times[i] + shaker.phase), 2e-15);
      EXPECT_NEAR(run.lambda(1, i), -k * (run.q(1, i) + 2.0), 1e-14 * k);
    }
    // The works of stop and friction are some k each, and take one another away.
    EXPECT_LT(std::abs(run.audit.residual()), 1e-13 + 1e-15 * k);
  }
}

TEST(ParallelContacts, ThatStickRigidlyAreRefused) {
  const HybridSystem system = on_elements({{0.1, 1.0}, {0.2, 1.0}}, 0);
  std::vector<friction::Contact> rigid = system.contacts();
  for (friction::Contact& contact : rigid) contact.law = friction::Coulomb{0.3, 0.3};
  EXPECT_THROW((void)system.with_laws(rigid), InvalidInput);
  rigid.front().law = friction::Dahl{0.3, 1.0};
  EXPECT_THROW((void)system.with_laws(rigid), InvalidInput);
  rigid.front() = system.contacts().front();
  EXPECT_THROW((void)system.with_laws(rigid), InvalidInput);
  rigid.front().law = friction::Clearance{{}, friction::Stop{.stiffness = 1.0}};
  EXPECT_NO_THROW((void)system.with_laws(rigid));
}

}  // namespace
}  // namespace slipmode::dynamics
