#include "dynamics/internal/left_out.hpp"

#include <cmath>

namespace slipmode::dynamics {
namespace {

struct Ellipses {
  PerEllipse sum, inverse, cost;  ///< of semi-axes, ϱ; cost: ln(ϱ⁸ (1 − 1/ϱ))
  Ellipses() {
    for (int k = 0; k < kNodes; ++k) sum(k) = std::exp2(k + 1);
    inverse = sum.inverse();
    cost = kNodes * sum.log() + (1.0 - inverse).log();
  }
};

const Ellipses& ellipses() {
  static const Ellipses all;
  return all;
}

}  // namespace

ChebyshevSeries::ChebyshevSeries(const kernels::Kernels& kernels, double start, const RadauTables::Vector8& at_nodes)
    : mean(radau().chebyshev_mean.dot(at_nodes) + start * radau().chebyshev_mean_start) {
  kernels.matrix8(radau().chebyshev.data(), at_nodes.data(), other.data());
  other += start * radau().chebyshev_start;
}

PerEllipse ChebyshevSeries::swing() const {
  PerEllipse outward = PerEllipse::Zero();
  for (int k = kNodes; k-- > 0;) outward = (outward + std::abs(other(k))) * ellipses().sum;
  return 0.5 * (outward + spread() * ellipses().inverse);
}

double log_remainder(const PerEllipse& log_most) {
  static const double scale = std::log(2.0 * (1.0 + radau().lebesgue));
  return (log_most - ellipses().cost).minCoeff() + scale;
}

double eighth_degree(double start, const RadauTables::Vector8& at_nodes) {
  static const RadauTables::Vector8 at_start = radau().lagrange(0.0);
  return std::abs(start - at_start.dot(at_nodes));
}

}  // namespace slipmode::dynamics
