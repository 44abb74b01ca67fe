#include <slipmode/diagnostics/series/series_verdict.hpp>

#include <slipmode/core/errors.hpp>
#include "diagnostics/series/internal/fourier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace slipmode::diagnostics {

namespace {

constexpr double kBadForecast = 0.6;  // in standard deviations

double variance(const Series& series) { return (series.values.array() - series.values.mean()).square().mean(); }

/// S(m), m = 0 … most, by the sums Σ x_j x_{j+m} from one transform and running sums of squares.
Eigen::VectorXd structure_function(const Series& series, Eigen::Index most) {
  const Eigen::Index n = series.values.size();
  const Eigen::VectorXd x = series.values.array() - series.values.mean();
  const Eigen::VectorXd products = autocorrelation(series, most) * x.squaredNorm();
  Eigen::VectorXd S(most + 1);
  double squares = 2.0 * x.squaredNorm();
  for (Eigen::Index m = 0; m <= most; ++m) {
    S(m) = (squares - 2.0 * products(m)) / (2.0 * static_cast<double>(n - m) * variance(series));
    squares -= x(n - 1 - m) * x(n - 1 - m) + x(m) * x(m);
  }
  return S;
}

/// Where a curve given at −2, −1, 0, 1, 2 is least near 0, and its value.
struct Least {
  double shift, value;
};

/// By the polynomial through the five points, whose minimum between −0.6 and 0.6 is bracketed by thirds.
Least least_between(const Eigen::VectorXd& y) {
  const auto at = [&](double t) {
    const double even1 = 0.5 * (y(3) + y(1)) - y(2), odd1 = 0.5 * (y(3) - y(1));
    const double even2 = 0.5 * (y(4) + y(0)) - y(2), odd2 = 0.5 * (y(4) - y(0));
    const double c4 = (even2 - 4.0 * even1) / 12.0, c3 = (odd2 - 2.0 * odd1) / 6.0;
    return y(2) + t * ((odd1 - c3) + t * ((even1 - c4) + t * (c3 + t * c4)));
  };
  constexpr int kThirds = 60;
  double low = -0.6, high = 0.6;
  for (int n = 0; n < kThirds; ++n) {
    const double third = (high - low) / 3.0;
    if (at(low + third) < at(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  const double shift = 0.5 * (low + high);
  return {shift, at(shift)};
}

/// Delay, dimension and tools that need them, on one series.
class Examination {
 public:
  Examination(const Series& series, const VerdictOptions& options)
      : series_(series), options_(options), loop_(mean_period(series)), window_(theiler_window(series)) {}

  bool sampled_map() const { return is_sampled_map(loop_); }
  double loop() const { return loop_; }

  Embedding embedding() const {
    if (options_.embedding) return *options_.embedding;
    const Eigen::Index lag = delay();
    const auto near = false_neighbours(series_, {.lag = lag,
                                                 .max_dimension = options_.max_dimension,
                                                 .window = window_,
                                                 .references = options_.references,
                                                 .run = options_.run});
    return {.dimension = near.dimension > 0 ? near.dimension : options_.max_dimension, .lag = lag};
  }

  double forecast(const Embedding& embedding) const {
    return forecast_error(series_, embedding, embedding.lag, window_, kForecasts);
  }

  SurrogateTest surrogates(const Embedding& embedding) const {
    const Series start = part(series_, 0, std::min(series_.values.size(), options_.surrogate_samples));
    return surrogate_test(
        start, {.embedding = embedding, .ahead = embedding.lag, .references = options_.forecasts, .run = options_.run});
  }

  ExponentSpectrum spectrum(const Embedding& embedding) const {
    return exponent_spectrum(series_, {.embedding = embedding,
                                       .neighbours = std::max(20, 3 * embedding.dimension),
                                       .window = window_,
                                       .run = options_.run});
  }

  /// Followed until a rise of six at the exponent already found, at least three loops.
  Divergence divergence_at(const Embedding& embedding, double exponent) const {
    const double samples = std::max(6.0 / (exponent * series_.interval), 3.0 * loop_);
    const Eigen::Index eighth = series_.values.size() / 8;
    const auto longest = static_cast<double>(eighth);
    const auto stride = std::max<Eigen::Index>(1, sampled_map() ? 1 : std::lround(loop_ / 8.0));
    const int steps = std::max(10, static_cast<int>(std::min(samples, longest)) / static_cast<int>(stride));
    return divergence(series_,
                      {.embedding = embedding,
                       .method = sampled_map() ? DivergenceMethod::kRosenstein : DivergenceMethod::kTransverse,
                       .steps = steps,
                       .stride = stride,
                       .window = window_,
                       .references = options_.references,
                       .region = {.least_rise = 0.3, .least_width = sampled_map() ? 0.0 : loop_ * series_.interval},
                       .run = options_.run});
  }

 private:
  static constexpr Eigen::Index kForecasts = 500;

  Eigen::Index delay() const {
    if (sampled_map()) return 1;
    const auto longest = static_cast<Eigen::Index>(std::ceil(loop_));
    const auto most = std::clamp<Eigen::Index>(longest, 4, std::max<Eigen::Index>(4, series_.values.size() / 4 - 400));
    const auto information = mutual_information(series_, {.max_lag = most, .run = options_.run});
    return information.first_minimum > 0 ? information.first_minimum : std::max<Eigen::Index>(1, longest / 4);
  }

  const Series& series_;
  const VerdictOptions& options_;
  double loop_;
  Eigen::Index window_;
};

std::optional<std::string> unsettled(const Series& series, const VerdictOptions& options, const Repeat& whole) {
  const Series first = first_half(series), second = second_half(series);
  constexpr double kMost = 1.5;
  check_series(second, 2, "verdict on the second half");
  const double ratio = variance(first) / variance(second);
  if (ratio > kMost || ratio < 1.0 / kMost) {
    return fmt::format("the variance of the first half is {:.3g} times that of the second", ratio);
  }
  if (whole.samples > 0.0) return std::nullopt;
  const bool early = find_repeat(first, options.repeat).samples > 0.0;
  const bool late = find_repeat(second, options.repeat).samples > 0.0;
  if (early != late) return fmt::format("only the {} half repeats itself", early ? "first" : "second");
  return std::nullopt;
}

/// Decides between everything that does not repeat itself.
void decide_aperiodic(SeriesVerdict& out, const Examination& examination, const Series& series) {
  const double interval = series.interval;
  constexpr double kGoodForecast = 0.1, kErrors = 3.0, kClear = 3.0, kPerLoop = 0.01;
  out.embedding = examination.embedding();
  out.surrogates = examination.surrogates(out.embedding);
  const double forecast = out.surrogates.error;
  out.spectrum = examination.spectrum(out.embedding);
  const double largest = out.spectrum.exponents(0), error = out.spectrum.error(0);
  const bool zero = largest < kErrors * error || largest * examination.loop() * interval < kPerLoop;
  if (zero && forecast < kGoodForecast) {
    out.motion = SeriesMotion::kQuasiPeriodic;
    out.reason = fmt::format(
        "no repeat, largest exponent {:.3g} ± {:.2g} nat per {} not above zero, forecasts miss by {:.2g} deviations",
        largest, error, series.time_unit, forecast);
    return;
  }
  const bool by_chance = forecast > kBadForecast && out.surrogates.distance < kClear;
  if (!out.surrogates.rejected || by_chance) {
    out.motion = SeriesMotion::kNoise;
    out.reason = fmt::format("forecasts miss by {:.2g} deviations, rank {} of {} among surrogates", forecast,
                             out.surrogates.rank, out.surrogates.settings.surrogates);
    return;
  }
  if (zero) {
    out.reason = fmt::format(
        "largest exponent {:.3g} ± {:.2g} nat per {} not above zero, yet forecasts miss by {:.2g} deviations", largest,
        error, series.time_unit, forecast);
    return;
  }
  out.divergence = examination.divergence_at(out.embedding, largest);
  const bool diverges = std::min(out.divergence.of_halves[0], out.divergence.of_halves[1]) > 0.0;
  if (diverges) out.motion = SeriesMotion::kChaotic;
  out.reason = fmt::format(
      "largest exponent {:.3g} ± {:.2g} by fitted Jacobians, neighbours diverge at {:.3g} ± {:.2g} nat per {}", largest,
      error, out.divergence.exponent, out.divergence.error, series.time_unit);
}

}  // namespace

const char* to_string(SeriesMotion motion) {
  switch (motion) {
    case SeriesMotion::kPeriodic:
      return "periodic";
    case SeriesMotion::kQuasiPeriodic:
      return "quasi-periodic";
    case SeriesMotion::kChaotic:
      return "chaotic";
    case SeriesMotion::kNoise:
      return "noise";
    case SeriesMotion::kNotSettled:
      return "not settled";
  }
  return "unknown";
}

Repeat find_repeat(const Series& series, double tolerance) {
  check_series(series, 100, "repeat");
  if (!(tolerance > 0.0)) throw InvalidInput(fmt::format("repeat: expected a tolerance > 0, found {}", tolerance));
  const bool between = !is_sampled_map(mean_period(series));
  const Eigen::VectorXd S = structure_function(series, series.values.size() / 3);
  Repeat out;
  for (Eigen::Index m = 1; m + 2 < S.size(); ++m) {
    if (S(m) > S(m - 1) || S(m) > S(m + 1)) continue;
    const Least least = between && m >= 2 ? least_between(S.segment(m - 2, 5)) : Least{0.0, S(m)};
    const double value = std::max(0.0, least.value);
    out.mismatch = std::min(out.mismatch, value);
    if (value > tolerance) continue;
    out.samples = static_cast<double>(m) + least.shift;
    break;
  }
  return out;
}

SeriesVerdict series_verdict(const Series& series, const VerdictOptions& options) {
  constexpr Eigen::Index kLeast = 1000;
  check_series(series, kLeast, "verdict");
  SeriesVerdict out;
  out.settings = options;
  out.smoothness = smoothness(series);
  out.repeat = find_repeat(series, options.repeat);
  const Examination examination(series, options);
  out.sampled_map = examination.sampled_map();
  if (const auto why = unsettled(series, options, out.repeat)) {
    out.embedding = examination.embedding();
    // Slow noise has halves that differ by chance.
    if (examination.forecast(out.embedding) <= kBadForecast) {
      out.reason = *why;
      return out;
    }
  }
  if (out.repeat.samples > 0.0) {
    out.motion = SeriesMotion::kPeriodic;
    out.T = out.repeat.samples * series.interval;
    const double loops = out.sampled_map ? out.repeat.samples : out.repeat.samples / examination.loop();
    out.period = std::max(1, static_cast<int>(std::lround(loops)));
    out.reason = fmt::format("repeats itself after {:.6g} to {:.2g} of its variance", out.T, out.repeat.mismatch);
    return out;
  }
  decide_aperiodic(out, examination, series);
  return out;
}

}  // namespace slipmode::diagnostics
