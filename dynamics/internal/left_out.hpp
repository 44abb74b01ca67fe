#pragma once

#include <slipmode/dynamics/nodes.hpp>

#include <Eigen/Core>

namespace slipmode::dynamics {

/// A bound for each of eight ellipses about the step, in whose foci it begins and ends; sums of semi-axes 2 to 256.
using PerEllipse = Eigen::Array<double, kNodes, 1>;

/// A polynomial of degree 8 in Chebyshev's form.
struct ChebyshevSeries {
  double mean = 0.0;                       ///< coefficient 0
  alignas(64) RadauTables::Vector8 other;  ///< 1 to 8

  ChebyshevSeries(const kernels::Kernels& kernels, double start, const RadauTables::Vector8& at_nodes);
  /// How far from the mean it is on each ellipse at most.
  [[nodiscard]] PerEllipse swing() const;
  /// The same within the step.
  [[nodiscard]] double spread() const { return other.cwiseAbs().sum(); }
};

/// ln of a bound on what the polynomial of degree 7 through the nodes leaves out of a function f: its Chebyshev
/// coefficients are at most 2 max|f| ϱ^{−k}, the maximum taken over an ellipse, ϱ the sum of its semi-axes (Trefethen,
/// Approximation Theory and Approximation Practice, theorem 8.1).
/// @param log_most  ln max|f| on each ellipse
[[nodiscard]] double log_remainder(const PerEllipse& log_most);

/// What a polynomial of degree 8 has beyond the one of degree 7 through the nodes: most at the step's start.
[[nodiscard]] double eighth_degree(double start, const RadauTables::Vector8& at_nodes);

}  // namespace slipmode::dynamics
