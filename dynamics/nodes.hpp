#pragma once

#include <slipmode/core/kernels/kernels.hpp>

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace slipmode::dynamics {

/// Collocation nodes per step: eight, one vector register.
inline constexpr std::ptrdiff_t kNodes = 8;

/// Universal matrices of an eight-node Radau IIA step on the unit interval (last node at 1).
///
/// Values at the nodes are "node values"; a polynomial of degree 7 through them represents a contact force, one of
/// degree 8 through them and the value at 0 represents a contact velocity. Matrices act on column vectors of node
/// values. Source: Hairer & Wanner, Solving Ordinary Differential Equations II, IV.5 (nodes); Farouki, 2012 (Bernstein
/// form).
struct RadauTables {
  using Matrix8 = Eigen::Matrix<double, 8, 8>;
  using Vector8 = Eigen::Matrix<double, 8, 1>;

  Vector8 node;              ///< c_1 < ... < c_8 = 1
  Vector8 weight;            ///< ∫₀¹ ℓ_j
  Matrix8 bernstein7;        ///< node values → Bernstein coefficients of the degree-7 interpolant
  Matrix8 bernstein8;        ///< node values → coefficients 1..8 of the degree-8 interpolant through f(0) too
  Vector8 bernstein8_start;  ///< contribution of f(0) to those (coefficient 0 is f(0) itself)
  Matrix8 legendre;          ///< node values → Legendre coefficients
  Vector8 legendre5, legendre6, legendre7;  ///< its last rows
  /// Node values and f(0) → Chebyshev coefficients 1 to 8 of the degree-8 interpolant, and coefficient 0.
  Matrix8 chebyshev;
  Vector8 chebyshev_start, chebyshev_mean;
  double chebyshev_mean_start;
  Matrix8 left_half;   ///< node values on [0,1] → node values on [0,½]
  Matrix8 right_half;  ///< node values on [0,1] → node values on [½,1]
  Matrix8 integral;    ///< node values → ∫₀^{c_i} of the degree-7 interpolant (Radau IIA's A)
  Matrix8 monomial;    ///< node values → coefficients of 1, t, ..., t⁷

  /// Node values on [0,1] → values at the nodes of the following interval of length 2, 1, ½, ¼: a first guess only, by
  /// the part of degree 5 (for length 2: 4), since extrapolation magnifies what is at the end of the expansion.
  std::array<Matrix8, 4> following;
  kernels::ProductRule product;  ///< ∫₀¹ of a contact's force times its velocity
  Vector8 barycentric;           ///< 1 / Π_{k≠j} (c_j − c_k)
  /// |f⁽ʲ⁾ − p⁽ʲ⁾| ≤ remainder[j] max |f⁽⁹⁾| on [0,1] for p of degree 8 through the nodes and f(0): max |Ω⁽ʲ⁾|/9! with
  /// Ω = t Π (t − c_k). Source: Shadrin, Error bounds for Lagrange interpolation, J. Approx. Theory 80 (1995).
  std::array<double, 3> remainder;
  std::array<double, 3> force_remainder;  ///< the same of degree 7 through the nodes alone, by max |f⁽⁸⁾|
  double lebesgue;                        ///< largest Σ |ℓ_j| on [0,1]

  /// Lagrange basis of the eight nodes at t.
  [[nodiscard]] Vector8 lagrange(double t) const;
  /// Its derivative at t.
  [[nodiscard]] Vector8 lagrange_slope(double t) const;
};

/// The tables, computed once.
[[nodiscard]] const RadauTables& radau();

/// Gauss-Legendre rule on [0,1], exact to degree 2·points − 1.
struct GaussRule {
  Eigen::VectorXd node, weight;
};
[[nodiscard]] GaussRule gauss_rule(int points);

}  // namespace slipmode::dynamics
