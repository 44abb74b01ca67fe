#include <slipmode/diagnostics/series/false_neighbours.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace slipmode::diagnostics {

namespace {

FalseNeighbourOptions checked(const Series& series, FalseNeighbourOptions options) {
  if (options.lag < 1 || options.max_dimension < 1 || options.window < 0 || !(options.ratio > 0.0) ||
      !(options.size > 0.0) || !(options.resolution > 0.0) || options.references < 0) {
    throw InvalidInput(
        fmt::format("false neighbours: expected lag and max_dimension >= 1, ratio, size and resolution > 0, window and "
                    "references >= 0, found {}, {}, {}, {}, {}, {} and {}",
                    options.lag, options.max_dimension, options.ratio, options.size, options.resolution, options.window,
                    options.references));
  }
  check_series(series, 2, "false neighbours");
  if (options.window == 0) options.window = theiler_window(series);
  // Cao's averages look two coordinates ahead of the last dimension.
  check_series(series, (options.max_dimension + 1) * options.lag + 2 * options.window + 100,
               fmt::format("false neighbours up to dimension {} at lag {}", options.max_dimension, options.lag));
  return options;
}

double deviation(const Eigen::VectorXd& x) { return std::sqrt((x.array() - x.mean()).square().mean()); }

/// What the next coordinate does to a point and its nearest neighbour.
struct Step {
  double distance;  // in dimension d, at least the resolution
  double added;     // along coordinate d + 1
};

/// One step per reference, in time order.
std::vector<Step> steps(const Series& series, int dimension, Norm metric, const FalseNeighbourOptions& options) {
  const Eigen::Index shift = dimension * options.lag;
  const Series known = part(series, 0, series.values.size() - options.lag);
  const NeighbourTree tree(delay_vectors(known, {.dimension = dimension, .lag = options.lag}), metric);
  const Eigen::Index count = options.references == 0 ? tree.size() : std::min(options.references, tree.size());
  const double floor = options.resolution * deviation(series.values);
  std::vector<Step> out(static_cast<std::size_t>(count));
  constexpr std::size_t kChunk = 256;
  rethrow_first(parallel_for((out.size() + kChunk - 1) / kChunk, options.run, [&](std::size_t block) {
    for (std::size_t r = block * kChunk; r < std::min(out.size(), (block + 1) * kChunk); ++r) {
      const Eigen::Index i = static_cast<Eigen::Index>(r) * tree.size() / count;
      const Neighbour near = tree.nearest(i, 1, {.window = options.window}).front();
      out[r] = {.distance = std::max(near.distance, floor),
                .added = std::abs(series.values(i + shift) - series.values(near.index + shift))};
    }
  }));
  return out;
}

/// Mean of a figure over all references and over each half of them.
struct Mean {
  double all = 0.0, error = 0.0;
};

Mean mean(const std::vector<Step>& of, const std::function<double(const Step&)>& figure) {
  const std::size_t half = of.size() / 2;
  double sums[2] = {0.0, 0.0};
  for (std::size_t r = 0; r < of.size(); ++r) sums[r < half ? 0 : 1] += figure(of[r]);
  const double first = sums[0] / static_cast<double>(half), second = sums[1] / static_cast<double>(of.size() - half);
  return {(sums[0] + sums[1]) / static_cast<double>(of.size()), 0.5 * std::abs(first - second)};
}

}  // namespace

FalseNeighbours false_neighbours(const Series& series, const FalseNeighbourOptions& options) {
  FalseNeighbours out;
  out.settings = checked(series, options);
  const auto& settings = out.settings;
  const double sigma = deviation(series.values);
  const auto far_by_ratio = [&](const Step& s) { return s.added > settings.ratio * s.distance; };
  const auto far_by_size = [&](const Step& s) { return std::hypot(s.distance, s.added) > settings.size * sigma; };
  for (auto* shares : {&out.by_ratio, &out.by_size, &out.share, &out.error}) shares->resize(settings.max_dimension);
  for (int d = 1; d <= settings.max_dimension; ++d) {
    const std::vector<Step> of = steps(series, d, Norm::kEuclidean, settings);
    const Mean either = mean(of, [&](const Step& s) { return far_by_ratio(s) || far_by_size(s) ? 1.0 : 0.0; });
    out.by_ratio(d - 1) = mean(of, [&](const Step& s) { return far_by_ratio(s) ? 1.0 : 0.0; }).all;
    out.by_size(d - 1) = mean(of, [&](const Step& s) { return far_by_size(s) ? 1.0 : 0.0; }).all;
    out.share(d - 1) = either.all;
    out.error(d - 1) = either.error;
    out.references = static_cast<Eigen::Index>(of.size());
    if (out.dimension == 0 && either.all <= settings.accepted) out.dimension = d;
  }
  return out;
}

CaoAverages cao_averages(const Series& series, const FalseNeighbourOptions& options) {
  CaoAverages out;
  out.settings = checked(series, options);
  const int dimensions = out.settings.max_dimension;
  std::vector<Mean> E, added;
  for (int d = 1; d <= dimensions + 1; ++d) {
    const std::vector<Step> of = steps(series, d, Norm::kMaximum, out.settings);
    E.push_back(mean(of, [](const Step& s) { return std::max(s.distance, s.added) / s.distance; }));
    added.push_back(mean(of, [](const Step& s) { return s.added; }));
    out.references = static_cast<Eigen::Index>(of.size());
  }
  const auto ratios = [dimensions](const std::vector<Mean>& means, Eigen::VectorXd& out_ratio,
                                   Eigen::VectorXd& out_error) {
    out_ratio.resize(dimensions);
    out_error.resize(dimensions);
    for (int d = 0; d < dimensions; ++d) {
      const Mean& low = means[static_cast<std::size_t>(d)];
      const Mean& high = means[static_cast<std::size_t>(d) + 1];
      out_ratio(d) = high.all / low.all;
      out_error(d) = out_ratio(d) * std::hypot(high.error / high.all, low.error / low.all);
    }
  };
  ratios(E, out.E1, out.E1_error);
  ratios(added, out.E2, out.E2_error);
  return out;
}

}  // namespace slipmode::diagnostics
