#include <slipmode/diagnostics/series/mutual_information.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace slipmode::diagnostics {

namespace {

/// Bin of each sample, 0 … bins − 1.
std::vector<int> binned(const Eigen::VectorXd& values, const InformationOptions& options) {
  const auto count = static_cast<std::size_t>(values.size());
  std::vector<int> bin(count);
  if (options.estimator == InformationEstimator::kEqualWidth) {
    const double low = values.minCoeff(), range = values.maxCoeff() - low;
    for (std::size_t j = 0; j < count; ++j) {
      const double place = (values(static_cast<Eigen::Index>(j)) - low) / range * options.bins;
      bin[j] = std::min(static_cast<int>(place), options.bins - 1);
    }
    return bin;
  }
  // A sample's bin is that of the lowest rank among its equals: equal samples must not be told apart.
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t j = 0; j < count; ++j) {
    const auto rank = static_cast<std::size_t>(
        std::lower_bound(sorted.begin(), sorted.end(), values(static_cast<Eigen::Index>(j))) - sorted.begin());
    bin[j] = static_cast<int>(rank * static_cast<std::size_t>(options.bins) / count);
  }
  return bin;
}

double binned_information(const std::vector<int>& bin, int bins, std::size_t lag) {
  const auto width = static_cast<std::size_t>(bins);
  std::vector<double> joint(width * width, 0.0), first(width, 0.0), second(width, 0.0);
  const std::size_t pairs = bin.size() - lag;
  for (std::size_t n = 0; n < pairs; ++n) {
    const auto a = static_cast<std::size_t>(bin[n]), b = static_cast<std::size_t>(bin[n + lag]);
    joint[a * width + b] += 1.0;
    first[a] += 1.0;
    second[b] += 1.0;
  }
  double sum = 0.0;
  for (std::size_t a = 0; a < width; ++a) {
    for (std::size_t b = 0; b < width; ++b) {
      const double both = joint[a * width + b];
      if (both > 0.0) sum += both * std::log2(both * static_cast<double>(pairs) / (first[a] * second[b]));
    }
  }
  return sum / static_cast<double>(pairs);
}

/// ψ(n) for n = 0 … most (ψ(0) unused): −γ + Σ_{k<n} 1/k.
std::vector<double> digamma_table(std::size_t most) {
  std::vector<double> psi(most + 1, -std::numbers::egamma);
  for (std::size_t n = 2; n <= most; ++n) psi[n] = psi[n - 1] + 1.0 / static_cast<double>(n - 1);
  return psi;
}

/// How many of `sorted` lie no farther than `reach` from x, without x itself.
std::size_t count_within(const std::vector<double>& sorted, double x, double reach) {
  const auto low = std::lower_bound(sorted.begin(), sorted.end(), x - reach);
  const auto high = std::upper_bound(sorted.begin(), sorted.end(), x + reach);
  return std::max<std::size_t>(1, static_cast<std::size_t>(high - low) - 1);
}

double nearest_information(const Eigen::VectorXd& values, Eigen::Index lag, int k) {
  const Eigen::Index pairs = values.size() - lag;
  Eigen::MatrixXd points(2, pairs);
  points.row(0) = values.head(pairs).transpose();
  points.row(1) = values.tail(pairs).transpose();
  const NeighbourTree tree(points, Norm::kMaximum);
  std::vector<double> x(points.row(0).begin(), points.row(0).end()), y(points.row(1).begin(), points.row(1).end());
  std::sort(x.begin(), x.end());
  std::sort(y.begin(), y.end());
  const std::vector<double> psi = digamma_table(static_cast<std::size_t>(pairs));
  double sum = 0.0;
  for (Eigen::Index i = 0; i < pairs; ++i) {
    Eigen::Vector2d reach = Eigen::Vector2d::Zero();
    for (const Neighbour& near : tree.nearest(i, static_cast<std::size_t>(k), {})) {
      reach = reach.cwiseMax((points.col(near.index) - points.col(i)).cwiseAbs());
    }
    sum += psi[count_within(x, points(0, i), reach(0))] + psi[count_within(y, points(1, i), reach(1))];
  }
  const double nats = psi[static_cast<std::size_t>(k)] - 1.0 / k - sum / static_cast<double>(pairs) +
                      psi[static_cast<std::size_t>(pairs)];
  return nats / std::numbers::ln2;
}

Eigen::VectorXd information(const Eigen::VectorXd& values, const InformationOptions& options) {
  Eigen::VectorXd bits(options.max_lag + 1);
  const bool bin_free = options.estimator == InformationEstimator::kNearest;
  const std::vector<int> bin = bin_free ? std::vector<int>{} : binned(values, options);
  rethrow_first(parallel_for(static_cast<std::size_t>(bits.size()), options.run, [&](std::size_t lag) {
    const auto at = static_cast<Eigen::Index>(lag);
    if (!bin_free) {
      bits(at) = binned_information(bin, options.bins, lag);
    } else {
      bits(at) =
          lag == 0 ? std::numeric_limits<double>::quiet_NaN() : nearest_information(values, at, options.neighbours);
    }
  }));
  return bits;
}

Eigen::Index first_minimum(const Eigen::VectorXd& bits, double rise) {
  Eigen::Index lowest = 1;
  for (Eigen::Index lag = 2; lag < bits.size(); ++lag) {
    if (bits(lag) < bits(lowest)) lowest = lag;
    if (bits(lag) > bits(lowest) + rise) return lowest;
  }
  return -1;
}

}  // namespace

MutualInformation mutual_information(const Series& series, const InformationOptions& options) {
  if (options.max_lag < 2 || options.bins < 2 || options.neighbours < 1) {
    throw InvalidInput(
        fmt::format("mutual information: expected max_lag >= 2, bins >= 2 and neighbours >= 1, found {}, {} and {}",
                    options.max_lag, options.bins, options.neighbours));
  }
  const Eigen::Index per_half = options.max_lag + 10 * std::max(options.bins, options.neighbours);
  check_series(series, 2 * per_half, fmt::format("mutual information up to lag {}", options.max_lag));
  const Series halves[2] = {first_half(series), second_half(series)};
  for (const Series& half : halves) check_series(half, per_half, "mutual information of half the record");
  MutualInformation out{.bits = information(series.values, options), .settings = options};
  const Eigen::VectorXd of_halves[2] = {information(halves[0].values, options), information(halves[1].values, options)};
  const Eigen::VectorXd difference = (of_halves[0] - of_halves[1]).tail(options.max_lag);
  out.error = 0.5 * std::sqrt(difference.squaredNorm() / static_cast<double>(options.max_lag));
  // The halves differ in level, which moves no minimum; what counts is how far they differ from one lag to the next.
  const Eigen::VectorXd change = difference.tail(options.max_lag - 1) - difference.head(options.max_lag - 1);
  out.rise = std::sqrt(change.squaredNorm() / static_cast<double>(change.size()));
  out.first_minimum = first_minimum(out.bits, out.rise);
  for (int h = 0; h < 2; ++h) out.first_minimum_of_halves[h] = first_minimum(of_halves[h], out.rise);
  return out;
}

}  // namespace slipmode::diagnostics
