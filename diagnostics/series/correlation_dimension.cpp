#include <slipmode/diagnostics/series/correlation_dimension.hpp>

#include <slipmode/core/errors.hpp>
#include "diagnostics/series/internal/close_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace slipmode::diagnostics {

namespace {

CorrelationOptions checked(const Series& series, CorrelationOptions options) {
  const bool fits = options.radii >= 8 && options.smallest > 0.0 && options.largest > options.smallest &&
                    options.window >= 0 && options.references >= 0 && options.least_pairs >= 1.0 &&
                    options.most_share > 0.0 && options.least_decades > 0.0;
  if (!fits) {
    throw InvalidInput(
        fmt::format("correlation dimension: expected radii >= 8, 0 < smallest < largest, window and references >= 0, "
                    "least_pairs >= 1, most_share and least_decades > 0, found {}, {}, {}, {}, {}, {}, {} and {}",
                    options.radii, options.smallest, options.largest, options.window, options.references,
                    options.least_pairs, options.most_share, options.least_decades));
  }
  check_series(series, 2, "correlation dimension");
  if (options.window == 0) options.window = theiler_window(series);
  check_series(series, options.embedding.span() + 2 * options.window + 500,
               fmt::format("correlation dimension in dimension {}", options.embedding.dimension));
  return options;
}

/// One by one: what Eigen takes several at a time it rounds otherwise than the rest, and how many is the processor's
/// affair.
Eigen::VectorXd logarithm(const Eigen::VectorXd& x) {
  return x.unaryExpr([](double value) { return std::log(value); });
}

Eigen::VectorXd local_slopes(const Eigen::VectorXd& log_radius, const Eigen::VectorXd& log_sum) {
  const Eigen::Index n = log_radius.size();
  Eigen::VectorXd slopes(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index begin = std::max<Eigen::Index>(0, k - 2), end = std::min(n, k + 3);
    const bool known = std::isfinite(log_sum(begin));
    slopes(k) = known ? fit_line(log_radius, log_sum, begin, end).slope : std::numeric_limits<double>::quiet_NaN();
  }
  return slopes;
}

/// Pairs of all references with points outside the window.
double allowed_pairs(Eigen::Index points, Eigen::Index window, Eigen::Index references) {
  double pairs = 0.0;
  for (Eigen::Index r = 0; r < references; ++r) {
    const Eigen::Index i = r * points / references;
    const Eigen::Index inside = std::min(points - 1, i + window) - std::max<Eigen::Index>(0, i - window) + 1;
    pairs += static_cast<double>(points - inside);
  }
  return pairs;
}

}  // namespace

CorrelationDimension correlation_dimension(const Series& series, const CorrelationOptions& options) {
  CorrelationDimension out;
  out.settings = checked(series, options);
  const auto& settings = out.settings;
  const Eigen::MatrixXd points = delay_vectors(series, settings.embedding);
  out.references = settings.references == 0 ? points.cols() : std::min(settings.references, points.cols());
  const double range = series.values.maxCoeff() - series.values.minCoeff();
  const Eigen::VectorXd log_radius = Eigen::VectorXd::LinSpaced(settings.radii, std::log(settings.smallest * range),
                                                                std::log(settings.largest * range));
  out.radius = log_radius.unaryExpr([](double x) { return std::exp(x); });
  const std::vector<double> radii(out.radius.begin(), out.radius.end());

  constexpr Eigen::Index kBlocks = 64;  // even, so that the halves of the references are whole blocks
  const ClosePairs pairs = close_pairs(
      points, radii, {.window = settings.window, .references = out.references, .blocks = kBlocks, .run = settings.run});
  const Eigen::VectorXd of_half[2] = {pairs.counts.leftCols(kBlocks / 2).rowwise().sum().cast<double>(),
                                      pairs.counts.rightCols(kBlocks / 2).rowwise().sum().cast<double>()};
  const Eigen::VectorXd close = of_half[0] + of_half[1];
  out.C = close / allowed_pairs(points.cols(), settings.window, out.references);
  const Eigen::VectorXd log_sum = logarithm(out.C);
  out.local_slope = local_slopes(log_radius, log_sum);

  Eigen::Index begin = 0, end = settings.radii;
  while (begin < end && close(begin) < settings.least_pairs) ++begin;
  while (end > begin && out.C(end - 1) > settings.most_share) --end;
  const RegionOptions region{.least_rise = 0.05, .least_width = settings.least_decades * std::numbers::ln10};
  if (end - begin < region.least_points || log_radius(end - 1) - log_radius(begin) < region.least_width) {
    throw NumericalFailure(
        fmt::format(
            "correlation dimension of {}: expected at least {} radii over {} decades with {} pairs or more and a "
            "share of pairs of at most {}, found {} over {:.2g}; use a longer record, a lower dimension or more radii",
            series.name, region.least_points, settings.least_decades, settings.least_pairs, settings.most_share,
            end - begin, end > begin ? (log_radius(end - 1) - log_radius(begin)) / std::numbers::ln10 : 0.0),
        std::numeric_limits<double>::quiet_NaN(), {}, std::numeric_limits<double>::quiet_NaN());
  }
  const LinearFit local =
      linear_region(log_radius.segment(begin, end - begin), log_sum.segment(begin, end - begin), region);
  out.plateau = fit_line(log_radius, log_sum, begin + local.begin, begin + local.end);
  out.dimension = out.plateau.slope;
  for (const int h : {0, 1}) {
    const Eigen::VectorXd half = of_half[h].cwiseMax(0.5);
    out.of_halves[h] = fit_line(log_radius, logarithm(half), out.plateau.begin, out.plateau.end).slope;
  }
  out.error = std::hypot(0.5 * (out.of_halves[0] - out.of_halves[1]), out.plateau.curvature);
  return out;
}

}  // namespace slipmode::diagnostics
