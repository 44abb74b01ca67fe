#include <slipmode/orbits/basins.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/fem/chain.hpp>
#include "orbits/clearance_systems.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

using Kind = BasinAttractor::Kind;

dynamics::State at(double x, double v) {
  return {.q = Eigen::VectorXd::Constant(1, x), .v = Eigen::VectorXd::Constant(1, v)};
}

/// [low, high]² with so many starts each way.
MapGrid square(double low, double high, int count) {
  MapGrid grid;
  for (int k = 0; k < count; ++k) grid.x.push_back(low + (high - low) * k / (count - 1));
  grid.y = grid.x;
  return grid;
}

double share_of(const Basins& basins, Kind kind) {
  std::size_t own = 0, all = 0;
  for (const auto& row : basins.rows) {
    for (const BasinCell& cell : row) {
      ++all;
      if (cell.attractor >= 0 && basins.attractors[static_cast<std::size_t>(cell.attractor)].kind == kind) ++own;
    }
  }
  return static_cast<double>(own) / static_cast<double>(all);
}

struct Figure {
  const char* name;
  double xi, a, omega, in_gap;
};

class BasinsOfPlay : public testing::TestWithParam<Figure> {};

// Shares of 101² starts over [−2, 2]² and of the strip: computed beforehand by another program (Runge-Kutta with
// events), to 0.3 %. Parameters: S2's Figures 3, 4 and 10.
TEST_P(BasinsOfPlay, EndInTheGapAsOftenAsKnown) {
  const auto& [name, xi, a, omega, in_gap] = GetParam();
  const MapGrid grid = square(-2.0, 2.0, 101);
  const Basins found = basins(BasinFinder(play(xi, a, omega), {}), at, grid);
  EXPECT_NEAR(share_of(found, Kind::kGap), in_gap, 0.003);
  EXPECT_EQ((found.labels().array() < 0).count(), 0);
  EXPECT_LE(found.attractors.size(), 3U);  // gap, its edge, and at most the one orbit S2 shows beside it
  const double strip = static_cast<double>((found.room.array() > 0.0).count()) / static_cast<double>(found.room.size());
  EXPECT_GT(strip, 0.0135);
  EXPECT_LT(strip, 0.0655);
  // S2 (15) says of a start whether its linear motion ends in the gap.
  const double reach = a / (omega * std::hypot(2.0 * xi, omega));
  for (Eigen::Index j = 0; j < found.room.rows(); ++j) {
    for (Eigen::Index i = 0; i < found.room.cols(); ++i) {
      const double middle = grid.x[static_cast<std::size_t>(i)] + grid.y[static_cast<std::size_t>(j)] / (2.0 * xi);
      ASSERT_NEAR(found.room(j, i), 1.0 - reach - std::abs(middle), 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(S2, BasinsOfPlay,
                         testing::Values(Figure{"Figure3", 0.13058, 0.1, 0.3, 0.305},
                                         Figure{"Figure4", 0.19884, 0.1, 0.3, 1.0},
                                         Figure{"Figure10", 0.2, 0.3, 0.5005, 0.181}),
                         [](const auto& tested) { return tested.param.name; });

// The definition of a label: a function of the start and of the attractors alone.
TEST(Basins, AStartFollowedAloneHasTheLabelOfItsCell) {
  const MapGrid grid = square(-2.0, 2.0, 101);
  const BasinFinder finder(play(0.2, 0.3, 0.5005), {});
  const Basins found = basins(finder, at, grid);
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    const auto i = static_cast<std::size_t>(101.0 * random.uniform()),
               j = static_cast<std::size_t>(101.0 * random.uniform());
    ASSERT_EQ(finder.follow(at(grid.x[i], grid.y[j]), found.attractors).cell.attractor, found.rows[j][i].attractor)
        << grid.x[i] << ", " << grid.y[j];
  }
}

// S0's single mass at ω = 0.49 has two mirror images of a period-5 orbit that only some starts reach; a sample of one
// start finds neither both nor in that order, yet starts end where they ended.
TEST(Basins, AttractorsNotInTheSampleAreFoundOnTheWay) {
  const dynamics::HybridSystem system = Backlash{.omega = 0.49}.system();
  const MapGrid grid = square(-3.0, 3.0, 13);
  const Basins whole = basins(BasinFinder(system, {}), at, grid);
  const Basins sparse = basins(BasinFinder(system, {.sample = 1}), at, grid, {.threads = 2});
  ASSERT_EQ(whole.attractors.size(), 2U);
  ASSERT_EQ(sparse.attractors.size(), 2U);
  const BasinFinder finder(system, {});
  for (std::size_t j = 0; j < 13; ++j) {
    for (std::size_t i = 0; i < 13; ++i) {
      const auto& mine = sparse.attractors[static_cast<std::size_t>(sparse.rows[j][i].attractor)];
      EXPECT_EQ(static_cast<int>(finder.index_of(mine, whole.attractors)), whole.rows[j][i].attractor);
    }
  }
}

TEST(Basins, AreTheSameForAnyNumberOfThreads) {
  const MapGrid grid = square(-2.0, 2.0, 21);
  const BasinFinder finder(play(0.13058, 0.1, 0.3), {});
  const Basins one = basins(finder, at, grid, {.threads = 1}), three = basins(finder, at, grid, {.threads = 3});
  ASSERT_EQ(one.labels(), three.labels());
  for (std::size_t j = 0; j < 21; ++j) {
    for (std::size_t i = 0; i < 21; ++i) {
      EXPECT_EQ(one.rows[j][i].periods, three.rows[j][i].periods);
      const double a = one.rows[j][i].coordinate, b = three.rows[j][i].coordinate;
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
    }
  }
}

// The reference's coexisting pair of S1 at η = 0.6: stable orbits with and without contact.
TEST(Basins, OfThreeMassesHaveTwoAttractors) {
  const dynamics::HybridSystem system = three_masses(0.6);
  const auto start = [&](double x, double y) {
    dynamics::State state = system.rest();
    state.modes = {};
    state.q << x, y;
    return state;
  };
  const Basins found = basins(BasinFinder(system, {}), start, square(-2.0, 4.0, 13));
  ASSERT_EQ(found.attractors.size(), 2U);
  for (const BasinAttractor& one : found.attractors) {
    EXPECT_EQ(one.kind, Kind::kOrbit);
    EXPECT_EQ(one.orbit.order, 1);
    EXPECT_LT(one.orbit.leading_modulus, 1.0);
    EXPECT_GT(one.trap.radius, 0.0);
  }
}

// S1 printed: no periodic motion for 0.77 < η < 0.94. With an exponent it is chaotic, without one nothing is claimed.
TEST(Basins, MotionThatDoesNotRepeatIsChaoticByItsExponentOrUndecided) {
  const dynamics::HybridSystem system = three_masses(0.85);
  const auto start = [&](double x, double y) {
    dynamics::State state = system.rest();
    state.modes = {};
    state.q << x, y;
    return state;
  };
  BasinOptions options;
  options.settle.max_periods = 200;
  const MapGrid grid{.x = {0.0, 2.0}, .y = {0.0, 2.0}};
  const Basins silent = basins(BasinFinder(system, options), start, grid);
  EXPECT_TRUE((silent.labels().array() == BasinCell::kUndecided).all());
  options.exponent = [](const dynamics::HybridSystem& of, const dynamics::State& from) {
    const double period = of.drive().period().value();
    const auto found = diagnostics::largest_exponent(
        of, from, {.transient = 0.0, .duration = 1000.0 * period, .interval = period, .flow = {.audit = false}});
    return MeasuredExponent{found.nats, found.error};
  };
  const Basins found = basins(BasinFinder(system, options), start, grid);
  ASSERT_EQ(found.attractors.size(), 1U);
  EXPECT_EQ(found.attractors[0].kind, Kind::kChaotic);
  EXPECT_GT(found.attractors[0].exponent, 4.0 * found.attractors[0].exponent_error);
  EXPECT_TRUE((found.labels().array() == 0).all());
}

// (x′ + 2ξx)′ = a cos ωt in the gap: the mean place a start goes to is x + x′/(2ξ).
TEST(GapMotion, OfAFloatingMassIsToldByWhereItEnds) {
  const double xi = 0.2, a = 0.3, omega = 0.5005;
  const GapMotion gap = GapMotion::of(play(xi, a, omega)).value();
  EXPECT_EQ(gap.continuum(), GapMotion::Continuum::kShift);
  for (const Eigen::Vector2d& x : {Eigen::Vector2d(0.3, -0.1), Eigen::Vector2d(-0.5, 0.25)}) {
    EXPECT_NEAR(gap.coordinate(x), x(0) + x(1) / (2.0 * xi), 1e-13);
  }
  EXPECT_NEAR(gap.room(gap.middle()).least, 1.0 - a / (omega * std::hypot(2.0 * xi, omega)), 1e-12);
}

// x″ + x = a cos ωt without damping: free vibrations of amplitude |(x − a/(1 − ω²), x′)| last beside the steady ones.
TEST(GapMotion, WithoutDampingKeepsItsFreeVibration) {
  const friction::Stop stop{.stiffness = 1.0, .gap = 1.0};
  const double a = 0.3, omega = 0.5, reach = a / (1.0 - omega * omega);
  const dynamics::HybridSystem system(
      fem::masses({.links = {{.stiffness = 1.0}}}),
      {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop, friction::ContactLoss::kGap}}},
      friction::Force{omega, {{.amplitude = a, .phase = std::numbers::pi / 2.0}}}, {}, Eigen::MatrixXd::Ones(1, 1));
  const GapMotion gap = GapMotion::of(system).value();
  EXPECT_EQ(gap.continuum(), GapMotion::Continuum::kFree);
  const Eigen::Vector2d x(0.5, -0.2);
  const double free = std::hypot(0.5 - reach, -0.2);
  EXPECT_NEAR(gap.coordinate(x), free, 1e-13);
  EXPECT_NEAR(gap.room(x).least, 1.0 - reach - free, 1e-13);
  const BasinFinder finder(system, {});
  const BasinFinder::Arrival inside = finder.follow(at(0.5, -0.2), finder.gap_attractors());
  EXPECT_EQ(inside.cell.attractor, 0);
  EXPECT_EQ(inside.cell.periods, 0);
}

TEST(GapMotion, IsNoneWhereNothingHoldsTheLoadOrContactsAreOthers) {
  EXPECT_FALSE(GapMotion::of(three_masses(0.6)));  // its mean load meets no stiffness in the gap
  const friction::Stop stop{.stiffness = 1.0, .gap = 1.0};
  const dynamics::HybridSystem drifting(fem::masses({}), {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop}}},
                                        Backlash::drive(1.0, 1.0), {}, Eigen::MatrixXd::Ones(1, 1));
  EXPECT_FALSE(GapMotion::of(drifting));
}

