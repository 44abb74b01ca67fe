#include "bench/series_cases.hpp"

#include <slipmode/diagnostics/series/correlation_dimension.hpp>
#include <slipmode/diagnostics/series/false_neighbours.hpp>
#include <slipmode/diagnostics/series/series.hpp>
#include "bench/clock.hpp"
#include "fixtures/test_series.hpp"

#include <fmt/format.h>
#include <cmath>
#include <limits>

namespace slipmode::bench {
namespace {

constexpr int kLargestDimension = 10, kCorrelationDimension = 6;
constexpr int kThreads = 2;

/// Every pair, straight from the record: no tree, no delay vectors in memory; loops the compiler turns into vectors.
struct AllPairs {
  const Eigen::VectorXd& s;
  Eigen::Index lag, window;
  Eigen::Index stride;  ///< every stride-th point is a reference; times are scaled up by it

  /// Share of false neighbours by dimension, both criteria.
  [[nodiscard]] Eigen::VectorXd false_shares(double ratio, double size) const {
    const double sigma = std::sqrt((s.array() - s.mean()).square().mean());
    Eigen::VectorXd shares(kLargestDimension);
    for (int d = 1; d <= kLargestDimension; ++d) {
      const Eigen::Index points = s.size() - d * lag;
      const auto count = static_cast<std::size_t>((points + stride - 1) / stride);
      std::vector<char> is_false(count);
      rethrow_first(parallel_for(count, {.threads = kThreads}, [&](std::size_t r) {
        const Eigen::Index i = static_cast<Eigen::Index>(r) * stride;
        Eigen::ArrayXd square = (s.head(points).array() - s(i)).square();
        for (int k = 1; k < d; ++k) square += (s.segment(k * lag, points).array() - s(i + k * lag)).square();
        const Eigen::Index from = std::max<Eigen::Index>(i - window, 0), to = std::min(i + window + 1, points);
        square.segment(from, to - from).setConstant(std::numeric_limits<double>::infinity());
        Eigen::Index j = 0;
        const double distance = std::sqrt(square.minCoeff(&j)), next = std::abs(s(i + d * lag) - s(j + d * lag));
        is_false[r] = next > ratio * distance || std::hypot(distance, next) > size * sigma;
      }));
      double sum = 0.0;
      for (const char one : is_false) sum += one;
      shares(d - 1) = sum / static_cast<double>(count);
    }
    return shares;
  }

  /// Share of the pairs within each radius.
  [[nodiscard]] Eigen::VectorXd correlation_sum(const Eigen::VectorXd& radius) const {
    const Eigen::Index points = s.size() - (kCorrelationDimension - 1) * lag;
    const auto count = static_cast<std::size_t>((points + stride - 1) / stride);
    Eigen::MatrixXd within(radius.size(), count);
    Eigen::VectorXd pairs(count);
    rethrow_first(parallel_for(count, {.threads = kThreads}, [&](std::size_t r) {
      const Eigen::Index i = static_cast<Eigen::Index>(r) * stride, column = static_cast<Eigen::Index>(r);
      Eigen::ArrayXd distance = (s.head(points).array() - s(i)).abs();
      for (int k = 1; k < kCorrelationDimension; ++k)
        distance = distance.max((s.segment(k * lag, points).array() - s(i + k * lag)).abs());
      const Eigen::Index from = std::max<Eigen::Index>(i - window, 0), to = std::min(i + window + 1, points);
      distance.segment(from, to - from).setConstant(std::numeric_limits<double>::infinity());
      for (Eigen::Index k = 0; k < radius.size(); ++k)
        within(k, column) = static_cast<double>((distance <= radius(k)).count());
      pairs(column) = static_cast<double>(points - (to - from));
    }));
    return within.rowwise().sum() / pairs.sum();
  }
};

struct Measured {
  double seconds = 0.0;  ///< on the clock
  double cpu_seconds = 0.0, all_pairs_cpu_seconds = 0.0;
  double apart = 0.0;

