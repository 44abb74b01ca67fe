// Orbits of systems with clearances: S0 (one and four masses), S2, closed forms, and an independent integrator.
#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "backlash_reference.hpp"
#include "clearance_systems.hpp"
#include "fixtures/differences.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::State;
using Complex = std::complex<double>;

/// Settled from a displacement for 60 periods.
PeriodicOrbit orbit_after_settling(const HybridSystem& system, double x, const ShootingOptions& options = {}) {
  return find_orbit(system, settle_guess(system, displaced(system, 0, x), 60.0), options);
}

void expect_multipliers(const PeriodicOrbit& orbit, const std::vector<Complex>& expected, double tolerance) {
  ASSERT_EQ(orbit.multipliers.size(), static_cast<Eigen::Index>(expected.size()));
  for (const Complex& mu : expected) EXPECT_LT((orbit.multipliers.array() - mu).abs().minCoeff(), tolerance) << mu;
}

// --- closed forms ---------------------------------------------------------------------------------------------------

TEST(ClearanceOrbits, WithoutContactTheOscillatorIsLinear) {
  // m q̈ + c q̇ + k q = A sin ωt: q = A sin(ωt − φ)/√((k − mω²)² + c²ω²), multipliers e^{λT}.
  const double m = 1.3, c = 0.3, k = 2.0, A = 0.4, omega = 0.9;
  const friction::Stop far{.stiffness = 1.0, .gap = 50.0};
  const HybridSystem system(fem::masses({.mass = {m}, .links = {{.stiffness = k, .damping = c}}}),
                            {{Eigen::VectorXd::Ones(1), friction::Clearance{far, far}}}, Backlash::drive(A, omega), {},
                            Eigen::MatrixXd::Ones(1, 1));
  const PeriodicOrbit orbit = find_orbit(system, system.rest());
  const double size = A / std::hypot(k - m * omega * omega, c * omega);
  const double lag = std::atan2(c * omega, k - m * omega * omega);
  EXPECT_NEAR(orbit.start.q[0], -size * std::sin(lag), 1e-12);
  EXPECT_NEAR(orbit.start.v[0], size * omega * std::cos(lag), 1e-12);
  const Complex lambda(-c / (2 * m), std::sqrt(k / m - c * c / (4 * m * m)));
  expect_multipliers(orbit, {std::exp(lambda * orbit.period), std::exp(std::conj(lambda) * orbit.period)}, 1e-12);
  EXPECT_TRUE(orbit.symmetric);
  EXPECT_EQ(orbit.word, "g");
  EXPECT_LE(orbit.iterations, 2);  // a linear problem; the first step is held to the size of the guess
  const Amplitude a = amplitude(system, orbit, Eigen::VectorXd::Ones(1));
  EXPECT_NEAR(a.alternating, size, 1e-11);
  EXPECT_NEAR(a.effective, size / std::numbers::sqrt2, 1e-11);
  EXPECT_NEAR(a.mean, 0.0, 1e-12);
}

TEST(ClearanceOrbits, AGuessAtRestOnAStopIsAGuess) {
  // Its stop is reached at once and at rest: what that adds to tangents is 0/0.
  const HybridSystem system = play(0.02, 1.2, 1.0);
  for (const double side : {1.0, -1.0}) {
    const PeriodicOrbit orbit = find_orbit(system, displaced(system, 0, side));
    EXPECT_EQ(orbit.word, "g l g r");
    EXPECT_NEAR(orbit.leading_modulus, std::exp(-0.02 * orbit.period), 1e-12);  // a pair: its product is e^{−cT}
  }
}

