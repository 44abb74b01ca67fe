#pragma once

#include <Eigen/Core>
#include <string>

namespace slipmode::diagnostics {

/// A scalar measured at equal intervals: what every series tool reads.
struct Series {
  Eigen::VectorXd values;          ///< samples in time order [T], in `unit`
  double interval = 1.0;           ///< between samples, > 0, in `time_unit`; 1 step for a map
  std::string name = "series";     ///< named in messages
  std::string unit = "1";          ///< of the values
  std::string time_unit = "step";  ///< of the interval
};

/// A series from samples and their instants.
/// @param times   instants, increasing by one interval within 1e-6 of it [T]
/// @param values  samples [T]
/// @throws InvalidInput  for unequal lengths, fewer than two samples, or instants that are not finite or not equally
///                       spaced: the message names the first sample that is out of step, and whether samples are
///                       missing
[[nodiscard]] Series uniform_series(const Eigen::VectorXd& times, const Eigen::VectorXd& values,
                                    std::string name = "series");

/// Checks a series before use.
/// @param least    samples that would do
/// @param purpose  what they are for, to begin the message
/// @throws InvalidInput  if there are fewer than `least` samples, one is not finite, the interval is not positive, or
///                       all samples are equal within rounding
void check_series(const Series& series, Eigen::Index least, const std::string& purpose);

/// Part of a series: `count` samples from `begin`, everything else as it was.
/// @throws InvalidInput  if they are not all there
[[nodiscard]] Series part(const Series& series, Eigen::Index begin, Eigen::Index count);

/// First half and second half (the last sample is left out of an odd number): the spread of a figure between them is
/// the uncertainty the series tools give.
[[nodiscard]] Series first_half(const Series& series);
[[nodiscard]] Series second_half(const Series& series);

/// Autocorrelation ρ_k = Σ_j (x_j − x̄)(x_{j+k} − x̄) / Σ_j (x_j − x̄)², k = 0 … max_lag, by FFT of the series padded with
/// zeros. The sum over j has T − k terms and is not divided by their number (the biased estimate, |ρ| ≤ 1).
/// @param max_lag  0 ≤ max_lag < T
/// @return [max_lag + 1]
/// @throws InvalidInput  as check_series, or for a max_lag out of range. Cost O(T log T).
[[nodiscard]] Eigen::VectorXd autocorrelation(const Series& series, Eigen::Index max_lag);

/// First lag at which the autocorrelation is below 1/e, in samples; T/2 if it never is up to there.
[[nodiscard]] Eigen::Index decorrelation_lag(const Series& series);

/// Samples per mean period: T over the number of upward crossings of the mean that follow a stay below
/// x̄ − σ/10, σ the standard deviation, so that noise on the level is not counted; T if there are fewer than two.
[[nodiscard]] double mean_period(const Series& series);

/// Whether that few samples per loop are those of a map, not of a curve that they could follow.
[[nodiscard]] constexpr bool is_sampled_map(double mean_period) { return mean_period < 6.0; }

/// Samples that separate two points in time so that they count as neighbours in space: the larger of the mean period
/// and the decorrelation lag, at least 1 and at most T/20. The window of Theiler.
/// Source: Theiler, Phys. Rev. A 34 (1986) 2427; the mean period as window: S4, section 3.2.3.
[[nodiscard]] Eigen::Index theiler_window(const Series& series);

}  // namespace slipmode::diagnostics
