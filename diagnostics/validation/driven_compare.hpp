#pragma once

#include <slipmode/core/none.hpp>
#include <slipmode/diagnostics/attractors/driven_sweep.hpp>

#include <vector>

namespace slipmode::diagnostics {

/// Two driven sweeps, value by value. Distances are between the section points of one reading, in units of the full
/// model's root mean square of that reading at the same value. Without values there are no shares and distances: NaN.
struct DrivenAgreement {
  std::size_t values = 0;           ///< where both models gave a result
  std::size_t failed = 0;           ///< where at least one did not
  double same_label = kNone;        ///< share of values with the same label
  double same_period = kNone;       ///< share with the same period, or none in both, of values decided in both
  double mean_wasserstein = kNone;  ///< over the values
  double median_wasserstein = kNone;
  double mean_hausdorff = kNone;
  std::vector<double> wasserstein;  ///< at each value; NaN where failed
};

/// @param reading  row of DrivenMotion::readings
/// @throws InvalidInput  if the points are not of the same values in the same order, or there is no such reading
[[nodiscard]] DrivenAgreement compare_driven(const std::vector<DrivenPoint>& full,
                                             const std::vector<DrivenPoint>& reduced, Eigen::Index reading = 0);

/// The same period in drive periods (that approached counts), or none in both.
[[nodiscard]] bool same_period(const DrivenPeriod& a, const DrivenPeriod& b);

/// Share of values at which two sweeps of one model, up and down with follow, find different motions: label or period
/// differ, or both repeat and their section points are further apart than 1 % of the reading's root mean square.
/// @param reverse  in the order of its own values, last value first
/// @throws InvalidInput  as compare_driven
[[nodiscard]] double hysteresis(const std::vector<DrivenPoint>& forward, const std::vector<DrivenPoint>& reverse,
                                Eigen::Index reading = 0);

/// Local maximum of a reading's amplitude over the swept parameter.
struct AmplitudePeak {
  double parameter = 0.0;
  double amplitude = 0.0;  ///< √2 · root mean square: that of a sine of the same power [m]
};

/// Maxima that rise above the ground on both sides by at least a twentieth of the largest amplitude, in order of the
/// parameter's values. Ends of the sweep are no maxima.
[[nodiscard]] std::vector<AmplitudePeak> amplitude_peaks(const std::vector<DrivenPoint>& points,
                                                         Eigen::Index reading = 0);

}  // namespace slipmode::diagnostics