  /// Times slipmode.
  template <class Work>
  void time(const Work& work) {
    const double begin = wall_seconds(), cpu_begin = process_seconds();
    work();
    seconds = wall_seconds() - begin;
    cpu_seconds = process_seconds() - cpu_begin;
  }
  /// Times the peer on every stride-th reference.
  template <class Work>
  void time_all_pairs(Eigen::Index stride, const Work& work) {
    const double begin = process_seconds();
    work();
    all_pairs_cpu_seconds = (process_seconds() - begin) * static_cast<double>(stride);
  }
};

void add(Row& row, const std::string& series, const std::string& tool, double wanted, const Measured& t) {
  row.lines.push_back(fmt::format("{:>10} {:>28} {:>12.2f} {:>8.2f} {:>12.0f} {:>8.1f} {:>8} {:>10.1e}", series, tool,
                                  t.seconds, t.cpu_seconds, t.all_pairs_cpu_seconds,
                                  t.all_pairs_cpu_seconds / t.cpu_seconds, wanted, t.apart));
  const std::string name = series + "_" + (tool.starts_with("false") ? "false_neighbours" : "correlation_sum");
  row.figures.emplace_back(name + "_s", t.seconds);
  row.figures.emplace_back(name + "_cpu_s", t.cpu_seconds);
  row.figures.emplace_back(name + "_all_pairs_cpu_s", t.all_pairs_cpu_seconds);
  row.figures.emplace_back(name + "_ratio", t.all_pairs_cpu_seconds / t.cpu_seconds);
  row.timed.push_back(
      {.name = fmt::format("{} {}", series, tool.substr(0, tool.find(','))), .ms = 1e3 * t.cpu_seconds});
}

}  // namespace

Row measure_series(bool quick) {
  Row row;
  row.lines.push_back(fmt::format("{:>10} {:>28} {:>12} {:>8} {:>12} {:>8} {:>8} {:>10}", "series", "tool",
                                  "slipmode s", "CPU s", "all pairs", "ratio", "wanted s", "apart"));
  const Eigen::Index count = quick ? 10000 : 100000, lag = 3, stride = quick ? 10 : 100;
  for (const bool noise : {false, true}) {
    const diagnostics::Series series = noise ? fixtures::white_noise(count, 1) : fixtures::lorenz(count, 0.05);
    const Eigen::Index window = diagnostics::theiler_window(series);
    const AllPairs all_pairs{series.values, lag, window, stride};
    const std::string name = noise ? "noise" : "lorenz";

    Measured shares;
    diagnostics::FalseNeighbours kennel;
    shares.time([&] {
      kennel = diagnostics::false_neighbours(
          series, {.lag = lag, .max_dimension = kLargestDimension, .references = 0, .run = {.threads = kThreads}});
    });
    Eigen::VectorXd expected;
    shares.time_all_pairs(stride,
                          [&] { expected = all_pairs.false_shares(kennel.settings.ratio, kennel.settings.size); });
    shares.apart = (kennel.share - expected).cwiseAbs().maxCoeff();
    add(row, name, fmt::format("false neighbours, d = 1..{}", kLargestDimension), 10, shares);

    Measured sums;
    diagnostics::CorrelationDimension correlation;
    sums.time([&] {
      correlation = diagnostics::correlation_dimension(
          series, {.embedding = {.dimension = kCorrelationDimension, .lag = lag},
                   .references = 0,
                   .least_decades = 0.5,  // the sum is what is timed; few samples of noise have no more to fit
                   .run = {.threads = kThreads}});
    });
    Eigen::VectorXd counted;
    sums.time_all_pairs(stride, [&] { counted = all_pairs.correlation_sum(correlation.radius); });
    sums.apart = (correlation.C - counted).cwiseAbs().maxCoeff();
    add(row, name, fmt::format("correlation sum, d = {}", kCorrelationDimension), 20, sums);
  }
  return row;
}

}  // namespace slipmode::bench
