#include "fem/internal/mode_conventions.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/signs.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::fem::detail {

namespace {

// Relative to max K_ii/M_ii: larger eigenvalues need no second look.
constexpr double kSuspiciouslySmall = 1e-8;
// Relative to the same: a λ below minus that is no rounding.
constexpr double kIndefinite = 1e-13;

double stiffness_to_mass(const Structure& structure) {
  const auto diagonal = [](const auto& m) { return Eigen::VectorXd(m.diagonal()); };
  return (std::visit(diagonal, structure.K()).array() / std::visit(diagonal, structure.M()).array()).maxCoeff();
}

// What the share of an elastic mode in a rigid-body shape adds to φᵀKφ. Solvers err by a few ε λ_max in K, which turns
// a rigid-body shape towards a mode of λ by that over λ: in φᵀKφ its square times λ, most for the softest mode.
double quotient_of_impurity(const Eigen::VectorXd& values, double largest) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  double softest = largest;
  for (const double value : values)
    if (value > 1e3 * epsilon * largest) softest = std::min(softest, value);
  return std::pow(4.0 * epsilon * largest, 2) / softest;
}

// λ of a shape whose computed λ is so small that the eigensolver's own rounding may hide it.
double reconsider(const Structure& structure, double lambda, const Eigen::VectorXd& shape, double impurity,
                  double largest) {
  const double quotient = shape.dot(multiply(structure.K(), shape).col(0));
  const double rounding = rounding_of_quotient(structure.K(), shape) + impurity;
  // Of a projected K the terms themselves have been rounded, at the size of what cancelled in them.
  if (quotient < -std::max(rounding, kIndefinite * largest)) {
    throw InvalidInput(
        fmt::format("natural modes: K is not positive semi-definite, a shape has φᵀKφ = {:.3g}; check "
                    "the signs of the stiffness matrix",
                    quotient));
  }
  if (quotient <= rounding) return 0.0;
  return lambda > 0.0 ? lambda : quotient;
}

}  // namespace

double rounding_of_quotient(const Matrix& K, const Eigen::VectorXd& shape) {
  const Eigen::VectorXd squares = shape.cwiseAbs2();
  const double sum = std::visit([&squares](const auto& m) { return squares.dot(m.cwiseAbs2() * squares); }, K);
  return 16.0 * std::numeric_limits<double>::epsilon() * std::sqrt(sum);
}

Modes conventional_modes(const Structure& structure, EigenPairs pairs) {
  const double largest = stiffness_to_mass(structure), impurity = quotient_of_impurity(pairs.values, largest);
  for (Eigen::Index k = 0; k < pairs.values.size() && pairs.values(k) <= kSuspiciouslySmall * largest; ++k) {
    pairs.values(k) = reconsider(structure, pairs.values(k), pairs.vectors.col(k), impurity, largest);
  }
  fix_signs(pairs.vectors);
  return {pairs.values.cwiseSqrt(), std::move(pairs.vectors)};
}

}  // namespace slipmode::fem::detail
