#pragma once

#include <slipmode/diagnostics/series/series.hpp>

namespace slipmode::diagnostics {

/// Traces of stick and slip in a series. Delay embedding and every estimate built on it assume a smooth observable.
struct Smoothness {
  double flat_share = 0.0;  ///< share of the samples in stretches of six or more that change by less than σ/10⁵ each
  double kinks_per_period = 0.0;  ///< second differences above twenty medians, counted once per run, per mean period
  bool coarse = false;            ///< fewer than 12 samples per mean period: kinks cannot be told and are not counted
  /// Flat share above 0.02 or more than 0.2 kinks per period: take the velocity of a mass far from the contact instead.
  bool doubtful = false;
};

/// Looks for flat stretches (sticking) and kinks (start and end of stick in a velocity).
/// @throws InvalidInput  as check_series, for fewer than 50 samples
/// Source: the advice to use the mass farthest from the contact is S4's, section 3.2.
[[nodiscard]] Smoothness smoothness(const Series& series);

}  // namespace slipmode::diagnostics