// Beyond the end of the continuum by ρ the stop's impulse is (4√2/3) k ρ^{3/2}/√|y″| a period and moves the mass by
// that over 2ξ: ρ^{−1/2} grows by c = (2√2/3) k/(2ξ √(Aω²)) every period (docs/theory/basins.md, section 4).
TEST(Basins, TheEdgeOfTheGapIsApproachedWithTheSquareOfTime) {
  const double xi = 0.2, a = 0.3, omega = 0.5005;
  const dynamics::HybridSystem system = play(xi, a, omega);
  const BasinFinder finder(system, {});
  const auto attractors = finder.gap_attractors();
  ASSERT_EQ(attractors.size(), 2U);
  const dynamics::State start = at(-1.4, -2.0);  // one of those that end there
  const BasinFinder::Arrival arrival = finder.follow(start, attractors);
  ASSERT_EQ(arrival.cell.attractor, 1);
  EXPECT_EQ(attractors[1].kind, Kind::kEdge);
  const double period = system.drive().period().value();
  const auto beyond = [&](int periods) {
    const dynamics::State end = advanced(system, start, periods * period);
    return -finder.gap()->room_at_end(stacked(end)).least;
  };
  const double per_period = (1.0 / std::sqrt(beyond(1000)) - 1.0 / std::sqrt(beyond(300))) / 700.0;
  const double reach = a / (omega * std::hypot(2.0 * xi, omega));
  const double law = 2.0 * std::numbers::sqrt2 / 3.0 / (2.0 * xi * std::sqrt(reach * omega * omega));
  EXPECT_NEAR(per_period / law, 1.0, 0.01);  // next order in √ρ: 0.003 at 300 periods
}

