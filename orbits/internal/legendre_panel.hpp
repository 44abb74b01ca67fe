#pragma once

#include <slipmode/dynamics/nodes.hpp>

#include <Eigen/Core>
#include <array>

namespace slipmode::orbits {

/// A stretch of time on which functions are Legendre series of degree 15, from their values at Gauss' points.
struct LegendrePanel {
  static constexpr int kTerms = 16;

  /// P_0 … P_15 at x.
  [[nodiscard]] static Eigen::Vector<double, kTerms> polynomials(double x) {
    Eigen::Vector<double, kTerms> p;
    p[0] = 1.0;
    p[1] = x;
    for (int j = 1; j + 1 < kTerms; ++j) p[j + 1] = ((2 * j + 1) * x * p[j] - j * p[j - 1]) / (j + 1);
    return p;
  }

  /// Gauss' points on [−1, 1], their weights for an average, and values there → coefficients.
  struct Rule {
    std::array<double, kTerms> point{}, share{};
    Eigen::Matrix<double, kTerms, kTerms> to_terms;

    Rule() {
      const dynamics::GaussRule rule = dynamics::gauss_rule(kTerms);
      for (int i = 0; i < kTerms; ++i) {
        const auto at = static_cast<std::size_t>(i);
        point[at] = 2.0 * rule.node(i) - 1.0;
        share[at] = rule.weight(i);
        to_terms.row(i) = rule.weight(i) * polynomials(point[at]);
        for (int j = 0; j < kTerms; ++j) to_terms(i, j) *= 2 * j + 1;
      }
    }
  };
  [[nodiscard]] static const Rule& rule() {
    static const Rule own;
    return own;
  }
};

}  // namespace slipmode::orbits
