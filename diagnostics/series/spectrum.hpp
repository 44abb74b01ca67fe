#pragma once

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// Amplitudes of a series over frequency.
struct AmplitudeSpectrum {
  Eigen::VectorXd frequency_hz;  ///< 0, f_s/N, …, f_s/2
  /// Root mean square over the segments of the amplitude of the sine at each frequency: a sine of amplitude a that lies
  /// on a frequency of the grid shows a there. At 0 and f_s/2 the amplitude of the constant and the alternation.
  Eigen::VectorXd amplitude;
  Eigen::Index segments = 0;  ///< averaged
};

/// Averaged amplitude spectrum: segments that overlap by half, their mean under Hann's window removed,
/// transformed, squares averaged.
/// @param series    equally spaced samples [T]
/// @param interval  between samples, > 0 [s]
/// @param segment   samples per segment N, 4 ≤ N ≤ T; 0: the largest even number with at least eight segments
/// @throws InvalidInput  for a series that is too short or not finite, or options out of range
/// Source: Welch, IEEE Trans. Audio Electroacoustics AU-15 (1967) 70.
[[nodiscard]] AmplitudeSpectrum amplitude_spectrum(const Eigen::VectorXd& series, double interval,
                                                   Eigen::Index segment = 0);

}  // namespace slipmode::diagnostics