// What the trap claims, at points that it was not measured at.
TEST(Trap, EveryPointOfItEndsOnTheOrbit) {
  const dynamics::HybridSystem system = play(0.2, 0.3, 0.5005);
  const Basins found = basins(BasinFinder(system, {}), at, square(-2.0, 2.0, 5));
  const auto orbit = std::ranges::find(found.attractors, Kind::kOrbit, &BasinAttractor::kind);
  ASSERT_NE(orbit, found.attractors.end());
  const Trap& trap = orbit->trap;
  ASSERT_GT(trap.radius, 0.0);
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi),
                 radius = trap.radius * std::sqrt(random.uniform());
    const Eigen::Vector2d inside =
        trap.centre + trap.L.inverse() * Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
    ASSERT_TRUE(trap.holds(at(inside(0), inside(1))));
    const dynamics::State end = advanced(system, at(inside(0), inside(1)), 80.0 * orbit->orbit.period);
    EXPECT_LT((stacked(end) - trap.centre).norm(), 1e-9);  // the multiplier 0.724 to the 80th is 6e-12
  }
}

TEST(Trap, IsMeasuredWhereContactsStickBesideSprings) {
  // At the orbit's origin the first mass may stick on its rigid contact; the trap's own starts move it, while the
  // second one's spring keeps its mode.
  const friction::Contact rigid{Eigen::VectorXd::Unit(2, 0), friction::Stribeck{0.4, 0.3, 2.0}, 0.5},
      sprung{Eigen::VectorXd::Unit(2, 1), friction::CompliantCoulomb{0.3, 0.3, 3.0}, 0.5};
  const dynamics::HybridSystem system(fem::chain({.masses = 2, .damping = 0.1}), {rigid, sprung},
                                      friction::Force{0.7, {{.amplitude = 1.0, .phase = 0.3}}}, {},
                                      Eigen::VectorXd::Unit(2, 1));
  const auto start = [](double x, double v) {
    return dynamics::State{.q = Eigen::Vector2d(x, 0.0), .v = Eigen::Vector2d(v, 0.0)};
  };
  const Basins found = basins(BasinFinder(system, {}), start, square(-0.5, 0.5, 4));
  EXPECT_FALSE(found.attractors.empty());
  EXPECT_EQ((found.labels().array() < 0).count(), 0);
}

TEST(Basins, SayWhatIsWrong) {
  const dynamics::HybridSystem system = play(0.2, 0.3, 0.5005);
  EXPECT_THROW(BasinFinder(system, {.patience = -1}), InvalidInput);
  EXPECT_THROW(BasinFinder(system, {.sample = 0}), InvalidInput);
  EXPECT_THROW((void)basins(BasinFinder(system, {}), at, {.x = {1.0}, .y = {}}), InvalidInput);
  dynamics::State late = at(0.0, 0.0);
  late.time = 1.0;
  EXPECT_THROW((void)BasinFinder(system, {}).follow(late, {}), InvalidInput);
  const dynamics::HybridSystem belt(fem::masses({.links = {{.stiffness = 1.0}}}),
                                    {{.direction = Eigen::VectorXd::Ones(1), .law = friction::Coulomb{0.3, 0.3}}},
                                    friction::Belt::constant(0.1));
  EXPECT_THROW(BasinFinder(belt, {}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
