#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/linear_region.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

struct CorrelationOptions {
  Embedding embedding = {};
  int radii = 48;                  ///< equally spaced in the logarithm, ≥ 8
  double smallest = 1e-3;          ///< radius, in ranges (max − min) of the series
  double largest = 0.5;            ///< radius, in ranges of the series
  Eigen::Index window = 0;         ///< of Theiler [samples]; 0: theiler_window(series)
  Eigen::Index references = 5000;  ///< points whose neighbours are counted, evenly spaced; 0: all
  double least_pairs = 100.0;      ///< radii with fewer pairs are not fitted
  double most_share = 0.05;        ///< nor are radii within which more of all pairs lie: there the set's edge shows
  double least_decades = 1.0;      ///< width of the plateau in log₁₀ r
  ParallelOptions run = {};        ///< points run in parallel
};

/// Correlation sum, local slopes, dimension.
struct CorrelationDimension {
  double dimension = 0.0;  ///< slope over the plateau
  /// Root sum of squares of: half the difference of the slopes of the two halves of the references; the curvature of
  /// ln C over the plateau.
  double error = 0.0;
  Eigen::VectorXd radius;       ///< ascending [unit of the series]
  Eigen::VectorXd C;            ///< share of the allowed pairs not farther apart than the radius
  Eigen::VectorXd local_slope;  ///< of ln C over ln r, over five radii (fewer at the ends); NaN where C is 0
  LinearFit plateau;            ///< of ln C over ln r; indices into radius
  double of_halves[2] = {0.0, 0.0};
  Eigen::Index references = 0;
  CorrelationOptions settings;  ///< with the window used
};

/// C(r) = pairs (i, j), |i − j| > window, ‖x_i − x_j‖∞ ≤ r, over all such pairs; i runs over the references. The
/// plateau is the straightest stretch of ln C(ln r) among radii with enough pairs and not too large a share.
///
/// A set of dimension D seen through N points ends at D = 2 log₁₀ N (Eckmann, Ruelle, Physica D 56 (1992) 185): a
/// larger result says nothing. Noise gives the embedding's dimension.
/// @throws InvalidInput      for options out of range, or fewer samples than span + 2·window + 500
/// @throws NumericalFailure  if no plateau qualifies
/// Source: Grassberger, Procaccia, Physica D 9 (1983) 189; Theiler, Phys. Rev. A 34 (1986) 2427.
[[nodiscard]] CorrelationDimension correlation_dimension(const Series& series, const CorrelationOptions& options = {});

}  // namespace slipmode::diagnostics
