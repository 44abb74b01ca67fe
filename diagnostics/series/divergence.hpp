#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/linear_region.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// Which neighbours, and which distance, a divergence curve follows.
enum class DivergenceMethod {
  kRosenstein,  ///< the nearest neighbour of each point; Euclidean distance of the delay vectors
  kTransverse,  ///< as kRosenstein, for flows: distance from the neighbour's path rather than from its sample
  kKantz,       ///< all neighbours within a radius; distance of their last coordinates
};

struct DivergenceOptions {
  Embedding embedding = {};
  DivergenceMethod method = DivergenceMethod::kRosenstein;
  int steps = 20;           ///< the curve has points 0 … steps · stride [samples]
  Eigen::Index stride = 1;  ///< samples between points of the curve, ≥ 1
  Eigen::Index window = 0;  ///< of Theiler [samples]; 0: theiler_window(series)
  /// kKantz: radius in the maximum norm [unit of the series]; 0: twice the median distance to the tenth neighbour.
  double radius = 0.0;
  int least_neighbours = 5;     ///< kKantz: a point with fewer is left out
  Eigen::Index references = 0;  ///< points followed, evenly spaced over the record; 0: all
  RegionOptions region = {};    ///< where the line is fitted
  ParallelOptions run = {};     ///< points run in parallel
};

/// The largest exponent as the slope of the mean logarithm of distances.
struct Divergence {
  double exponent = 0.0;  ///< slope of the line [nat per time unit of the series]; bits: over ln 2
  /// Root sum of squares of: half the difference of the slopes of the two halves of the references; the curvature of
  /// the line. [nat per time unit]
  double error = 0.0;
  Eigen::VectorXd time;              ///< from the start [time unit]
  Eigen::VectorXd mean_log;          ///< mean over the references of the logarithm of the distance
  LinearFit region;                  ///< the part of the curve that was fitted
  double of_halves[2] = {0.0, 0.0};  ///< slope of each half of the references, in the same region
  Eigen::Index references = 0;       ///< points that had neighbours
  DivergenceOptions settings;        ///< with the window and radius used
};

/// Mean logarithm of the distance of neighbours against time, and its slope:
///   Rosenstein  S(τ) = ⟨ln ‖x_{i+τ} − x_{n(i)+τ}‖⟩_i,
///   transverse  S(τ) = ⟨ln min_θ ‖x_{i+τ} − x_{n(i)+τ+θ}‖⟩_i,
///   Kantz       S(τ) = ⟨ln ⟨|s_{i+span+τ} − s_{j+span+τ}|⟩_j⟩_i over ‖x_i − x_j‖∞ ≤ radius.
/// Samples of a flow lie up to half an interval apart along the path, a distance that does not grow and hides the one
/// across it, so that Rosenstein and Kantz read too low. Transverse takes the path as the parabola through three
/// samples and lets the neighbour's clock slip; of the 24 nearest samples it follows the one whose path is nearest.
/// Distances of exactly zero are left out. For a flow, give region.least_width at least a mean period: S swings with
/// it. A slope alone does not prove chaos: see series_verdict.
/// @throws InvalidInput      for options out of range, or fewer samples than span + steps·stride + 2·window + 100
/// @throws NumericalFailure  if fewer than 100 references have neighbours (the message names a radius that would do),
/// or
///                           no region qualifies
/// Source: Rosenstein, Collins, De Luca, Physica D 65 (1993) 117; Kantz, Phys. Lett. A 185 (1994) 77.
[[nodiscard]] Divergence divergence(const Series& series, const DivergenceOptions& options = {});

}  // namespace slipmode::diagnostics
