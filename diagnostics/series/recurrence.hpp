#pragma once

#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace slipmode::diagnostics {

struct RecurrenceOptions {
  Embedding embedding = {};
  Norm metric = Norm::kMaximum;
  double radius = 0.0;        ///< largest distance of a recurrence [unit of the series]; 0: the one that gives `rate`
  double rate = 0.05;         ///< share of the pairs that shall recur when no radius is given, in (0, 1)
  Eigen::Index stride = 1;    ///< samples between points of the plot, ≥ 1
  Eigen::Index points = 0;    ///< points of the plot, from the start; 0: all there are, at most 2,000
  Eigen::Index window = 0;    ///< pairs nearer in time are left out [samples]; 0: theiler_window(series)
  Eigen::Index shortest = 2;  ///< points of the shortest diagonal line counted, ≥ 2
};

/// Which pairs of points are near each other, and how they line up.
struct Recurrence {
  /// Pairs i < j of points of the plot that recur, by j, then i [2 x pairs]. Point i is sample i·stride.
  Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic> pairs;
  Eigen::Index points = 0;
  double rate = 0.0;  ///< recurrent pairs over all pairs outside the window
  /// Share of the recurrent pairs on diagonal lines of `shortest` points or more: near 1 where the future repeats with
  /// the present.
  double determinism = 0.0;
  double determinism_error = 0.0;  ///< half the difference between first and second half of the plot, one radius
  double mean_line = 0.0;          ///< mean length of those lines [points]; 0 without lines
  Eigen::Index longest = 0;        ///< longest diagonal line [points]
  double interval = 0.0;           ///< between points of the plot [time unit of the series]
  RecurrenceOptions settings;      ///< with the radius and window used
};

/// Recurrence plot R_ij = [‖x_i − x_j‖ ≤ radius] of delay vectors and its quantification, over |i − j|·stride > window.
///
/// Independent samples in dimension 1 on a plot of rate p line up by chance in a share 1 − (1 − p)² (shortest 2); delay
/// vectors share coordinates and line up more. Cost O(points² dimension).
/// @throws InvalidInput  for options out of range, or fewer samples than span + 2·window + 100·stride
/// Source: Eckmann, Oliffson Kamphorst, Ruelle, Europhys. Lett. 4 (1987) 973; Webber, Zbilut, J. Appl. Physiol. 76
/// (1994) 965; Marwan and others, Phys. Rep. 438 (2007) 237.
[[nodiscard]] Recurrence recurrence(const Series& series, const RecurrenceOptions& options = {});

}  // namespace slipmode::diagnostics