TEST(ClearanceOrbits, PlayWithoutDampingIsBoundedAtItsOwnFrequency) {
  // q'' + q = A sin t in the gap of 1, q'' + 5q = 4 + A sin t beyond. The odd orbit that is symmetric about quarter
  // periods: q = a sin t − (A/2) t cos t up to the stop at t₁, then 4/5 + (A/4) sin t + b cos √5(t − π/2); a and b from
  // q(t₁) = 1, t₁ from the speed, which does not jump.
  const double A = 0.3, own = std::sqrt(5.0), quarter = std::numbers::pi / 2.0;
  const auto a = [&](double t) { return (1.0 + A / 2.0 * t * std::cos(t)) / std::sin(t); };
  const auto jump = [&](double t) {
    const double b = (0.2 - A / 4.0 * std::sin(t)) / std::cos(own * (t - quarter));
    return a(t) * std::cos(t) - A / 2.0 * (std::cos(t) - t * std::sin(t)) - A / 4.0 * std::cos(t) +
           own * b * std::sin(own * (t - quarter));
  };
  double t1 = 1.0, high = 1.2;
  for (int halving = 0; halving < 52; ++halving) (jump((t1 + high) / 2.0) < 0.0 ? t1 : high) = (t1 + high) / 2.0;
  const auto one = [](double value) -> fem::Matrix { return Eigen::MatrixXd::Constant(1, 1, value); };
  const friction::Stop stop{.stiffness = 4.0, .gap = 1.0};
  const HybridSystem system(fem::Structure(one(1.0), one(0.0), one(1.0)),
                            {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop}}}, Backlash::drive(A, 1.0), {},
                            Eigen::MatrixXd::Ones(1, 1));
  State guess = system.rest();
  guess.v[0] = 1.2;
  const PeriodicOrbit orbit = find_orbit(system, guess);
  EXPECT_NEAR(orbit.start.q[0], 0.0, 1e-10);
  EXPECT_NEAR(orbit.start.v[0], a(t1) - A / 2.0, 1e-10);
  EXPECT_EQ(orbit.crossings, 4);
  // Nothing is lost and no speed jumps: the tangents turn by each stay's own frequency.
  const auto turn = [](double w, double t) {
    return Eigen::Matrix2d{{std::cos(w * t), std::sin(w * t) / w}, {-w * std::sin(w * t), std::cos(w * t)}};
  };
  const Eigen::Matrix2d half = turn(1.0, t1) * turn(own, 2.0 * (quarter - t1)) * turn(1.0, t1);
  const Eigen::VectorXcd mu = Eigen::MatrixXd(half * half).eigenvalues();
  expect_multipliers(orbit, {mu(0), mu(1)}, 1e-9);
  EXPECT_NEAR(orbit.monodromy.determinant(), 1.0, 1e-11);
  const auto end_of = [&](const State& from) {
    return stacked(dynamics::simulate(system, from, {.duration = orbit.period}).final_state);
  };
  EXPECT_LT((fixtures::slopes(orbit.start, end_of, 1e-4) - orbit.monodromy).norm(), 1e-9 * orbit.monodromy.norm());
}

TEST(ClearanceOrbits, FloatingInTheGapIsAFamily) {
  // S0 orbit A: a sine of amplitude A/(ω √(ω² + c²)); any shift that keeps clear of the stops is an orbit too.
  // Multipliers 1 and e^{−cT}; single shooting is singular as well as multiple (S0 section 3.2 excepts it).
  const HybridSystem system = Backlash{.omega = 1.4}.system();
  const double size = 1.0 / (1.4 * std::hypot(1.4, 0.05));
  State guess = displaced(system, 0, 0.2);
  guess.v[0] = -0.7;  // slower and it drifts into a stop
  for (const int segments : {1, 3}) {
    const PeriodicOrbit orbit = find_orbit(system, guess, {.segments = segments});
    EXPECT_EQ(orbit.crossings, 0);
    ASSERT_EQ(orbit.family.cols(), 1);
    EXPECT_LT((orbit.family.col(0).cwiseAbs() - Eigen::Vector2d(1.0, 0.0)).norm(), 1e-9);
    EXPECT_THAT(orbit.family_note, testing::HasSubstr("family"));
    expect_multipliers(orbit, {1.0, std::exp(-0.05 * orbit.period)}, 1e-10);
    EXPECT_EQ(orbit.stability, Stability::kStable);  // the shift is no matter of stability
    EXPECT_NEAR(amplitude(system, orbit, Eigen::VectorXd::Ones(1)).alternating, size, 1e-10);
  }
  // Half periods choose the centred one.
  const PeriodicOrbit centred = find_orbit(system, guess, {.half_period = true});
  EXPECT_NEAR(amplitude(system, centred, Eigen::VectorXd::Ones(1)).mean, 0.0, 1e-12);
  EXPECT_EQ(centred.family.cols(), 1);
}

