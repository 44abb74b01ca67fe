#pragma once

#include <slipmode/friction/places.hpp>
#include <slipmode/orbits/balance/balance.hpp>
#include "fixtures/differences.hpp"

#include <gtest/gtest.h>
#include <random>

namespace slipmode::orbits {

/// Newton's Jacobian at a balance against central differences of fourth order along random directions.
/// @param h          of the differences, in a direction's units @param tolerance  of J times a direction
inline void expect_exact_jacobian(const dynamics::HybridSystem& system, const Balance& at, double h, double tolerance) {
  const Eigen::MatrixXd J = balance_equations(system, at).jacobian;
  const Eigen::Index B = 2 * at.harmonics + 1;
  const auto places = friction::by_place(system.contacts());
  ASSERT_EQ(J.cols(), std::ssize(places) * B + at.rigid.size());
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 4; ++trial) {
    Eigen::VectorXd direction(J.cols());
    for (double& entry : direction) entry = normal(random);
    direction.tail(at.rigid.size()).setZero();  // set by the means
    const auto moved = [&](double share) -> Eigen::VectorXd {
      Balance there = at;
      for (std::size_t p = 0; p < places.size(); ++p)
        for (const std::size_t c : places[p]) {
          const auto own = direction.segment(static_cast<Eigen::Index>(p) * B, B);
          there.displacement[c].cosine += share * own.head(at.harmonics + 1);
          there.displacement[c].sine.tail(at.harmonics) += share * own.tail(at.harmonics);
        }
      return balance_equations(system, there).residual;
    };
    const Eigen::VectorXd rate = fixtures::slope(moved, h);
    EXPECT_LT((rate - J * direction).norm(), tolerance * (J * direction).norm());
  }
}

}  // namespace slipmode::orbits
