#pragma once

#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>
#include <optional>

namespace slipmode::diagnostics {

/// Where a record in delay coordinates x(t) = (s(t), s(t + lag), …) is cut.
enum class Cut {
  kUpward,    ///< s rises through the level
  kDownward,  ///< s falls through the level
  kMaximum,   ///< s is greatest: ṡ falls through zero
  kStrobe,    ///< once per period, for driven records
};

struct SectionOptions {
  Embedding embedding = {.dimension = 3, .lag = 1};
  Cut cut = Cut::kUpward;
  std::optional<double> level = {};  ///< of kUpward and kDownward [unit of the series]; empty: its mean
  double period = 0.0;               ///< of kStrobe, > 0 [time unit of the series]
  double phase = 0.0;                ///< of kStrobe: the first cut is taken at phase · period, in [0, 1)
  int order = 5;                     ///< of the polynomials between samples: 1, 3 or 5
};

/// The points in which a record meets a section.
struct SectionPoints {
  Eigen::VectorXd time;       ///< of each point, from the first sample [time unit of the series]
  Eigen::MatrixXd points;     ///< delay coordinates there, one column per point [dimension x m]
  double mean_return = 0.0;   ///< mean time between consecutive points [time unit]; 0 for fewer than two
  double return_error = 0.0;  ///< standard error of it, from the scatter of the times between points
  SectionOptions settings;    ///< with the level used
};

/// Poincaré section of a series. Between samples s is the polynomial of the given order through the order + 1 nearest
/// samples, and all delay coordinates are taken at the same instant; instants and points are exact to
/// O(interval^(order + 1)), instants of maxima to O(interval^order). Crossings less than an interval apart may be
/// missed.
/// @throws InvalidInput  for options out of range, or fewer samples than span + order + 2
/// Source: Hénon, Physica D 5 (1982) 412 for sections; interpolation by Lagrange polynomials.
[[nodiscard]] SectionPoints section(const Series& series, const SectionOptions& options = {});

}  // namespace slipmode::diagnostics
