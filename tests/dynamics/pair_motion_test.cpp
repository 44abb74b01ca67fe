// e^{Gt} of oscillating pairs. Expected: the elementary formula in long double.
#include <slipmode/dynamics/pair_motion.hpp>
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

constexpr Eigen::Index kPairs = 8;
using Pair = Eigen::Matrix<long double, 2, 2>;

ModalModel modes(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping) {
  ModalModel m;
  m.n = m.np = kPairs;
  m.g11 = Eigen::VectorXd::Zero(kPairs);
  m.g12 = Eigen::VectorXd::Ones(kPairs);
  m.g21 = -omega.cwiseAbs2();
  m.g22 = -damping;
  return m;
}

TEST(PairMotion, IsExactToRoundingOverAnyTimeAndForAnyRate) {
  fixtures::Draws random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    SCOPED_TRACE(trial);
    const double t = std::pow(10.0, random.uniform(-7.0, 2.0));
    Eigen::VectorXd omega(kPairs), damping(kPairs), free(2 * kPairs);
    for (Eigen::Index i = 0; i < kPairs; ++i) {
      omega(i) = std::pow(10.0, random.uniform(-2.0, 4.0));
      damping(i) = omega(i) * std::pow(10.0, random.uniform(-4.0, 0.0));
      free(i) = random.uniform(-0.5, 0.5) / omega(i);
      free(kPairs + i) = random.uniform(-0.5, 0.5);
    }
    const PairMotion motion(modes(omega, damping));
    ASSERT_TRUE(motion.available());
    Eigen::VectorXd change = Eigen::VectorXd::Zero(2 * kPairs);
    motion.add(t, free.data(), change.data());
    for (Eigen::Index i = 0; i < kPairs; ++i) {
      const long double square = static_cast<long double>(omega(i)) * omega(i), half = damping(i) / 2.0L;
      const long double w = std::sqrt(square - half * half), size = std::exp(-half * t);
      const long double c = std::cos(w * t), s = std::sin(w * t) / w, x = free(i), v = free(kPairs + i);
      const long double to_x = size * ((c + half * s) * x + s * v) - x;
      const long double to_v = size * ((c - half * s) * v - square * s * x) - v;
      const double bound = 1e-15 * (1.0 + omega(i) * t) * (std::abs(omega(i) * free(i)) + std::abs(free(kPairs + i)));
      EXPECT_NEAR(change(i) * omega(i), static_cast<double>(to_x) * omega(i), bound);
      EXPECT_NEAR(change(kPairs + i), static_cast<double>(to_v), bound);
    }
  }
}

TEST(PairMotion, KeepsSmallChangesOfALargeDeflection) {
  // x'' = -w² x from x = 1 at rest: x changes by -(wt)²/2 for small wt, which 1 + change would have lost.
  const PairMotion motion(modes(Eigen::VectorXd::Constant(kPairs, 1e-6), Eigen::VectorXd::Zero(kPairs)));
  Eigen::VectorXd free = Eigen::VectorXd::Zero(2 * kPairs), change = free;
  free.head(kPairs).setOnes();
  motion.add(1e-3, free.data(), change.data());
  for (Eigen::Index i = 0; i < kPairs; ++i) {
    EXPECT_NEAR(change(i) / -0.5e-18, 1.0, 1e-14);
    EXPECT_NEAR(change(kPairs + i) / -1e-15, 1.0, 1e-14);
  }
}

TEST(PairMotion, IsNotForPairsThatHardlyOscillate) {
  const Eigen::VectorXd omega = Eigen::VectorXd::Ones(kPairs);
  EXPECT_FALSE(PairMotion(modes(omega, 2.0 * omega)).available());
  EXPECT_FALSE(PairMotion(modes(omega, 3.0 * omega)).available());
  EXPECT_FALSE(PairMotion(modes(0.0 * omega, 0.0 * omega)).available());
}

/// e^A − I by Taylor's series: E of A/2ᵏ, then 2E + E² for each halving.
Pair change_by_series(Pair A) {
  int halvings = 0;
  for (; A.cwiseAbs().maxCoeff() > 0.25L; ++halvings) A /= 2.0L;
  Pair sum = A, term = A;
  for (int k = 2; k < 24; ++k) {
    term = (term * A / static_cast<long double>(k)).eval();
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = (2.0L * sum + sum * sum).eval();
  return sum;
}

TEST(PairChange, IsExactToRoundingOfWhatItsRatesDo) {
  // Pairs of every kind, also those that PairMotion is not for. What rests stays exactly: a state of a rigid body far
  // from the origin, of which e^{Gt} − I by a difference made 10^-16 of that place in any time.
  const auto rate = [](fixtures::Draws& random) { return std::pow(10.0, random.uniform(-3.0, 3.0)); };
  fixtures::Draws random(2);
  for (int trial = 0; trial < 4000; ++trial) {
    const double k = rate(random), d = rate(random), t = std::pow(10.0, random.uniform(-6.0, 0.0)) / std::max(k, d);
    const std::vector<Eigen::Vector4d> kinds{
        {0.0, 1.0, 0.0, 0.0},   {0.0, 1.0, 0.0, -d}, {0.0, 1.0, -k * k, -2.0 * k}, {0.0, 1.0, -k * k, -2.0 * k - d},
        {0.0, 1.0, -k * k, -d}, {0.0, 0.0, 0.0, -d}, {-d, 0.0, 0.0, 0.0},          {-k, 0.0, 0.0, -d},
        {-k, d, -d, -k}};
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      const Eigen::Vector4d& g = kinds[kind];
      ModalModel m;
      m.n = m.np = 1;
      m.g11 = g.segment<1>(0);
      m.g12 = g.segment<1>(1);
      m.g21 = g.segment<1>(2);
      m.g22 = g.segment<1>(3);
      const Eigen::Matrix2d G{{g(0), g(1)}, {g(2), g(3)}};
      const Eigen::Matrix2d change = m.change(0, t);
      const Pair exact = change_by_series(G.cast<long double>() * t);
      // By both rates: of a slow one beside a fast only its own share.
      const double half = -G.trace() / 2.0, square = half * half - G.determinant();
      const double own = square < 0.0 ? half : G.determinant() / std::max(half + std::sqrt(square), 1e-300);
      const Eigen::Matrix2d most = change_by_series(G.cwiseAbs().cast<long double>() * t).cast<double>();
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
          EXPECT_NEAR(change(i, j), static_cast<double>(exact(i, j)), 1e-14 * (most(i, j) + (i == j ? own * t : 0.0)))
              << "trial " << trial << ", kind " << kind << ", entry " << i << j << ", t " << t << ", k " << k << ", d "
              << d;
    }
  }
}

}  // namespace
}  // namespace slipmode::dynamics
