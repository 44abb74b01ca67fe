#include "dynamics/internal/lobatto.hpp"

#include <slipmode/core/decompositions.hpp>

#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

LobattoTables build_lobatto() {
  LobattoTables t;
  Eigen::Matrix<long double, 8, 8> values;
  for (int j = 0; j < 8; ++j) {
    const long double at = (1.0L - std::cos(std::numbers::pi_v<long double> * j / 7)) / 2;
    t.point(j) = static_cast<double>(at);
    long double binomial = 1;
    for (int k = 0; k < 8; ++k) {
      values(j, k) =
          binomial * std::pow(at, static_cast<long double>(k)) * std::pow(1 - at, static_cast<long double>(7 - k));
      binomial = binomial * (7 - k) / (k + 1);
    }
  }
  t.bernstein = values.inverse().cast<double>();
  return t;
}

}  // namespace

const LobattoTables& lobatto() {
  static const LobattoTables tables = build_lobatto();
  return tables;
}

double interpolation_share(double rate, double h) {
  // |f − p| ≤ max|f⁽⁸⁾| (h/2)⁸ / (2⁶ 8!) on these points.
  constexpr double kFactorial8 = 40320.0;
  return std::pow(rate * h / 2.0, 8) / (64.0 * kFactorial8);
}

}  // namespace slipmode::dynamics
