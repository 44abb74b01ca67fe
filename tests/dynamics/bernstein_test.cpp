#include "dynamics/internal/bernstein.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// Bernstein coefficients of Π (r_i − t), factor by factor: (r − t) has r and r − 1, and a product's coefficients are
/// b_k = ((n + 1 − k) r b_k + k (r − 1) b_{k−1}) / (n + 1).
BernsteinPolynomial with_roots(const std::vector<double>& roots) {
  BernsteinPolynomial p{static_cast<int>(roots.size()), {1.0}};
  for (std::size_t n = 0; n < roots.size(); ++n)
    for (std::size_t k = n + 2; k-- > 0;) {
      const double share = static_cast<double>(k) / static_cast<double>(n + 1);
      const double below = k > 0 ? p.coefficient[k - 1] : 0.0;
      p.coefficient[k] = (1.0 - share) * roots[n] * p.coefficient[k] + share * (roots[n] - 1.0) * below;
    }
  return p;
}

TEST(Bernstein, FindsTheFirstOfKnownRoots) {
  // Roots in and outside [0, 1], so that control polygons change sign once and several times.
  const std::vector<std::vector<double>> cases = {
      {0.3, 1.5, 2.0, 3.0, 1.7, 2.5, 4.0},    {0.3, 1.5, 2.0, 3.0, 1.7, 2.5, 4.0, 5.0},
      {0.2, 0.5, 0.9, 1.1, 1.2, 2.0, 3.0},    {0.61, 0.62, 0.63, 1.5, 2.0, 3.0, 4.0, 1.2},
      {0.01, 0.99, 1.3, 1.4, 1.01, 6.0, 7.0}, {0.999, 1.5, 2.0, 3.0, 1.7, 2.5, 4.0, 5.0},
      {0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0}, {0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0, 0.5},
  };
  for (const auto& roots : cases) {
    const auto root = first_root(with_roots(roots));
    ASSERT_TRUE(root.has_value());
    EXPECT_FALSE(root->touching);
    EXPECT_NEAR(root->at, *std::min_element(roots.begin(), roots.end()), 1e-9);
  }
}

TEST(Bernstein, SeesThatThereIsNoRoot) {
  EXPECT_FALSE(first_root(with_roots({1.1, 1.2, 1.3, 2.0, 3.0, 4.0, 5.0})).has_value());
  EXPECT_FALSE(first_root(with_roots({1.1, 1.2, 1.3, 2.0, 3.0, 4.0, 5.0, 6.0})).has_value());
  // Above a double root: control polygons go below zero before they are halved.
  BernsteinPolynomial p = with_roots({0.5, 0.5, 2.0, 2.0, 3.0, 3.0, 4.0});
  for (double& b : p.coefficient) b += 1e-3;
  EXPECT_FALSE(first_root(p).has_value());
}

TEST(Bernstein, SeparatesRootsCloseTogether) {
  const auto root = first_root(with_roots({0.3, 0.30001, 2.0, 3.0, 4.0, 5.0, 6.0}));
  ASSERT_TRUE(root.has_value());
  EXPECT_FALSE(root->touching);
  EXPECT_NEAR(root->at, 0.3, 1e-9);  // rounding of 1e-16 over a slope of 1e-5 times the other factors
}

TEST(Bernstein, DropsARootAtTheBegin) {
  BernsteinPolynomial p = with_roots({0.0, 0.4, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0});
  for (double& b : p.coefficient) b = -b;  // positive just after 0
  p.coefficient[0] = 0.0;
  const auto root = first_root(p);
  ASSERT_TRUE(root.has_value());
  EXPECT_NEAR(root->at, 0.4, 1e-9);
}

TEST(Bernstein, HalvesUntilThePolynomialStaysAbove) {
  // (t − ½)² + 0.02 by its coefficients of degree 7, k(k − 1)/42 − k/7 + ¼ + 0.02: the least is −0.0157.
  std::array<double, 8> p{};
  for (std::size_t k = 0; k < 8; ++k) {
    const double i = static_cast<double>(k);
    p[k] = i * (i - 1.0) / 42.0 - i / 7.0 + 0.27;
  }
  EXPECT_FALSE(stays_above(p, 0.0, 0));
  EXPECT_TRUE(stays_above(p, 0.0, 2));
  EXPECT_TRUE(stays_above(p, 0.019, 6));
  EXPECT_FALSE(stays_above(p, 0.021, 6));
}

}  // namespace
}  // namespace slipmode::dynamics