TEST(ClearanceOrbits, AShiftedOrbitOfAFamilyIsAnOrbit) {
  const HybridSystem system = Backlash{.omega = 1.4}.system();
  State guess = system.rest();
  guess.v[0] = -0.7;
  const PeriodicOrbit orbit = find_orbit(system, guess, {.half_period = true});
  const Eigen::VectorXd shifted = stacked(orbit.start) + Eigen::Vector2d(0.1, 0.0);
  const PeriodicOrbit moved = find_orbit(system, with_coordinates(orbit.start, shifted));
  EXPECT_EQ(moved.iterations, 0);
  EXPECT_NEAR(moved.start.q[0] - orbit.start.q[0], 0.1, 1e-12);
}

// --- S0, one mass ---------------------------------------------------------------------------------------------------

struct PrintedOrbit {
  const char* label;
  double omega, start;
  std::vector<Complex> multipliers;
  double tolerance;
  int crossings;
  bool symmetric;
};

TEST(ClearanceOrbits, Table41OfS0) {
  // Half a unit of the last digit; D's real part is printed as −0.2249 and is −0.22482.
  const std::vector<PrintedOrbit> table = {
      {"C", 1.4, -2.0, {0.6086, 0.3085}, 5e-5, 4, true},
      {"D", 0.65, 0.0, {Complex(-0.2248, 0.2261), Complex(-0.2248, -0.2261)}, 8e-5, 4, false},
      {"E", 0.4, 0.0, {Complex(-0.0986, 0.0120), Complex(-0.0986, -0.0120)}, 8e-5, 8, true},
      {"F", 0.1, 0.0, {0.0001, 0.0}, 5e-5, 8, true}};
  for (const PrintedOrbit& row : table) {
    const PeriodicOrbit orbit = orbit_after_settling(Backlash{.omega = row.omega}.system(), row.start);
    SCOPED_TRACE(row.label);
    expect_multipliers(orbit, row.multipliers, row.tolerance);
    EXPECT_EQ(orbit.crossings, row.crossings);
    EXPECT_EQ(orbit.symmetric, row.symmetric);
    EXPECT_EQ(orbit.stability, Stability::kStable);
    EXPECT_LT(orbit.residual, 1e-11);
    EXPECT_LE(orbit.iterations, 10);
  }
  const PeriodicOrbit B = find_orbit(Backlash{.omega = 1.4}.system(), displaced(Backlash{}.system(), 0, 2.0));
  expect_multipliers(B, {1.4210, 0.1482}, 5e-5);
  EXPECT_EQ(B.stability, Stability::kUnstable);
  EXPECT_EQ(B.word, "g l g r");
}

