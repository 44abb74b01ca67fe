#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

struct FalseNeighbourOptions {
  Eigen::Index lag = 1;     ///< delay [samples]
  int max_dimension = 10;   ///< dimensions 1 … max_dimension are examined
  Eigen::Index window = 0;  ///< of Theiler [samples]; 0: theiler_window(series)
  double ratio = 15.0;      ///< first criterion; S4 (3.24) compares squares with 10: ratio = √10 here
  double size = 2.0;        ///< second criterion, in standard deviations of the series
  double accepted = 0.01;   ///< share of false neighbours at which a dimension is enough
  /// Distances below this many standard deviations count as this: a record that repeats itself within rounding has
  /// neighbours at any smaller distance, whose ratios say nothing.
  double resolution = 1e-9;
  Eigen::Index references = 10000;  ///< points examined, evenly spaced over the record; 0: all
  ParallelOptions run = {};         ///< points run in parallel
};

/// Shares of points whose nearest neighbour is false, entry d − 1 for dimension d.
struct FalseNeighbours {
  Eigen::VectorXd by_ratio;  ///< by the first criterion
  Eigen::VectorXd by_size;   ///< by the second
  Eigen::VectorXd share;     ///< by either
  Eigen::VectorXd error;     ///< of share: half the difference between the first and second half of the references
  int dimension = 0;         ///< the first whose share is at most `accepted`; 0 if none is
  Eigen::Index references = 0;
  FalseNeighbourOptions settings;  ///< with the window used
};

/// Kennel's false nearest neighbours. In dimension d the nearest neighbour of x_i (Euclidean, outside the window) at
/// distance R_d is false if the next coordinate, |s_{i+d·lag} − s_{j+d·lag}| = a, is far:
///   first criterion   a / R_d > ratio,
///   second criterion  sqrt(R_d² + a²) / σ > size, σ the standard deviation of the series.
/// The second catches noise, whose neighbours in high dimensions are so far that no coordinate adds much.
/// Cost: max_dimension trees and references queries each.
/// @throws InvalidInput  for options out of range, or fewer samples than (max_dimension + 1)·lag + 2·window + 100
/// Source: Kennel, Brown, Abarbanel, Phys. Rev. A 45 (1992) 3403; S4, section 3.2.2.
[[nodiscard]] FalseNeighbours false_neighbours(const Series& series, const FalseNeighbourOptions& options = {});

/// Cao's averages, entry d − 1 for dimension d = 1 … max_dimension.
struct CaoAverages {
  Eigen::VectorXd E1;        ///< E(d + 1)/E(d): levels off near 1 when d is enough
  Eigen::VectorXd E2;        ///< E*(d + 1)/E*(d): 1 at every d for independent samples
  Eigen::VectorXd E1_error;  ///< from half the differences between the first and second half of the references
  Eigen::VectorXd E2_error;
  Eigen::Index references = 0;
  FalseNeighbourOptions settings;  ///< with the window used
};

/// Cao's method: E(d) is the mean of ‖x_i − x_j‖ in dimension d + 1 over ‖x_i − x_j‖ in dimension d, maximum norm, j
/// the nearest neighbour in dimension d; E*(d) is the mean of |s_{i+d·lag} − s_{j+d·lag}|. No tolerances: `ratio`,
/// `size` and `accepted` are not used.
/// @throws InvalidInput  as false_neighbours
/// Source: Cao, Physica D 110 (1997) 43.
[[nodiscard]] CaoAverages cao_averages(const Series& series, const FalseNeighbourOptions& options = {});

}  // namespace slipmode::diagnostics
