#include <slipmode/diagnostics/series/spectrum.hpp>

#include <slipmode/core/errors.hpp>
#include "diagnostics/series/internal/fourier.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {

namespace {

Eigen::VectorXd hann(Eigen::Index n) {
  const Eigen::ArrayXd phase =
      Eigen::ArrayXd::LinSpaced(n, 0.0, static_cast<double>(n - 1)) * (2.0 * std::numbers::pi / static_cast<double>(n));
  return 0.5 * (1.0 - phase.cos());
}

}  // namespace

AmplitudeSpectrum amplitude_spectrum(const Eigen::VectorXd& series, double interval, Eigen::Index segment) {
  constexpr Eigen::Index kFewest = 4, kSegments = 8;
  const Eigen::Index total = series.size();
  // Eight segments that overlap by half span nine halves.
  const Eigen::Index n = segment > 0 ? segment : 4 * (total / (2 * (kSegments + 1)));
  if (!(interval > 0.0) || n < kFewest || n > total) {
    throw InvalidInput(
        fmt::format("spectrum: expected an interval > 0 and segments of {} to {} samples, found {} and {}", kFewest,
                    total, interval, n));
  }
  if (!series.allFinite()) throw InvalidInput("spectrum: expected finite samples, found one that is not");
  RealTransform transform(n);
  const Eigen::VectorXd window = hann(n);
  AmplitudeSpectrum out;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n / 2 + 1);
  double mean_square = 0.0;
  for (Eigen::Index begin = 0; begin + n <= total; begin += std::max<Eigen::Index>(n / 2, 1)) {
    const Eigen::VectorXd part = series.segment(begin, n);
    // Under the window: the plain mean of a sine cut off within its period would stand out at the lowest frequencies.
    const double mean = window.dot(part) / window.sum();
    sum += transform.forward((part.array() - mean).matrix().cwiseProduct(window)).cwiseAbs2();
    mean_square += mean * mean;
    ++out.segments;
  }
  const auto count = static_cast<double>(out.segments);
  const Eigen::Index half = n / 2;
  out.frequency_hz =
      Eigen::VectorXd::LinSpaced(half + 1, 0.0, static_cast<double>(half)) / (static_cast<double>(n) * interval);
  out.amplitude = (sum / count).cwiseSqrt() * (2.0 / window.sum());
  out.amplitude(0) = std::sqrt(mean_square / count);
  if (n % 2 == 0) out.amplitude(n / 2) *= 0.5;
  return out;
}

}  // namespace slipmode::diagnostics