TEST(ClearanceOrbits, AgreeWithAnIndependentIntegrator) {
  // Runge-Kutta with 4,000 steps per period closes on the orbit, and its differences give the fundamental matrix.
  for (const auto& [omega, start] : std::vector<std::pair<double, double>>{{1.4, -2.0}, {0.65, 0.0}, {0.4, 0.0}}) {
    const PeriodicOrbit orbit = orbit_after_settling(Backlash{.omega = omega}.system(), start);
    const BacklashReference reference{.omega = omega};
    const dynamics::ContactMode mode = orbit.start.modes[0];
    const auto end_of = [&](const State& at) -> Eigen::Vector2d {
      BacklashReference::Point from{.t = at.time, .x = stacked(at)};
      if (mode == dynamics::ContactMode::kLeftStop) from.mode = BacklashReference::kLeft;
      if (mode == dynamics::ContactMode::kRightStop) from.mode = BacklashReference::kRight;
      from.flying = from.mode == BacklashReference::kFree && std::abs(from.x[0]) > 1.0;
      return reference.run(from, orbit.period, 4000).x;
    };
    EXPECT_LT((end_of(orbit.start) - stacked(orbit.start)).norm(), 1e-9);
    EXPECT_LT((fixtures::slopes(orbit.start, end_of, 1e-5, 2) - orbit.monodromy).norm(),
              1e-7 * std::max(1.0, orbit.monodromy.norm()));
  }
}

TEST(ClearanceOrbits, MultipliersNeedSaltation) {
  // Orbit B from matrix exponentials of the stays: with saltation 1.42, without it 2.17.
  const PeriodicOrbit orbit = find_orbit(Backlash{.omega = 1.4}.system(), displaced(Backlash{}.system(), 0, 2.0));
  const BacklashReference reference{.omega = 1.4};
  ASSERT_EQ(orbit.start.modes[0], dynamics::ContactMode::kLeftStop);
  std::vector<BacklashReference::Switch> switches;
  BacklashReference::Point at{.t = orbit.start.time, .x = stacked(orbit.start), .mode = BacklashReference::kLeft};
  at = reference.run(at, orbit.period, 4000, &switches);
  ASSERT_EQ(switches.size(), 4u);
  Eigen::Matrix2d with = Eigen::Matrix2d::Identity(), without = with;
  double time = orbit.start.time;
  for (const BacklashReference::Switch& s : switches) {
    with = reference.saltation(s) * reference.free_map(s.time - time, s.before) * with;
    without = reference.free_map(s.time - time, s.before) * without;
    time = s.time;
  }
  const double rest = orbit.start.time + orbit.period - time;
  with = reference.free_map(rest, BacklashReference::kLeft) * with;
  without = reference.free_map(rest, BacklashReference::kLeft) * without;
  EXPECT_LT((with - orbit.monodromy).norm(), 1e-8);
  EXPECT_NEAR(sorted_eigenvalues(without)[0].real(), 2.17, 0.005);
}

TEST(ClearanceOrbits, WithTheOtherLossOfContactBAndCDoNotExist) {
  // Stops that pull until |x| = b dissipate more: the fold is at 1.3964 (continuation_test), below 1.4.
  const HybridSystem system = Backlash{.omega = 1.4, .loss = friction::ContactLoss::kGap}.system();
  for (const double x : {1.6, 1.9, 2.0, -2.0, 2.5, 3.0}) {
    for (const State& guess : {displaced(system, 0, x), settle_guess(system, displaced(system, 0, x), 20.0)}) {
      const ShootingResult result = shoot(system, guess, {.half_period = true});
      EXPECT_TRUE(!result.converged() || result.orbit.crossings == 0) << x << ' ' << result.orbit.word;
    }
  }
}

TEST(ClearanceOrbits, SettledGuessesNeedTenStepsAtMost) {
  // How near a closed orbit comes to closing is up to rounding, which its impacts stretch: at 0.3, where stops are met
  // slowly, to between 2e-12 and 1e-11 on one build or another, in one segment or eight. So Newton's method is asked
  // for ten times that there. From 1.35 on nothing settles by a time one could tell before: motions bounce without
  // order until they lose the stops.
  for (const double omega : {0.1, 0.2, 0.3, 0.4, 0.65, 0.72, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3}) {
    const double tolerance = omega == 0.3 ? 1e-10 : 1e-11;
    for (const double x : {0.0, 3.0}) {
      const HybridSystem system = Backlash{.omega = omega}.system();
      const PeriodicOrbit orbit =
          find_orbit(system, settle_guess(system, displaced(system, 0, x), 200.0), {.tolerance = tolerance});
      EXPECT_LE(orbit.iterations, 10) << omega << ' ' << x;
      EXPECT_LT(orbit.residual, tolerance) << omega << ' ' << x;
    }
  }
}

