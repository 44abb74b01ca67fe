// e^{Gt} of oscillating pairs. Expected: the elementary formula in long double.
#include <slipmode/dynamics/pair_motion.hpp>
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace slipmode::dynamics {
namespace {

constexpr Eigen::Index kPairs = 8;

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

}  // namespace
}  // namespace slipmode::dynamics
