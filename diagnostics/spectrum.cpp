#include "diagnostics/spectrum.hpp"

#include "core/errors.hpp"

#include <fftw3.h>
#include <fmt/format.h>

#include <cmath>
#include <mutex>
#include <numbers>

namespace slipmode::diagnostics {

namespace {

/// FFTW's planner keeps state of its own and serves one thread at a time.
std::mutex& planner() {
  static std::mutex mutex;
  return mutex;
}

/// A real transform of fixed length with its buffers.
class RealTransform {
 public:
  explicit RealTransform(Eigen::Index n)
      : in_(fftw_alloc_real(static_cast<std::size_t>(n))),
        out_(fftw_alloc_complex(static_cast<std::size_t>(n / 2 + 1))) {
    const std::lock_guard lock(planner());
    plan_ = fftw_plan_dft_r2c_1d(static_cast<int>(n), in_, out_, FFTW_ESTIMATE);
  }
  ~RealTransform() {
    const std::lock_guard lock(planner());
    fftw_destroy_plan(plan_);
    fftw_free(in_);
    fftw_free(out_);
  }
  RealTransform(const RealTransform&) = delete;
  RealTransform& operator=(const RealTransform&) = delete;

  /// |Σ x_j e^{−2πijk/n}|², k = 0 … n/2.
  Eigen::VectorXd power(const Eigen::VectorXd& x) {
    Eigen::Map<Eigen::VectorXd>(in_, x.size()) = x;
    fftw_execute(plan_);
    Eigen::VectorXd squares(x.size() / 2 + 1);
    for (Eigen::Index k = 0; k < squares.size(); ++k) squares(k) = out_[k][0] * out_[k][0] + out_[k][1] * out_[k][1];
    return squares;
  }

 private:
  double* in_;
  fftw_complex* out_;
  fftw_plan plan_ = nullptr;
};

Eigen::VectorXd hann(Eigen::Index n) {
  const Eigen::ArrayXd phase =
      Eigen::ArrayXd::LinSpaced(n, 0.0, static_cast<double>(n - 1)) * (2.0 * std::numbers::pi / static_cast<double>(n));
  return 0.5 * (1.0 - phase.cos());
}

}  // namespace

AmplitudeSpectrum amplitude_spectrum(const Eigen::VectorXd& series, double interval, Eigen::Index segment) {
  constexpr Eigen::Index kShortest = 4, kSegments = 8;
  const Eigen::Index total = series.size();
  // Eight segments that overlap by half span nine halves.
  const Eigen::Index n = segment > 0 ? segment : 4 * (total / (2 * (kSegments + 1)));
  if (!(interval > 0.0) || n < kShortest || n > total) {
    throw InvalidInput(
        fmt::format("spectrum: expected an interval > 0 and segments of {} to {} samples, found {} and {}", kShortest,
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
    const double mean = part.mean();
    sum += transform.power((part.array() - mean).matrix().cwiseProduct(window));
    mean_square += mean * mean;
    ++out.segments;
  }
  const auto count = static_cast<double>(out.segments);
  out.frequency_hz =
      Eigen::VectorXd::LinSpaced(n / 2 + 1, 0.0, static_cast<double>(n / 2)) / (static_cast<double>(n) * interval);
  out.amplitude = (sum / count).cwiseSqrt() * (2.0 / window.sum());
  out.amplitude(0) = std::sqrt(mean_square / count);
  if (n % 2 == 0) out.amplitude(n / 2) *= 0.5;
  return out;
}

}  // namespace slipmode::diagnostics