TEST(ClearanceOrbits, BetweenTheStopsAreAFamily) {
  // q = x − A sin(ωt − φ)/(ω √(ω² + c²)), any x, where stops are not met: multipliers 1 and e^{−cT}, and closing
  // conditions that say nothing of x. The orbit nearest a guess is found in one step.
  const double c = 0.05;
  for (const double omega : {1.4, 1.5, 1.6, 2.3}) {
    const HybridSystem system = Backlash{.omega = omega}.system();
    for (const double x : {-0.25, 0.0, 0.1}) {
      State guess = displaced(system, 0, x);
      guess.v[0] = -0.99 / omega;
      const PeriodicOrbit orbit = find_orbit(system, guess);
      EXPECT_EQ(orbit.word, "g");
      EXPECT_LE(orbit.iterations, 1);
      EXPECT_NEAR(orbit.start.q[0], x, 0.01);
      EXPECT_NEAR(orbit.start.v[0], -omega / (omega * omega + c * c), 1e-13);
      expect_multipliers(orbit, {1.0, std::exp(-c * orbit.period)}, 1e-13);
    }
  }
}

TEST(ClearanceOrbits, HalfPeriodsGiveTheSameSymmetricOrbit) {
  const HybridSystem system = Backlash{.omega = 0.8}.system();
  const PeriodicOrbit whole = orbit_after_settling(system, 0.0);
  const PeriodicOrbit half = orbit_after_settling(system, 0.0, {.half_period = true});
  EXPECT_LT((stacked(whole.start) - stacked(half.start)).norm(), 1e-10);
  EXPECT_LT((whole.monodromy - half.monodromy).norm(), 1e-10);
  ASSERT_EQ(whole.half_multipliers.size(), 2);
  for (Eigen::Index i = 0; i < 2; ++i) {
    EXPECT_LT(std::abs(whole.half_multipliers[i] - half.half_multipliers[i]), 1e-10);
    EXPECT_LT((whole.multipliers.array() - whole.half_multipliers[i] * whole.half_multipliers[i]).abs().minCoeff(),
              1e-10);
  }
}

TEST(ClearanceOrbits, InsideTheWindowOnlyHigherPeriodsAreStable) {
  // 0.42 < ω < 0.54: S0 finds no stable solution; there is none of period 1, but of period 3 and 5.
  for (const double omega : {0.43, 0.45, 0.475, 0.49, 0.51, 0.53}) {
    const HybridSystem system = Backlash{.omega = omega}.system();
    for (const double x : {0.0, 0.3, 1.0}) {
      const ShootingResult result = shoot(system, settle_guess(system, displaced(system, 0, x), 50.0));
      EXPECT_TRUE(!result.converged() || result.orbit.stability == Stability::kUnstable) << omega;
    }
  }
  // Which of the motions inside the window a start settles to hangs on rounding, so several are tried.
  for (const auto& [omega, order] : std::vector<std::pair<double, int>>{{0.475, 3}, {0.49, 5}}) {
    const HybridSystem system = Backlash{.omega = omega}.system();
    int stable = 0;
    for (const double x : {0.3, 0.0, 0.6, 1.0, 1.5, -0.4, -0.8, -1.2}) {
      const ShootingResult result =
          shoot(system, settle_guess(system, displaced(system, 0, x), 400.0), {.order = order});
      if (!result.converged() || result.orbit.stability != Stability::kStable) continue;
      EXPECT_EQ(result.orbit.repeats, 1) << omega << ' ' << x;
      EXPECT_EQ(result.orbit.order, order) << omega << ' ' << x;
      ++stable;
    }
    EXPECT_GT(stable, 0) << omega;
  }
}

