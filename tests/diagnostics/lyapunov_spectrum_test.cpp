#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/orbits/shooting.hpp>
#include <slipmode/rom/reduce.hpp>
#include "diagnostics/exponents/internal/tangent_frame.hpp"
#include "fixtures/clearance_scenes.hpp"
#include "fixtures/shaken_scenes.hpp"
#include "models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

namespace slipmode::diagnostics {
namespace {

/// Of standard errors told from eight stretches, themselves uncertain by a quarter: with seven degrees of freedom one
/// motion in 2,000 misses by six, as one in 16,000 misses four of an error that is known.
constexpr double kMargin = 6.0;
constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();

/// Moves x and a frame by one step of the classical Runge-Kutta method.
template <class Field, class Jacobian>
Eigen::MatrixXd runge_kutta(const Field& f, const Jacobian& J, Eigen::VectorXd& x, const Eigen::MatrixXd& frame,
                            double h) {
  const Eigen::VectorXd k1 = f(x), x2 = x + 0.5 * h * k1, k2 = f(x2), x3 = x + 0.5 * h * k2, k3 = f(x3);
  const Eigen::VectorXd x4 = x + h * k3, k4 = f(x4);
  const Eigen::MatrixXd m1 = J(x) * frame, m2 = J(x2) * (frame + 0.5 * h * m1), m3 = J(x3) * (frame + 0.5 * h * m2);
  const Eigen::MatrixXd m4 = J(x4) * (frame + h * m3);
  x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  return frame + h / 6.0 * (m1 + 2.0 * m2 + 2.0 * m3 + m4);
}

/// Real parts of eigenvalues, descending.
Eigen::VectorXd decay_rates(const Eigen::MatrixXd& A) {
  Eigen::VectorXd rates = A.eigenvalues().real();
  std::sort(rates.begin(), rates.end(), std::greater<>{});
  return rates;
}

/// The state matrix of M q̈ + C q̇ + K q = 0.
Eigen::MatrixXd state_matrix(const Eigen::MatrixXd& M, const Eigen::MatrixXd& C, const Eigen::MatrixXd& K) {
  const Eigen::Index n = M.rows();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -M.inverse() * K;
  A.bottomRightCorner(n, n) = -M.inverse() * C;
  return A;
}

/// Pairs turn about one another; their sums do not. Compares Σ_{i≤j} for every j.
void expect_sums(const LyapunovSpectrum& found, const Eigen::VectorXd& expected, double tolerance) {
  double sum = 0.0, target = 0.0;
  for (Eigen::Index j = 0; j < expected.size(); ++j) {
    sum += found.nats[j];
    target += expected[j];
    EXPECT_NEAR(sum, target, tolerance) << "first " << j + 1;
  }
}

TEST(Orthonormalise, LeavesOutWhatIsRounding) {
  Eigen::MatrixXd images(3, 3);
  images << 2.0, 4.0, 0.0, 0.0, 1e-13, 0.0, 0.0, 0.0, 3.0;
  const Orthonormalised kept = orthonormalise(images);
  EXPECT_EQ(kept.columns, (std::vector<Eigen::Index>{0, 2}));
  EXPECT_DOUBLE_EQ(kept.log_growth[0], std::log(2.0));
  EXPECT_DOUBLE_EQ(kept.log_growth[1], std::log(3.0));
  EXPECT_TRUE((kept.directions.transpose() * kept.directions).isIdentity(1e-15));
}

TEST(SpectrumOfAMap, HenonContractsAreasByItsParameter) {
  // det J = −b everywhere, so the sum is ln 0.3. λ₁ = 0.41922 (Sprott 2003), dimension 1 + λ₁/|λ₂| = 1.2583.
  Eigen::Vector2d x(0.1, 0.1);
  const auto henon = [&x](const Eigen::MatrixXd& frame) -> Eigen::MatrixXd {
    Eigen::Matrix2d J;
    J << -2.8 * x[0], 1.0, 0.3, 0.0;
    x = Eigen::Vector2d(1.0 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0]);
    return J * frame;
  };
  const LyapunovSpectrum found = lyapunov_spectrum(henon, {.size = 2, .steps = 200'000});
  EXPECT_NEAR(found.nats.sum(), std::log(0.3), 1e-12);
  EXPECT_NEAR(found.nats[0], 0.41922, kMargin * found.error[0]);
  EXPECT_LT(found.error[0], 2e-3);
  EXPECT_NEAR(found.dimension, 1.2583, kMargin * found.dimension_error);
  EXPECT_LT(found.dimension_error, 2e-3);
  EXPECT_TRUE(found.is_chaotic());
  EXPECT_NEAR(found.running()(0, 199'999), found.nats[0], 1e-12);
  EXPECT_NEAR(found.halves.row(0).mean(), found.nats[0], 1e-12);
}

TEST(SpectrumOfAMap, LosesTheDirectionAProjectionLoses) {
  // A turn by one radian in a plane, stretched by 2; what is across is projected out.
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  A.topLeftCorner(2, 2) << 2.0 * std::cos(1.0), -2.0 * std::sin(1.0), 2.0 * std::sin(1.0), 2.0 * std::cos(1.0);
  const LyapunovSpectrum found =
      lyapunov_spectrum([&A](const Eigen::MatrixXd& frame) -> Eigen::MatrixXd { return A * frame; },
                        {.size = 3, .time_step = 0.5, .steps = 100});
  EXPECT_NEAR(found.nats[0], std::log(2.0) / 0.5, 1e-12);
  EXPECT_NEAR(found.nats[1], std::log(2.0) / 0.5, 1e-12);
  EXPECT_EQ(found.nats[2], kMinusInfinity);
  EXPECT_EQ(found.lost, 1);
  EXPECT_EQ(found.dimension, 2.0);
}

TEST(SpectrumOfAFlow, LorenzHasThePublishedExponents) {
  // Sprott 2003: 0.9056, 0, −14.5723, dimension 2.0622. The sum is the trace −(σ + 1 + β) = −13.6667 everywhere.
  const auto field = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return Eigen::Vector3d(10.0 * (x[1] - x[0]), x[0] * (28.0 - x[2]) - x[1], x[0] * x[1] - 8.0 / 3.0 * x[2]);
  };
  const auto jacobian = [](const Eigen::VectorXd& x) -> Eigen::MatrixXd {
    Eigen::Matrix3d J;
    J << -10.0, 10.0, 0.0, 28.0 - x[2], -1.0, -x[0], x[1], x[0], -8.0 / 3.0;
    return J;
  };
  Eigen::VectorXd x = Eigen::Vector3d(1.0, 1.0, 20.0);
  constexpr double kStep = 0.005;
  const LyapunovSpectrum found =
      lyapunov_spectrum([&](const Eigen::MatrixXd& frame) { return runge_kutta(field, jacobian, x, frame, kStep); },
                        {.size = 3, .time_step = kStep, .alignment = 4000, .steps = 100'000});
  EXPECT_NEAR(found.nats.sum(), -41.0 / 3.0, 1e-4);  // the method contracts volumes to O(h⁴)
  EXPECT_NEAR(found.nats[0], 0.9056, kMargin * found.error[0]);
  EXPECT_NEAR(found.nats[1], 0.0, kMargin * found.error[1] + 5.0 / found.duration);
  EXPECT_LT(found.error[0], 0.02);
  EXPECT_NEAR(found.dimension, 2.0622, kMargin * found.dimension_error);
  EXPECT_LT(found.dimension_error, 2e-3);
}

TEST(SpectrumOfAFlow, RoesslerHasThePublishedExponents) {
  // a = b = 0.2, c = 5.7: 0.0714, 0, −5.3943, dimension 2.0132 (Sprott 2003).
  const auto field = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return Eigen::Vector3d(-x[1] - x[2], x[0] + 0.2 * x[1], 0.2 + x[2] * (x[0] - 5.7));
  };
  const auto jacobian = [](const Eigen::VectorXd& x) -> Eigen::MatrixXd {
    Eigen::Matrix3d J;
    J << 0.0, -1.0, -1.0, 1.0, 0.2, 0.0, x[2], 0.0, x[0] - 5.7;
    return J;
  };
  Eigen::VectorXd x = Eigen::Vector3d(1.0, 1.0, 0.0);
  constexpr double kStep = 0.02;
  const LyapunovSpectrum found =
      lyapunov_spectrum([&](const Eigen::MatrixXd& frame) { return runge_kutta(field, jacobian, x, frame, kStep); },
                        {.size = 3, .time_step = kStep, .alignment = 10'000, .steps = 150'000});
  EXPECT_NEAR(found.nats[0], 0.0714, kMargin * found.error[0]);
  EXPECT_LT(found.error[0], 5e-3);
  EXPECT_NEAR(found.nats[2], -5.3943, kMargin * found.error[2]);
  EXPECT_NEAR(found.dimension, 2.0132, kMargin * found.dimension_error);
}

TEST(SpectrumOfASystem, LinearStructureHasTheRealPartsOfItsEigenvalues) {
  const fem::Structure structure = fem::chain({.masses = 3, .damping = 0.3, .mass_damping = 0.05});
  const dynamics::HybridSystem chain(structure, {}, friction::Belt::constant(0.0));
  const Eigen::VectorXd expected = decay_rates(
      state_matrix(fem::to_dense(structure.M()), fem::to_dense(structure.C()), fem::to_dense(structure.K())));
  const LyapunovSpectrum found =
      lyapunov_spectrum(chain, chain.rest(), {.transient = 0.0, .duration = 4000.0, .interval = 5.0});
  expect_sums(found, expected, 3.0 / 4000.0);  // turning in ellipses leaves a factor bounded for all time
  ASSERT_TRUE(found.balance);
  EXPECT_NEAR(found.balance->expected(), expected.sum(), 1e-12);
  EXPECT_NEAR(found.balance->sum, expected.sum(), 1e-10);
  EXPECT_EQ(found.lost, 0);
}

TEST(SpectrumOfASystem, IsUndecidedWhereItsErrorIsNotKnown) {
  const auto with = [](double largest, double error) {
    return LyapunovSpectrum{
        .nats = Eigen::VectorXd::Constant(1, largest), .error = Eigen::VectorXd::Constant(1, error), .duration = 100.0};
  };
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(with(0.3, unknown).is_undecided() && !with(0.3, unknown).is_chaotic());
  EXPECT_TRUE(with(0.3, 0.1).is_undecided());
  EXPECT_FALSE(with(0.3, 0.01).is_undecided() || with(0.3, 0.4).is_undecided());
  EXPECT_FALSE(with(-0.3, unknown).is_undecided() || with(0.003, unknown).is_undecided());  // e^0.3 over the record
}

TEST(SpectrumOfASystem, ErrorsOfARegularMotionReachTheTruth) {
  // Pairs turn in ellipses, slowly seen every 6.3: equal stretches of the record then all err by nearly the same.
  const fem::Structure structure = fem::chain({.masses = 2, .damping = 0.3, .mass_damping = 0.05});
  const dynamics::HybridSystem chain(structure, {}, friction::Belt::constant(0.0));
  const Eigen::VectorXd expected = decay_rates(
      state_matrix(fem::to_dense(structure.M()), fem::to_dense(structure.C()), fem::to_dense(structure.K())));
  for (const double interval : {0.7, 5.0, 6.3}) {
    for (double duration = 100.0; duration < 700.0; duration += 41.0) {
      const LyapunovSpectrum found = lyapunov_spectrum(
          chain, chain.rest(), {.transient = 0.0, .duration = duration, .alignment = 0.1, .interval = interval});
      for (Eigen::Index i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(found.nats[i], expected[i], 2.0 * found.error[i]) << i << " of " << duration << " by " << interval;
      EXPECT_FALSE(found.is_chaotic() || found.is_undecided());
    }
  }
}

TEST(SpectrumOfASystem, SteadySlidingHasTheRealPartsOfTheLinearisedFlow) {
  // Slow enough for the Stribeck slope to matter, damped enough for sliding to be stable: C gains −αΔμ N e^{−αV} w wᵀ.
  const double alpha = 2.0, V = 0.8, N = 0.5;
  const dynamics::HybridSystem chain =
      fixtures::belt_chain(friction::Stribeck{0.4, 0.2, alpha}, friction::Belt::constant(V), 3, 0.5, N);
  Eigen::MatrixXd C = fem::to_dense(chain.structure().C());
  C(2, 2) -= alpha * 0.2 * N * std::exp(-alpha * V);
  const Eigen::VectorXd expected =
      decay_rates(state_matrix(fem::to_dense(chain.structure().M()), C, fem::to_dense(chain.structure().K())));
  ASSERT_LT(expected[0], -1e-3);
  const LyapunovSpectrum found =
      lyapunov_spectrum(chain, sliding_equilibrium(chain), {.transient = 0.0, .duration = 2000.0, .interval = 5.0});
  expect_sums(found, expected, 3.0 / 2000.0);
  EXPECT_NEAR(found.balance->friction, alpha * 0.2 * N * std::exp(-alpha * V), 1e-9);
  EXPECT_NEAR(found.balance->sum, expected.sum(), 1e-7);
}

TEST(SpectrumOfASystem, SteadySlidingOnABristleHasTheRealPartsOfTheLinearisedFlow) {
  // State (q, q̇, z) at s = V, z = g/σ₀, κ = σ₀V/g: with r = 1 − κ′z = V g′/g, δλ = (σ₀ − σ₁κ) δz + (σ₁ r + σ₂) δs,
  // δż = r δs − κ δz.
  const friction::LuGre law{0.4, 0.25, 0.5, 8.0, 0.7, 0.3};
  const double V = 0.4, N = 0.5, share = V / law.stribeck_speed, e = 0.15 * N * std::exp(-share * share);
  const double g = 0.25 * N + e, r = -2.0 * share * share * e / g, decay = law.stiffness * V / g;
  const dynamics::HybridSystem chain = fixtures::belt_chain(law, friction::Belt::constant(V), 3, 0.5, N);
  Eigen::MatrixXd C = fem::to_dense(chain.structure().C());
  C(2, 2) += law.damping * r + law.viscous;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(7, 7);
  A.topLeftCorner(6, 6) = state_matrix(fem::to_dense(chain.structure().M()), C, fem::to_dense(chain.structure().K()));
  A(5, 6) = law.stiffness - law.damping * decay;  // masses of 1
  A(6, 5) = -r;
  A(6, 6) = -decay;
  const Eigen::VectorXd expected = decay_rates(A);
  ASSERT_LT(expected[0], -1e-3);
  dynamics::State start = sliding_equilibrium(chain);
  start.q = fem::to_dense(chain.structure().K()).ldlt().solve((g + law.viscous * V) * fixtures::unit(3, 2));
  start.internal = Eigen::VectorXd::Constant(1, g / law.stiffness);
  const LyapunovSpectrum found =
      lyapunov_spectrum(chain, start, {.transient = 0.0, .duration = 2000.0, .interval = 5.0});
  EXPECT_EQ(found.size, 7);
  EXPECT_EQ(found.lost, 0);
  expect_sums(found, expected, 3.0 / 2000.0);
  EXPECT_FALSE(found.balance);
}

TEST(SpectrumOfASystem, LargestOnABristleIsThatOfTwoTrajectories) {
  const dynamics::HybridSystem system = fixtures::oscillator(
      1.0, 1.0, 0.02, friction::LuGre{0.6, 0.2, 0.1, 60.0, 1.0, 0.0}, 1.0, friction::Shaker{0.6, 0.1});
  const LyapunovSpectrum found =
      lyapunov_spectrum(system, system.rest(), {.transient = 500.0, .duration = 1000.0, .interval = 10.0});
  // A separation of 1e-5 at the flow's 1e-12: of an interval's growth 1e-7 is the flow's own error. What the first
  // direction loses until it lies along the slowest counts in both records.
  const auto growth = [&](double duration) {
    const LyapunovOptions options{
        .transient = 500.0, .duration = duration, .interval = 10.0, .separation = 1e-5, .flow = {.tolerance = 1e-12}};
    return largest_exponent(system, system.rest(), options).nats * duration;
  };
  const double two = (growth(1200.0) - growth(200.0)) / 1000.0;
  EXPECT_LT(two, -5e-3);
  EXPECT_NEAR(found.nats[0], two, 1e-3 * std::abs(two));
}

TEST(SpectrumOfASystem, StickSlipOscillatorHasZeroAndMinusInfinity) {
  // The limit cycle of one mass: along it nothing grows, across it everything is lost at the first stick.
  const fixtures::BeltOscillator o;
  const dynamics::HybridSystem system = tests::system_of(o);
  const LyapunovSpectrum found =
      lyapunov_spectrum(system, tests::released(o), {.transient = 100.0, .duration = 2000.0, .interval = 7.0});
  EXPECT_NEAR(found.nats[0], 0.0, 3.0 / 2000.0);
  EXPECT_EQ(found.nats[1], kMinusInfinity);
  EXPECT_EQ(found.lost, 1);
  EXPECT_EQ(found.dimension, 1.0);
  EXPECT_TRUE(found.self_excited);
  EXPECT_FALSE(found.is_chaotic());
  EXPECT_NEAR(found.balance->sum, found.balance->expected(), 1e-5);
}

TEST(SpectrumOfASystem, PeriodicOrbitThroughStickHasItsFloquetExponents) {
  const dynamics::HybridSystem system = tests::chain10(0.39);
  const orbits::PeriodicOrbit orbit =
      orbits::find_orbit(system, orbits::advanced(system, tests::near_period_three(), 3000.0), {.period = 45.1868});
  Eigen::VectorXd expected(orbit.multipliers.size());
  for (Eigen::Index i = 0; i < expected.size(); ++i)
    expected[i] = std::log(std::abs(orbit.multipliers[i])) / orbit.period;
  const LyapunovSpectrum found = lyapunov_spectrum(
      system, orbit.start,
      {.transient = 0.0, .duration = 100.0 * orbit.period, .alignment = 1.0, .interval = orbit.period});
  ASSERT_EQ(orbit.zero_multipliers, 1);
  EXPECT_EQ(found.lost, 1);
  // Directions whose multipliers are close in size have not found their order yet; pairs turn.
  expect_sums(found, expected.head(19), 3.0 / found.duration);
  EXPECT_NEAR(found.nats[0], 0.0, 1e-6);
  EXPECT_NEAR(found.balance->sum, found.balance->expected(), 1e-5);
  EXPECT_EQ(found.balance->unexplained, 0);
}

TEST(SpectrumOfASystem, DrivenOrbitBetweenStopsHasItsFloquetExponents) {
  // Phase is a parameter: no exponent is zero by itself.
  const dynamics::HybridSystem system = fixtures::backlash_train(1.2);
  const orbits::PeriodicOrbit orbit =
      orbits::find_orbit(system, orbits::settle_guess(system, system.rest(), 300.0), {.order = 1});
  Eigen::VectorXd expected(orbit.multipliers.size());
  for (Eigen::Index i = 0; i < expected.size(); ++i)
    expected[i] = std::log(std::abs(orbit.multipliers[i])) / orbit.period;
  const LyapunovSpectrum found = lyapunov_spectrum(
      system, orbit.start,
      {.transient = 0.0, .duration = 400.0 * orbit.period, .alignment = 1.0, .interval = orbit.period});
  expect_sums(found, expected, 3.0 / found.duration);
  EXPECT_FALSE(found.self_excited);
  EXPECT_EQ(found.lost, 0);
  // Stops' dashpots count while they press; reaching a stop, the velocity's jump of force has determinant 1.
  EXPECT_NEAR(found.balance->sum, expected.sum(), 1e-6);
  EXPECT_NEAR(found.balance->expected(), expected.sum(), 1e-4);
}

TEST(SpectrumOfASystem, UndampedStopsLeaveTheDivergenceOfTheStructure) {
  // S1's pair: −tr M⁻¹C = −tr Z = −0.21 whatever the stops do.
  const dynamics::HybridSystem system = fixtures::clearance_pair(0.4);
  const LyapunovSpectrum found =
      lyapunov_spectrum(system, system.rest(), {.transient = 500.0, .duration = 4000.0, .interval = 5.0});
  EXPECT_NEAR(found.nats.sum(), -0.21, 1e-5);
  EXPECT_NEAR(found.balance->expected(), -0.21, 1e-12);
}

TEST(SpectrumOfASystem, SumOfTheChaoticChainIsItsMeanDivergence) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const LyapunovSpectrum found =
      lyapunov_spectrum(system, sliding_equilibrium(system), {.transient = 8000.0, .duration = 6000.0});
  EXPECT_EQ(found.lost, 1);
  EXPECT_EQ(found.nats[19], kMinusInfinity);
  ASSERT_TRUE(found.balance);
  EXPECT_EQ(found.balance->unexplained, 0);
  EXPECT_NEAR(found.balance->sum, found.balance->expected(), 1e-4);
  EXPECT_NEAR(found.balance->sum, found.nats.head(19).sum(), 1e-12);
  // One exponent is zero: the nearest is so within its error and what is left of a bounded factor.
  Eigen::Index nearest = 0;
  const double least = found.nats.head(19).cwiseAbs().minCoeff(&nearest);
  EXPECT_LT(least, kMargin * found.error[nearest] + 5.0 / found.duration);
  EXPECT_TRUE(found.is_chaotic());
  // docs/theory/validation-measures.md: 0.01335 ± 0.00003 nat over 8 million units; 6,000 units scatter by 0.0012.
  EXPECT_NEAR(found.nats[0], 0.01335, 4.0 * 0.0012);
  const LyapunovSpectrum leading =
      lyapunov_spectrum(system, sliding_equilibrium(system), {.transient = 8000.0, .duration = 6000.0, .exponents = 2});
  EXPECT_EQ(leading.nats.size(), 2);
  EXPECT_FALSE(leading.balance);
  EXPECT_TRUE(std::isnan(leading.dimension));  // two positive exponents do not tell where the sum turns negative
  const double scatter = std::hypot(found.error[0], leading.error[0]);
  EXPECT_NEAR(leading.nats[0], found.nats[0], 4.0 * std::max(scatter, 0.0012));
}

TEST(SpectrumOfASystem, UncoupledStickingMassesLoseADirectionEach) {
  // Two oscillators that share nothing: {0, −∞} twice, although they hardly ever stick at the same time.
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::MatrixXd K = Eigen::Vector2d(1.0, 1.7).asDiagonal();
  const dynamics::HybridSystem pair(fem::Structure(Eigen::MatrixXd(one), Eigen::MatrixXd(0.0 * one), K),
                                    {{fixtures::unit(2, 0), friction::Coulomb{0.5, 0.2}, 1.0},
                                     {fixtures::unit(2, 1), friction::Coulomb{0.6, 0.3}, 1.0}},
                                    friction::Belt::constant(0.4));
  const LyapunovSpectrum found =
      lyapunov_spectrum(pair, fixtures::state(Eigen::Vector2d(-2.0, 1.5), Eigen::Vector2d::Zero()),
                        {.transient = 200.0, .duration = 1000.0, .interval = 5.0});
  EXPECT_EQ(found.lost, 2);
  EXPECT_NEAR(found.nats[0], 0.0, 5e-3);
  EXPECT_NEAR(found.nats[1], 0.0, 5e-3);
  EXPECT_EQ(found.nats[2], kMinusInfinity);
  EXPECT_EQ(found.nats[3], kMinusInfinity);
}

TEST(SpectrumOfASystem, SumIsTheBalanceOfVolumesInRandomScenes) {
  // One to six masses, one to three contacts that stick together and apart, reverse, creep; belts of constant speed.
  // Left out: smooth laws, whose steepest contraction steps sized by the motion do not follow.
  int stuck = 0, together = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const fixtures::RandomScene scene = fixtures::random_scene(seed, fixtures::Laws::kRigid, 6);
    const dynamics::HybridSystem system = scene.system.with_drive(friction::Belt::constant(0.3));
    const LyapunovSpectrum found =
        lyapunov_spectrum(system, scene.start, {.transient = 100.0, .duration = 200.0, .interval = 5.0});
    ASSERT_TRUE(found.balance);
    EXPECT_EQ(found.balance->unexplained, 0) << "seed " << seed;
    EXPECT_NEAR(found.balance->sum, found.balance->expected(), 1e-3) << "seed " << seed;
    stuck += found.lost > 0 ? 1 : 0;
    together += found.lost > 1 ? 1 : 0;
  }
  EXPECT_GE(stuck, 4);
  EXPECT_GE(together, 1);
}

TEST(SpectrumOfASystem, ContactSpringLosesItsStretchWhileItSlides) {
  const dynamics::HybridSystem system = fixtures::single_mass(
      1.0, 0.1, 1.0, {.direction = {}, .law = friction::CompliantCoulomb{0.5, 0.5, 10.0}, .normal_load = 1.0},
      friction::Shaker{.amplitude = 2.0, .frequency_hz = 0.2});
  const LyapunovSpectrum found =
      lyapunov_spectrum(system, system.rest(), {.transient = 100.0, .duration = 1000.0, .interval = 5.0});
  EXPECT_EQ(found.size, 3);
  EXPECT_EQ(found.lost, 1);
  EXPECT_EQ(found.nats[2], kMinusInfinity);
  EXPECT_LT(found.nats[0], 0.0);
  EXPECT_FALSE(found.balance);
}

TEST(SpectrumOfASystem, AllModesGiveTheSpectrumOfTheFullModel) {
  // The energy metric sees the same lengths, so even the finite-time rates agree while the motions do.
  const dynamics::HybridSystem full = tests::chain10(0.45);
  const dynamics::HybridSystem reduced = rom::reduce(full, rom::lnm_basis(full.structure(), 10));
  const TangentOptions options{.transient = 0.0, .duration = 400.0, .alignment = 0.0};
  const LyapunovSpectrum a = lyapunov_spectrum(full, full.rest(), options);
  const LyapunovSpectrum b = lyapunov_spectrum(reduced, reduced.rest(), options);
  EXPECT_EQ(a.lost, b.lost);
  EXPECT_NEAR(a.nats.head(19).sum(), b.nats.head(19).sum(), 2e-2);
  EXPECT_NEAR(a.balance->expected(), b.balance->expected(), 2e-2);
}

TEST(SpectrumOfASystem, RefusesWhatItCannotMeasure) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const dynamics::State rest = system.rest();
  EXPECT_THROW((void)lyapunov_spectrum(system, rest, {.transient = -1.0}), InvalidInput);
  EXPECT_THROW((void)lyapunov_spectrum(system, rest, {.duration = 1.0, .interval = 2.0}), InvalidInput);
  EXPECT_THROW((void)lyapunov_spectrum(system, rest, {.exponents = 21}), InvalidInput);
  const dynamics::HybridSystem ramp = system.with_drive(friction::Belt::ramp(0.1, 0.2, 50.0, 60.0));
  EXPECT_THROW((void)lyapunov_spectrum(ramp, rest, {.transient = 20.0}), InvalidInput);
  const StopFlag stop = true;
  EXPECT_THROW((void)lyapunov_spectrum(system, rest, {.transient = 0.0, .stop = &stop}), Interrupted);
  EXPECT_THROW((void)lyapunov_spectrum(TangentMap{}, {.size = 0}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
