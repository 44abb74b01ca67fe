#include <slipmode/diagnostics/series/recurrence.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slipmode::diagnostics {

namespace {

/// Distances of the points j − gap and j, one diagonal of the plot.
Eigen::VectorXd distances_at(const Eigen::MatrixXd& points, Eigen::Index gap, Norm metric) {
  const Eigen::Index count = points.cols() - gap;
  const auto difference = points.rightCols(count) - points.leftCols(count);
  if (metric == Norm::kMaximum) return difference.cwiseAbs().colwise().maxCoeff().transpose();
  return difference.colwise().norm().transpose();
}

/// The distance below which a share `rate` of all pairs at least `first_gap` apart lies.
double radius_of_rate(const Eigen::MatrixXd& points, Eigen::Index first_gap, Norm metric, double rate) {
  const Eigen::Index free = points.cols() - first_gap;
  std::vector<double> all;
  all.reserve(static_cast<std::size_t>(free * (free + 1) / 2));
  for (Eigen::Index gap = first_gap; gap < points.cols(); ++gap) {
    const Eigen::VectorXd d = distances_at(points, gap, metric);
    all.insert(all.end(), d.begin(), d.end());
  }
  const auto place = static_cast<std::ptrdiff_t>(rate * static_cast<double>(all.size() - 1));
  std::nth_element(all.begin(), all.begin() + place, all.end());
  return all[static_cast<std::size_t>(place)];
}

struct DiagonalLines {
  double pairs = 0.0, recurrent = 0.0, on_lines = 0.0, lines = 0.0;
  Eigen::Index longest = 0;

  double determinism() const { return recurrent > 0.0 ? on_lines / recurrent : 0.0; }

  void end(Eigen::Index length, Eigen::Index shortest) {
    longest = std::max(longest, length);
    if (length < shortest) return;
    on_lines += static_cast<double>(length);
    lines += 1.0;
  }
};

/// Counts along the diagonals; `visit(i, j)` is told every recurrent pair.
template <typename Visit>
DiagonalLines count_lines(const Eigen::MatrixXd& points, Eigen::Index first_gap, const RecurrenceOptions& options,
                          const Visit& visit) {
  DiagonalLines out;
  for (Eigen::Index gap = first_gap; gap < points.cols(); ++gap) {
    const Eigen::VectorXd d = distances_at(points, gap, options.metric);
    Eigen::Index run = 0;
    for (Eigen::Index i = 0; i < d.size(); ++i) {
      if (d(i) <= options.radius) {
        visit(i, i + gap);
        ++run;
        continue;
      }
      out.end(run, options.shortest);
      out.recurrent += static_cast<double>(run);
      run = 0;
    }
    out.end(run, options.shortest);
    out.recurrent += static_cast<double>(run);
    out.pairs += static_cast<double>(d.size());
  }
  return out;
}

void check_recurrence(const Series& series, const RecurrenceOptions& options) {
  if (options.embedding.dimension < 1 || options.embedding.lag < 1 || options.stride < 1 || options.points < 0 ||
      options.window < 0 || options.shortest < 2 || !(options.radius >= 0.0) ||
      !(options.rate > 0.0 && options.rate < 1.0)) {
    throw InvalidInput(fmt::format(
        "recurrence of {}: expected dimension, lag, stride ≥ 1, points, window, radius ≥ 0, shortest ≥ 2, 0 < rate < "
        "1; found {}, {}, {}, {}, {}, {}, {}, {}",
        series.name, options.embedding.dimension, options.embedding.lag, options.stride, options.points, options.window,
        options.radius, options.shortest, options.rate));
  }
}

}  // namespace

Recurrence recurrence(const Series& series, const RecurrenceOptions& options) {
  constexpr Eigen::Index kLeast = 100, kMost = 2000;
  check_recurrence(series, options);
  Recurrence out;
  out.settings = options;
  const Eigen::Index stride = options.stride;
  if (out.settings.window == 0) {
    check_series(series, options.embedding.span() + kLeast * stride, "recurrence");
    out.settings.window = theiler_window(series);
  }
  check_series(series, options.embedding.span() + 2 * out.settings.window + kLeast * stride, "recurrence");
  const Eigen::MatrixXd vectors = delay_vectors(series, options.embedding);
  const Eigen::Index available = (vectors.cols() + stride - 1) / stride;
  out.points = std::min(available, options.points > 0 ? options.points : kMost);
  out.interval = series.interval * static_cast<double>(stride);
  const Eigen::MatrixXd points = vectors(Eigen::all, Eigen::seqN(0, out.points, stride));
  const Eigen::Index first_gap = out.settings.window / stride + 1;
  if (2 * first_gap + 2 >= out.points) {
    throw InvalidInput(
        fmt::format("recurrence of {}: expected more than {} points of the plot, found {}; the window "
                    "takes {} of them on each side",
                    series.name, 2 * first_gap + 2, out.points, first_gap));
  }
  if (options.radius == 0.0) {
    out.settings.radius = radius_of_rate(points, first_gap, options.metric, options.rate);
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  const DiagonalLines lines = count_lines(points, first_gap, out.settings, [&](Eigen::Index i, Eigen::Index j) {
    pairs.emplace_back(static_cast<std::int32_t>(j), static_cast<std::int32_t>(i));
  });
  std::sort(pairs.begin(), pairs.end());
  out.pairs.resize(2, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    out.pairs.col(static_cast<Eigen::Index>(k)) << pairs[k].second, pairs[k].first;
  }
  const auto nothing = [](Eigen::Index, Eigen::Index) {};
  const Eigen::Index half = out.points / 2;
  const double early = count_lines(points.leftCols(half), first_gap, out.settings, nothing).determinism();
  const double late = count_lines(points.middleCols(half, half), first_gap, out.settings, nothing).determinism();
  out.rate = lines.recurrent / lines.pairs;
  out.determinism = lines.determinism();
  out.determinism_error = 0.5 * std::abs(early - late);
  out.mean_line = lines.lines > 0.0 ? lines.on_lines / lines.lines : 0.0;
  out.longest = lines.longest;
  return out;
}

}  // namespace slipmode::diagnostics