TEST(ClearanceOrbits, AnOrbitPassedTwiceIsSeen) {
  const HybridSystem system = Backlash{.omega = 0.8}.system();
  EXPECT_EQ(orbit_after_settling(system, 0.0, {.order = 2}).repeats, 2);
}

TEST(ClearanceOrbits, SingleAndMultipleShootingAgree) {
  const HybridSystem system = Backlash{.omega = 0.65}.system();
  const PeriodicOrbit single = orbit_after_settling(system, 0.0),
                      multiple = orbit_after_settling(system, 0.0, {.segments = 5});
  EXPECT_LT((stacked(single.start) - stacked(multiple.start)).norm(), 1e-9);
  EXPECT_LT((single.monodromy - multiple.monodromy).norm(), 1e-8);
  EXPECT_EQ(single.word, multiple.word);
}

TEST(ClearanceOrbits, AStartOnAStopIsMovedOffIt) {
  const HybridSystem system = Backlash{.omega = 0.8}.system();
  const PeriodicOrbit orbit = orbit_after_settling(system, 0.0);
  const dynamics::Event& contact = orbit.events.front();
  // A hair before it: at the stop itself rounding decides whether the contact belongs to this period or to the next.
  State on_guard = advanced(system, orbit.start, contact.time - orbit.start.time - 1e-9);
  on_guard.modes.clear();
  const PeriodicOrbit again = find_orbit(system, on_guard);
  EXPECT_EQ(again.word, orbit.word);
  EXPECT_LT(std::abs(again.multipliers[0] - orbit.multipliers[0]), 1e-8);
  EXPECT_GT(std::abs(again.start.time - contact.time), 1e-3);
}

// --- S0, four masses ------------------------------------------------------------------------------------------------

TEST(ClearanceOrbits, FourMassesNearTheMainPeak) {
  // ω = 0.93: symmetric orbit unstable, asymmetric one stable with a multiplier of modulus about 0.989 (S0
  // Figures 4.15, 4.16; the modulus from an independent computation).
  const HybridSystem system = four_masses(0.93);
  State start = system.rest();
  start.q << 0.0, 0.0, 2.0, 2.0;
  const State guess = settle_guess(system, start, 400.0);
  const PeriodicOrbit asymmetric = find_orbit(system, guess);
  EXPECT_FALSE(asymmetric.symmetric);
  EXPECT_EQ(asymmetric.stability, Stability::kStable);
  EXPECT_NEAR(asymmetric.leading_modulus, 0.989, 5e-4);
  EXPECT_LE(asymmetric.iterations, 10);
}

// --- S2 -------------------------------------------------------------------------------------------------------------

struct PlayOrbit {
  const char* figure;
  double xi, a, omega;
  std::array<double, 6> cosine, sine;
};

