#include <slipmode/diagnostics/series/linear_region.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace slipmode::diagnostics {

namespace {

struct Line {
  double slope, intercept, residual;
};

/// Sums term by term: Eigen's are taken in an order that depends on the width of the processor's vectors.
Line line_through(const Eigen::VectorXd& x, const Eigen::VectorXd& y, Eigen::Index begin, Eigen::Index count) {
  const auto sum = [&](const auto& term) {
    double value = 0.0;
    for (Eigen::Index k = begin; k < begin + count; ++k) value += term(x(k), y(k));
    return value;
  };
  const auto n = static_cast<double>(count);
  const double x_mean = sum([](double a, double) { return a; }) / n,
               y_mean = sum([](double, double b) { return b; }) / n;
  const double slope = sum([&](double a, double b) { return (a - x_mean) * (b - y_mean); }) /
                       sum([&](double a, double) { return (a - x_mean) * (a - x_mean); });
  const double intercept = y_mean - slope * x_mean;
  const double square = sum([&](double a, double b) {
    const double miss = b - slope * a - intercept;
    return miss * miss;
  });
  return {slope, intercept, std::sqrt(square / n)};
}

}  // namespace

LinearFit fit_line(const Eigen::VectorXd& x, const Eigen::VectorXd& y, Eigen::Index begin, Eigen::Index end) {
  if (x.size() != y.size() || begin < 0 || end > x.size() || end - begin < 2) {
    throw InvalidInput(fmt::format("line: expected at least 2 of {} points, as many x as y ({}), found {} to {}",
                                   x.size(), y.size(), begin, end));
  }
  const Eigen::Index count = end - begin, half = (count + 1) / 2;
  const Line line = line_through(x, y, begin, count);
  LinearFit fit{
      .begin = begin, .end = end, .slope = line.slope, .intercept = line.intercept, .residual = line.residual};
  if (half >= 2) {
    fit.curvature = 0.5 * std::abs(line_through(x, y, begin, half).slope - line_through(x, y, end - half, half).slope);
  }
  return fit;
}

LinearFit linear_region(const Eigen::VectorXd& x, const Eigen::VectorXd& y, const RegionOptions& options) {
  if (options.least_points < 3 || !(options.least_rise > 0.0) || options.least_rise > 1.0 ||
      !(options.least_width >= 0.0)) {
    throw InvalidInput(fmt::format(
        "linear region: expected least_points >= 3, 0 < least_rise <= 1 and least_width >= 0, found {}, {} and {}",
        options.least_points, options.least_rise, options.least_width));
  }
  const Eigen::Index n = y.size();
  if (x.size() != n || n < options.least_points) {
    throw InvalidInput(fmt::format("linear region: expected at least {} points, as many x as y, found {} and {}",
                                   options.least_points, x.size(), n));
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (!y.allFinite()) throw NumericalFailure("linear region: the curve is not finite", nan, y, nan);
  const double rise = y.maxCoeff() - y.minCoeff();
  Eigen::Index best_begin = -1, best_count = 0;
  double best = std::numeric_limits<double>::infinity();
  for (Eigen::Index begin = 0; begin < n; ++begin) {
    for (Eigen::Index count = options.least_points; begin + count <= n; ++count) {
      const double width = x(begin + count - 1) - x(begin);
      if (width < options.least_width) continue;
      const Line line = line_through(x, y, begin, count);
      const double covered = std::abs(line.slope) * width;
      if (!(covered >= options.least_rise * rise) || !(covered > 0.0)) continue;
      if (const double relative = line.residual / covered; relative < best) {
        best = relative;
        best_begin = begin;
        best_count = count;
      }
    }
  }
  if (best_begin < 0) {
    throw NumericalFailure(
        fmt::format("linear region: no stretch of {} points covers {:.0f} % of the rise and a width of {:.4g}; lower "
                    "them or lengthen the curve",
                    options.least_points, 100.0 * options.least_rise, options.least_width),
        nan, y, rise);
  }
  return fit_line(x, y, best_begin, best_begin + best_count);
}

}  // namespace slipmode::diagnostics
