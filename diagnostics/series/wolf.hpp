#pragma once

#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

struct WolfOptions {
  Embedding embedding = {};
  Eigen::Index evolution = 1;  ///< samples a pair is followed before it is replaced, ≥ 1
  Eigen::Index window = 0;     ///< of Theiler [samples]; 0: theiler_window(series)
  double smallest = 0.0;       ///< neighbours nearer than this are noise [standard deviations of the series]
  double largest = 0.2;        ///< replacements farther than this are not small [standard deviations]
  double angle = 0.3;          ///< largest angle between a replacement and the vector it replaces [rad]
};

/// The largest exponent by following one pair of points.
struct WolfExponent {
  double nats = 0.0;   ///< [nat per time unit of the series]
  double bits = 0.0;   ///< nats / ln 2, the unit of S4 (3.25)
  double error = 0.0;  ///< standard error of `nats` from the scatter of eight equal stretches
  int evolutions = 0;  ///< pairs followed
  int kept = 0;  ///< of these, how often no replacement qualified and the old neighbour was kept or the angle given up
  double mean_distance = 0.0;  ///< at the start of an evolution [unit of the series]
  WolfOptions settings;        ///< with the window used
};

/// Wolf's exponent: a point and its neighbour at distance L are followed for `evolution` samples, to L'; then the
/// neighbour is replaced by the one nearest among those within `angle` of its direction, between `smallest` and
/// `largest` away. The exponent is Σ ln(L'/L) over the time. If none qualifies the old neighbour is kept while it is
/// nearer than `largest`; else the nearest point is taken whatever its direction. Cost: a search of radius `largest`
/// per evolution.
/// @throws InvalidInput      for options out of range, or fewer samples than span + 100·evolution + 2·window + 100
/// @throws NumericalFailure  if a point has no neighbour outside the window at a distance of `smallest` or more
/// Source: Wolf, Swift, Swinney, Vastano, Physica D 16 (1985) 285; S4, section 3.2.3.
[[nodiscard]] WolfExponent wolf_exponent(const Series& series, const WolfOptions& options = {});

}  // namespace slipmode::diagnostics