TEST(ClearanceOrbits, TableTwoOfS2) {
  // Printed coefficients of cos((2k − 1)ωt), sin((2k − 1)ωt) are of a truncated harmonic balance: up to 8e-3 off.
  const std::vector<PlayOrbit> table = {
      {"7a", 0.02, 1.08330, 1.0, {-1.1456, -0.0057, -0.0013, -0.0002}, {0.0486, 0.0008, 0.0003, 0.0001}},
      {"7b", 0.02, 1.19940, 1.0, {-1.7795, -0.0280, 0.0005, 0.0007}, {0.1062, 0.0055, -0.0002, -0.0003}},
      {"8a", 0.05063, 0.1, 0.3, {1.0900, 0.0686, -0.0219}, {0.5780, 0.1811, 0.0351}},
      {"8b", 0.13058, 0.1, 0.3, {0.1049, -0.0795, 0.0235, -0.0065}, {1.1516, -0.0781, 0.0140, -0.0014}},
      {"9a",
       0.2,
       0.3,
       0.11246,
       {1.2191, 0.2520, -0.1086, -0.1208, -0.0854, -0.0324},
       {0.8708, -0.2744, -0.1503, -0.0074, 0.0052, 0.0125}},
      {"9b", 0.2, 0.3, 0.16260, {1.0653, 0.3389, 0.1647, 0.0879}, {1.0019, -0.0759, -0.1151, 0.0074}},
      {"9c", 0.2, 0.3, 0.40022, {0.6888, -0.1486, 0.0028}, {1.3429, 0.0599, -0.0188}},
      {"9d", 0.2, 0.3, 0.50050, {-0.3535, 0.0306, -0.0072, -0.0010}, {1.3663, -0.0705, 0.0054, -0.0001}}};
  for (const PlayOrbit& row : table) {
    SCOPED_TRACE(row.figure);
    const HybridSystem system = play(row.xi, row.a, row.omega);
    State guess = system.rest();
    for (int k = 0; k < 6; ++k) {
      guess.q[0] += row.cosine[static_cast<std::size_t>(k)];
      guess.v[0] += (2 * k + 1) * row.omega * row.sine[static_cast<std::size_t>(k)];
    }
    const PeriodicOrbit orbit = find_orbit(system, guess);
    EXPECT_TRUE(orbit.symmetric);
    EXPECT_EQ(orbit.crossings, 4);
    EXPECT_EQ(orbit.stability, Stability::kStable);
    constexpr int kPoints = 128;
    const std::vector<State> points = sample_orbit(system, orbit, kPoints);
    for (int k = 0; k < 6; ++k) {
      double c = 0.0, s = 0.0;
      for (int j = 0; j < kPoints; ++j) {
        const double angle = (2 * k + 1) * 2.0 * std::numbers::pi * j / kPoints;
        c += 2.0 / kPoints * points[static_cast<std::size_t>(j)].q[0] * std::cos(angle);
        s += 2.0 / kPoints * points[static_cast<std::size_t>(j)].q[0] * std::sin(angle);
      }
      const double printed_c = row.cosine[static_cast<std::size_t>(k)],
                   printed_s = row.sine[static_cast<std::size_t>(k)];
      if (printed_c == 0.0 && printed_s == 0.0) continue;  // left out of the print; up to 0.019 in 9b
      EXPECT_NEAR(c, printed_c, 8e-3) << k;
      EXPECT_NEAR(s, printed_s, 8e-3) << k;
    }
  }
}

TEST(ClearanceOrbits, TableOneOfS2IsTheLinearMotionInTheGap) {
  // x = c₁ cos ωt + b₁ sin ωt with c₁ = −a/(ω² + 4ξ²), b₁ = −2ξ c₁/ω; rows 1 and 2 as printed.
  for (const auto& [xi, a, omega, c1, b1] :
       {std::array{0.02, 0.5, 1.0, -0.499201, 0.019968}, std::array{0.19884, 0.1, 0.3, -0.402983, 0.534194}}) {
    const HybridSystem system = play(xi, a, omega);
    const PeriodicOrbit orbit = find_orbit(system, system.rest(), {.half_period = true});
    EXPECT_NEAR(orbit.start.q[0], c1, 1e-6);
    EXPECT_NEAR(orbit.start.v[0], b1 * omega, 1e-6);
  }
}

TEST(ClearanceOrbits, ASearchInVainAdvises) {
  const HybridSystem system = Backlash{.omega = 0.45}.system();
  const ShootingResult result = shoot(system, displaced(system, 0, 40.0), {.max_iterations = 1});
  ASSERT_FALSE(result.converged());
  EXPECT_THAT(result.message, testing::AllOf(testing::HasSubstr("residual"), testing::HasSubstr("max_iterations")));
}

}  // namespace
}  // namespace slipmode::orbits
