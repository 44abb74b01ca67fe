#include "fem/mode_conventions.hpp"

#include "core/errors.hpp"

#include <fmt/format.h>
#include <cmath>
#include <limits>

namespace slipmode::fem::detail {

namespace {

constexpr double kTie = 1e-9;
// Relative to max K_ii/M_ii: larger eigenvalues need no second look.
constexpr double kSuspiciouslySmall = 1e-8;

double stiffness_to_mass(const Structure& structure) {
  const auto diagonal = [](const auto& m) { return Eigen::VectorXd(m.diagonal()); };
  return (std::visit(diagonal, structure.K()).array() / std::visit(diagonal, structure.M()).array()).maxCoeff();
}

// λ of a shape whose computed λ is so small that the eigensolver's own rounding may hide it.
double reconsider(const Structure& structure, double lambda, const Eigen::VectorXd& shape) {
  const double quotient = shape.dot(multiply(structure.K(), shape).col(0));
  const double rounding = rounding_of_quotient(structure.K(), shape);
  if (quotient < -rounding) {
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

void fix_signs(Eigen::MatrixXd& shapes) {
  for (auto shape : shapes.colwise()) {
    const double nearly_largest = (1.0 - kTie) * shape.cwiseAbs().maxCoeff();
    for (const double component : shape) {
      if (std::abs(component) < nearly_largest) continue;
      if (component < 0.0) shape = -shape;
      break;
    }
  }
}

Modes conventional_modes(const Structure& structure, EigenPairs pairs) {
  const double suspicious = kSuspiciouslySmall * stiffness_to_mass(structure);
  for (Eigen::Index k = 0; k < pairs.values.size() && pairs.values(k) <= suspicious; ++k) {
    pairs.values(k) = reconsider(structure, pairs.values(k), pairs.vectors.col(k));
  }
  fix_signs(pairs.vectors);
  return {pairs.values.cwiseSqrt(), std::move(pairs.vectors)};
}

}  // namespace slipmode::fem::detail
