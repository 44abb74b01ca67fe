#pragma once

#include <array>
#include <optional>

namespace slipmode::dynamics {

/// A polynomial of degree up to 8 on [0, 1] by its Bernstein coefficients: it lies within their convex hull, and has at
/// most as many roots as they have sign changes, so that the absence of a root is proved, not sampled. Source: Farouki,
/// The Bernstein polynomial basis: a centennial retrospective, 2012.
struct BernsteinPolynomial {
  int degree = 7;
  std::array<double, 9> coefficient{};
};

/// Where a polynomial that starts positive first stops being so.
struct FirstRoot {
  double at = 0.0;        ///< in (0, 1]
  bool touching = false;  ///< a double root within resolution: no change of sign could be separated
};

/// The first root in (0, 1] of a polynomial of degree 7 or 8 that is positive just after 0. A root at 0 itself is
/// dropped by setting the leading coefficients that vanish there to exactly zero.
[[nodiscard]] std::optional<FirstRoot> first_root(const BernsteinPolynomial& p);

/// The polynomial less a constant.
[[nodiscard]] BernsteinPolynomial lowered(BernsteinPolynomial p, double by);
/// The same polynomial between two places, on [0, 1] again.
[[nodiscard]] BernsteinPolynomial part(const BernsteinPolynomial& p, double from, double to);
/// dp/dt, of one degree less.
[[nodiscard]] BernsteinPolynomial derivative(const BernsteinPolynomial& p);

/// Least and largest of its coefficients: bounds.
[[nodiscard]] double least(const BernsteinPolynomial& p);
[[nodiscard]] double most(const BernsteinPolynomial& p);

/// Whether a polynomial of degree 7 stays above `bound` on [0, 1], by its convex hull on up to 2^halvings parts. A
/// false says nothing.
[[nodiscard]] bool stays_above(const std::array<double, 8>& coefficients, double bound, int halvings);

}  // namespace slipmode::dynamics
