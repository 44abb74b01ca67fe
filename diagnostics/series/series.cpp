#include <slipmode/diagnostics/series/series.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/median.hpp>
#include "diagnostics/series/internal/fourier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

namespace slipmode::diagnostics {

namespace {

Eigen::Index first_not_finite(const Eigen::VectorXd& values) {
  return std::find_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); }) - values.begin();
}

}  // namespace

Series uniform_series(const Eigen::VectorXd& times, const Eigen::VectorXd& values, std::string name) {
  if (times.size() != values.size() || times.size() < 2) {
    throw InvalidInput(fmt::format("{}: expected as many instants as samples, at least 2, found {} and {}", name,
                                   times.size(), values.size()));
  }
  if (const Eigen::Index bad = first_not_finite(times); bad < times.size()) {
    throw InvalidInput(fmt::format("{}: expected finite instants, found {} at sample {}", name, times(bad), bad));
  }
  const Eigen::VectorXd steps = times.tail(times.size() - 1) - times.head(times.size() - 1);
  const double usual = median({steps.begin(), steps.end()});
  if (!(usual > 0.0)) throw InvalidInput(fmt::format("{}: expected instants that increase", name));
  // Printed instants carry rounding of their own, which grows with the instant and not with the step.
  const double tolerance = 1e-6 * usual + 4e-16 * times.cwiseAbs().maxCoeff();
  for (Eigen::Index j = 0; j < steps.size(); ++j) {
    if (std::abs(steps(j) - usual) <= tolerance) continue;
    const bool gap = steps(j) > 1.5 * usual;
    throw InvalidInput(
        fmt::format("{}: expected equal intervals of {:.9g}, found {:.9g} between samples {} and {}{}; resample it, or "
                    "cut it there",
                    name, usual, steps(j), j, j + 1,
                    gap ? fmt::format(" (a gap of about {:.0f} samples)", steps(j) / usual - 1.0) : ""));
  }
  const double interval = (times(times.size() - 1) - times(0)) / static_cast<double>(steps.size());
  return {.values = values, .interval = interval, .name = std::move(name)};
}

void check_series(const Series& series, Eigen::Index least, const std::string& purpose) {
  const auto& values = series.values;
  if (values.size() < least) {
    throw InvalidInput(
        fmt::format("{} of {}: expected at least {} samples, found {}; use a longer record or ask for less", purpose,
                    series.name, least, values.size()));
  }
  if (const Eigen::Index bad = first_not_finite(values); bad < values.size()) {
    throw InvalidInput(fmt::format("{} of {}: expected finite samples, found {} at sample {}; cut the record there",
                                   purpose, series.name, values(bad), bad));
  }
  if (!(series.interval > 0.0) || !std::isfinite(series.interval)) {
    throw InvalidInput(
        fmt::format("{} of {}: expected a sampling interval > 0, found {}", purpose, series.name, series.interval));
  }
  if (values.size() == 0) return;
  const double range = values.maxCoeff() - values.minCoeff();
  if (!(range > 1e-14 * values.cwiseAbs().maxCoeff())) {
    throw InvalidInput(fmt::format("{} of {}: expected samples that vary, found {} throughout; is it the wrong column?",
                                   purpose, series.name, values(0)));
  }
}

Series part(const Series& series, Eigen::Index begin, Eigen::Index count) {
  if (begin < 0 || count < 0 || begin + count > series.values.size()) {
    throw InvalidInput(fmt::format("part of {}: expected a stretch of its {} samples, found {} from {}", series.name,
                                   series.values.size(), count, begin));
  }
  return {.values = series.values.segment(begin, count),
          .interval = series.interval,
          .name = series.name,
          .unit = series.unit,
          .time_unit = series.time_unit};
}

Series first_half(const Series& series) { return part(series, 0, series.values.size() / 2); }

Series second_half(const Series& series) {
  const Eigen::Index half = series.values.size() / 2;
  return part(series, half, half);
}

Eigen::VectorXd autocorrelation(const Series& series, Eigen::Index max_lag) {
  const Eigen::Index total = series.values.size();
  check_series(series, std::max<Eigen::Index>(2, max_lag + 1), "autocorrelation");
  if (max_lag < 0) throw InvalidInput(fmt::format("autocorrelation: expected a lag of at least 0, found {}", max_lag));
  // Zeros keep the circular sums of the transform from wrapping; a power of two keeps it fast for any T.
  Eigen::Index padded = 1;
  while (padded < total + max_lag) padded *= 2;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(padded);
  x.head(total) = series.values.array() - series.values.mean();
  RealTransform transform(padded);
  const Eigen::VectorXd power = transform.forward(x).cwiseAbs2();
  const Eigen::VectorXd sums = transform.inverse(power.cast<std::complex<double>>());
  return sums.head(max_lag + 1) / sums(0);
}

Eigen::Index decorrelation_lag(const Series& series) {
  const Eigen::VectorXd rho = autocorrelation(series, series.values.size() / 2);
  for (Eigen::Index k = 0; k < rho.size(); ++k) {
    if (rho(k) < std::exp(-1.0)) return k;
  }
  return rho.size() - 1;
}

double mean_period(const Series& series) {
  check_series(series, 2, "mean period");
  const Eigen::ArrayXd x = series.values.array() - series.values.mean();
  const double low = -0.1 * std::sqrt(x.square().mean());
  bool armed = false;
  int crossings = 0;
  for (const double value : x) {
    if (value < low) armed = true;
    if (!armed || value < 0.0) continue;
    ++crossings;
    armed = false;
  }
  const auto total = static_cast<double>(x.size());
  return crossings < 2 ? total : total / crossings;
}

Eigen::Index theiler_window(const Series& series) {
  const auto period = static_cast<Eigen::Index>(std::ceil(mean_period(series)));
  const Eigen::Index most = std::max<Eigen::Index>(1, series.values.size() / 20);
  return std::clamp<Eigen::Index>(std::max(period, decorrelation_lag(series)), 1, most);
}

}  // namespace slipmode::diagnostics
