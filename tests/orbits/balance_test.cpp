// Harmonic balance: its equations, its solutions against exact orbits, and what certifies them.
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/mixed/certificate.hpp>
#include "balance_checks.hpp"
#include "clearance_systems.hpp"
#include "orbits/balance/internal/balanced_law.hpp"
#include "play_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>
#include <random>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;

TrigonometricPolynomial random_polynomial(std::mt19937& random, Eigen::Index H, double decay) {
  std::normal_distribution<double> normal;
  TrigonometricPolynomial out{Eigen::VectorXcd(H + 1)};
  for (Eigen::Index k = 0; k <= H; ++k)
    out.phasors[k] = std::complex<double>(normal(random), k == 0 ? 0.0 : normal(random)) /
                     std::pow(1.0 + static_cast<double>(k), decay);
  return out;
}

/// One mass with a damped stop on one side that lets go at its gap: force jumps on the way in and on the way out.
HybridSystem one_sided(double omega, friction::ContactLoss loss = friction::ContactLoss::kGap) {
  return {fem::masses({.links = {{.stiffness = 1.0, .damping = 0.1}}}),
          {{Eigen::VectorXd::Ones(1),
            friction::Clearance{{}, friction::Stop{.stiffness = 30.0, .damping = 2.0, .gap = 0.3}, loss}}},
          Backlash::drive(1.0, omega),
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}

double largest_difference(const Balance& a, const PlayRow& row) {
  double most = 0.0;
  for (std::size_t i = 0; i < row.cosine.size() && 2 * i + 1 <= static_cast<std::size_t>(a.harmonics); ++i) {
    const auto k = static_cast<Eigen::Index>(2 * i + 1);
    most = std::max({most, std::abs(a.displacement[0].cosine[k] - row.cosine[i]),
                     std::abs(a.displacement[0].sine[k] - row.sine[i])});
  }
  return most;
}

TEST(Zeros, AllAreFound) {
  // Every change of sign between 4,000 points is one; there may be pairs between points besides.
  std::mt19937 random(1);
  for (int trial = 0; trial < 120; ++trial) {
    const TrigonometricPolynomial y = random_polynomial(random, 1 + trial % 60, 0.5 * (trial % 5));
    const std::vector<double> found = zeros(y);
    constexpr int kPoints = 4000;
    std::size_t changes = 0;
    for (int k = 0; k < kPoints; ++k) {
      const double here = y.at(2.0 * std::numbers::pi * k / kPoints).y;
      changes += (here < 0.0) != (y.at(2.0 * std::numbers::pi * ((k + 1) % kPoints) / kPoints).y < 0.0);
    }
    EXPECT_GE(found.size(), changes);
    EXPECT_EQ(found.size() % 2, 0U);
    EXPECT_LE(found.size(), 2 * static_cast<std::size_t>(y.phasors.size() - 1));
    for (const double theta : found) EXPECT_LT(std::abs(y.at(theta).y), 1e-12 * y.phasors.cwiseAbs().sum());
    EXPECT_TRUE(std::ranges::is_sorted(found));
  }
}

TEST(Zeros, NearlyTouchingOnesToo) {
  // cos θ = 1 − h²/2 + h⁴/24 at θ = ±h
  for (const double h : {1e-1, 1e-3, 1e-5}) {
    TrigonometricPolynomial y{Eigen::VectorXcd::Zero(4)};
    y.phasors[0] = -std::cos(h);
    y.phasors[1] = std::polar(1.0, -1.0);  // cos(θ − 1)
    const std::vector<double> found = zeros(y);
    ASSERT_EQ(found.size(), 2U) << h;
    EXPECT_NEAR(found[0], 1.0 - h, 1e-15 / h);
    EXPECT_NEAR(found[1], 1.0 + h, 1e-15 / h);
  }
}

TEST(BalancedForce, IsTheLimitOfManySamples) {
  // Samples miss a jump by one step: differences fall as 1/N.
  std::mt19937 random(2);
  for (int trial = 0; trial < 12; ++trial) {
    const friction::Stop stop{.stiffness = 3.0, .damping = trial % 2 == 0 ? 0.4 : 0.0, .gap = 0.3};
    const friction::Clearance law{stop, friction::Stop{.stiffness = 5.0, .damping = 0.2, .gap = -0.1},
                                  trial % 3 == 0 ? friction::ContactLoss::kGap : friction::ContactLoss::kZeroForce};
    const TrigonometricPolynomial y = random_polynomial(random, 9, 1.5);
    const BalancedForce exact = balanced_force(BalancedClearance{law}, y, 0.8, kExact, 9);
    const double coarse = (balanced_force(BalancedClearance{law}, y, 0.8, 2000, 9).phasors - exact.phasors).norm();
    const double fine = (balanced_force(BalancedClearance{law}, y, 0.8, 64000, 9).phasors - exact.phasors).norm();
    EXPECT_LT(fine, 2e-4 * exact.phasors.norm());
    if (exact.switches > 0) {
      EXPECT_LT(fine, 0.3 * coarse);
    }
  }
}

TEST(Balance, JacobianIsExactWithTheJumps) {
  const auto expect_exact = [](const HybridSystem& system, int H) {
    expect_exact_jacobian(system, balance(system, {.harmonics = H}), 1e-4, 1e-7);
  };
  expect_exact(one_sided(1.3), 12);
  expect_exact(one_sided(1.3, friction::ContactLoss::kZeroForce), 12);
  expect_exact(Backlash{.omega = 1.2}.system(), 9);
  expect_exact(three_masses(1.1), 8);
  expect_exact(four_masses(1.1), 8);
}

TEST(Balance, Table2OfS2FromNothingAndFromANeighbour) {
  for (const PlayRow& row : kPlayTable)
    for (const int H : {11, 25, 49}) {
      SCOPED_TRACE(testing::Message() << row.figure << ", " << H << " harmonics");
      const HybridSystem system = play(row.xi, row.a, row.omega);
      const Balance cold = balance(system, {.harmonics = H});
      ASSERT_TRUE(cold.converged) << cold.message;
      EXPECT_LE(cold.iterations, 60);
      EXPECT_EQ(cold.switches, 4);
      // |y_k| falls as k⁻⁴ where the second derivative of the force jumps: so does the coefficients' error, or faster.
      EXPECT_LT(largest_difference(cold, row), H == 11 ? 7e-3 : H == 25 ? 1e-4 : 4e-6);
      const Balance next = balance(play(row.xi, 1.01 * row.a, row.omega), {.harmonics = H, .guess = cold.displacement});
      EXPECT_TRUE(next.converged);
      EXPECT_LE(next.iterations, 5);
    }
}

TEST(Balance, PrintedRowsAreBalanceCutAtThePrintedOrder) {
  // S2 Table 2, 8(a) with three printed harmonics, 8(b) and 9(b) with four; 1e-4 to 3e-4 is what its samples add.
  const auto sine_and_cosine = [](const PlayRow& row, int H) {
    const Balance own = balance(play(row.xi, row.a, row.omega), {.harmonics = H});
    return own.displacement[0];
  };
  const Harmonics a = sine_and_cosine(kPlayTable[2], 5);
  EXPECT_NEAR(a.cosine[1], 1.0900, 1e-4);
  EXPECT_NEAR(a.sine[1], 0.5780, 1e-4);
  EXPECT_NEAR(a.cosine[5], -0.0219, 1e-4);
  const Harmonics b = sine_and_cosine(kPlayTable[5], 7);
  EXPECT_NEAR(b.cosine[1], 1.0653, 3e-4);
  EXPECT_NEAR(b.sine[5], -0.1151, 3e-4);
  EXPECT_NEAR(b.sine[7], 0.0074, 3e-4);  // the orbit's own is −0.00058: no misprint, but truncation
}

TEST(Balance, AliasingOfSamplesIsNotMendedByHarmonics) {
  const auto aliasing = [](const PlayRow& row, int H, int samples) {
    const HybridSystem system = play(row.xi, row.a, row.omega);
    const Harmonics exact = balance(system, {.harmonics = H}).displacement[0];
    const Harmonics sampled = balance(system, {.harmonics = H, .samples = samples}).displacement[0];
    return std::max((exact.cosine - sampled.cosine).cwiseAbs().maxCoeff(),
                    (exact.sine - sampled.sine).cwiseAbs().maxCoeff());
  };
  // Least and greatest of the eight rows, highest orders 11 and 49: the figures, found again here.
  for (const auto& [samples, least, greatest] : {std::tuple{128, 9e-5, 2.5e-3}, std::tuple{1024, 3e-6, 5e-5}}) {
    double low = 1.0, high = 0.0;
    for (const PlayRow& row : kPlayTable)
      for (const int H : {11, 49}) {
        const double own = aliasing(row, H, samples);
        low = std::min(low, own);
        high = std::max(high, own);
      }
    EXPECT_NEAR(low, least, 0.05 * least);
    EXPECT_NEAR(high, greatest, 0.05 * greatest);
  }
}

TEST(Balance, FamilyInTheGapAndImpactingOrbitCoexist) {
  const PlayRow& row = kPlayTable[3];  // Figure 8(b)
  const HybridSystem system = play(row.xi, row.a, row.omega);
  EXPECT_EQ(balance(system, {.harmonics = 25}).switches, 4);
  const Balance gap = balance(system, {.harmonics = 25, .start = BalanceStart::kGap});
  EXPECT_EQ(gap.switches, 0);
  EXPECT_TRUE(gap.family);
  EXPECT_NEAR(gap.displacement[0].amplitude()[1], row.a / (row.omega * std::hypot(row.omega, 2.0 * row.xi)), 1e-13);
  const Certificate certificate = certify(system, gap);
  EXPECT_TRUE(certificate.behind);
  EXPECT_EQ(certificate.found.orbit.family.cols(), 1);
}

TEST(Certificate, ErrorIsThatOfTenThousandPoints) {
  struct Case {
    HybridSystem system;
    int harmonics;
  };
  // Elastic stops of high order: the fewest instants for each harmonic, and errors that peak where the force has a
  // kink.
  for (const auto& [system, harmonics] : {Case{Backlash{.omega = 1.2}.system(), 15}, Case{three_masses(1.1), 15},
                                          Case{four_masses(1.1), 15}, Case{Backlash{.omega = 1.2}.system(), 81},
                                          Case{play(0.02, 1.0833, 1.0), 61}, Case{play(0.02, 1.0833, 1.0), 101}}) {
    const Balance own = balance(system, {.harmonics = harmonics});
    const Certificate certificate = certify(system, own);
    ASSERT_TRUE(certificate.behind) << certificate.verdict;
    const OrbitSeries exact(system, certificate.found.orbit);
    for (std::size_t c = 0; c < own.displacement.size(); ++c) {
      double most = 0.0;
      for (int k = 0; k < 10000; ++k) {
        const double t = exact.start() + exact.period() * k / 10000.0;
        most = std::max(
            most, std::abs(exact.at(t)[static_cast<Eigen::Index>(c)] - value_of(own.displacement[c], own.omega * t)));
      }
      EXPECT_NEAR(certificate.error[c], most, 0.01 * most);
    }
  }
}

TEST(Certificate, ErrorFallsAsTheForceIsSmooth) {
  // Undamped stops: the force is continuous, y's third derivative jumps, y_k ~ k⁻⁴, the sum of what is left out ~ H⁻³.
  // Damped ones: the force jumps, one order less. Over a factor of 8 in H, to half an order.
  const auto order = [](const HybridSystem& system) {
    const double coarse = certify(system, balance(system, {.harmonics = 15})).relative;
    const double fine = certify(system, balance(system, {.harmonics = 121})).relative;
    return std::log(coarse / fine) / std::log(121.0 / 15.0);
  };
  EXPECT_NEAR(order(play(0.02, 1.0833, 1.0)), 3.0, 0.5);
  EXPECT_NEAR(order(Backlash{.omega = 1.2}.system()), 2.0, 0.5);
}

TEST(Certificate, ErrorIsTheSameAtTheFrequencyOfAnUndampedMode) {
  // Its receptance has no bound there; what the stops let it do is nothing special.
  const friction::Stop stop{.stiffness = 4.0, .gap = 1.0};
  const auto error = [&](double omega) {
    const HybridSystem system(fem::masses({.links = {{.stiffness = 1.0}}}),
                              {{Eigen::VectorXd::Ones(1), friction::Clearance{stop, stop}}},
                              Backlash::drive(0.3, omega), {}, Eigen::MatrixXd::Ones(1, 1));
    const Certificate certificate = certify(system, balance(system, {.harmonics = 15}));
    EXPECT_TRUE(certificate.behind) << certificate.verdict;
    return certificate.relative;
  };
  const double beside = error(1.001);
  for (const double omega : {1.0, 1.0 + 1e-15, 1.0 - 1e-12, 1.0 + 1e-7})
    EXPECT_NEAR(error(omega), beside, 0.02 * beside);
}

TEST(Certificate, OrderIsChosenByTheTrueError) {
  for (const double error : {1e-3, 1e-5}) {
    const HybridSystem system = play(0.05063, 0.1, 0.3);
    const CertifiedBalance chosen = balance_to_error(system, {}, error);
    ASSERT_TRUE(chosen.met);
    EXPECT_LE(chosen.certificate.relative, error);
    int least = 1;  // all orders one by one
    for (Balance own;; ++least) {
      own = balance(system, {.harmonics = least});
      if (own.converged && certify(system, own).relative <= error && certify(system, own).behind) break;
    }
    EXPECT_LE(chosen.approximation.harmonics, 1.5 * least);
    EXPECT_GE(chosen.approximation.harmonics, least);
  }
}

TEST(Certificate, OrdersThatFollowBySubstitutionSolveTheSameEquations) {
  // Beyond order 120: the residual of all orders, by the full equations, and the order of convergence go on.
  const HybridSystem system = play(0.02, 1.0833, 1.0);
  const CertifiedBalance chosen = balance_to_error(system, {}, 1e-9);
  ASSERT_TRUE(chosen.met);
  EXPECT_GT(chosen.approximation.harmonics, 200);
  EXPECT_LT(balance_equations(system, chosen.approximation).residual.cwiseAbs().maxCoeff(), 2e-12);
}

TEST(Certificate, SaysThatNoOrbitLiesBehind) {
  // One-sided stiff stop well below resonance: five harmonics balance with six switches, no orbit is near.
  const HybridSystem system = one_sided(0.5);
  const Balance own = balance(system, {.harmonics = 5});
  ASSERT_TRUE(own.converged);
  const Certificate certificate = certify(system, own);
  EXPECT_FALSE(certificate.behind);
  EXPECT_THAT(certificate.verdict, testing::HasSubstr("no orbit lies behind this balance"));
}

TEST(Balance, SaysHowFarItCame) {
  const Balance own = balance(Backlash{.omega = 0.4}.system(), {.harmonics = 15, .max_iterations = 3});
  EXPECT_FALSE(own.converged);
  EXPECT_GT(own.residual, 1e-6);
  EXPECT_THAT(own.message, testing::HasSubstr("no balance of 15 harmonics found"));
}

TEST(Balance, RefusesWhatItCannotHold) {
  const HybridSystem system = Backlash{}.system();
  EXPECT_THROW((void)balance(system, {.harmonics = 0}), InvalidInput);
  EXPECT_THROW((void)balance(system, {.harmonics = 9, .samples = 18}), InvalidInput);
  EXPECT_THROW((void)balance(system, {.order = 0}), InvalidInput);
  EXPECT_THROW((void)balance_to_error(system, {}, 0.0), InvalidInput);
  const HybridSystem rubbed(system.structure(), {{Eigen::VectorXd::Ones(1), friction::Coulomb{0.3, 0.3}, 1.0}},
                            Backlash::drive(1.0, 1.0), {}, Eigen::MatrixXd::Ones(1, 1));
  EXPECT_THROW((void)balance(rubbed), InvalidInput);
  EXPECT_THROW((void)balance(system.with_drive(friction::Belt::constant(1.0))), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
