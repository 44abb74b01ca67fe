#include <slipmode/diagnostics/series/smoothness.hpp>

#include <slipmode/core/median.hpp>

#include <cmath>

namespace slipmode::diagnostics {

namespace {

constexpr Eigen::Index kFlatRun = 6;
constexpr double kFlatStep = 1e-5, kKink = 20.0, kCoarse = 12.0, kFlatShare = 0.02, kKinks = 0.2;

double flat_share(const Eigen::ArrayXd& x, double sigma) {
  Eigen::Index flat = 0, run = 1;
  for (Eigen::Index j = 1; j <= x.size(); ++j) {
    if (j < x.size() && std::abs(x(j) - x(j - 1)) < kFlatStep * sigma) {
      ++run;
      continue;
    }
    if (run >= kFlatRun) flat += run;
    run = 1;
  }
  return static_cast<double>(flat) / static_cast<double>(x.size());
}

int kinks(const Eigen::ArrayXd& x) {
  const Eigen::Index n = x.size() - 2;
  const Eigen::ArrayXd bend = (x.tail(n) - 2.0 * x.segment(1, n) + x.head(n)).abs();
  const double usual = median({bend.begin(), bend.end()});
  int count = 0;
  bool inside = false;
  for (const double b : bend) {
    const bool kink = b > kKink * usual && b > 0.0;
    if (kink && !inside) ++count;
    inside = kink;
  }
  return count;
}

}  // namespace

Smoothness smoothness(const Series& series) {
  check_series(series, 50, "smoothness");
  const Eigen::ArrayXd x = series.values;
  const double period = mean_period(series);
  Smoothness out;
  out.flat_share = flat_share(x, std::sqrt((x - x.mean()).square().mean()));
  out.coarse = period < kCoarse;
  if (!out.coarse) out.kinks_per_period = kinks(x) * period / static_cast<double>(x.size());
  out.doubtful = out.flat_share > kFlatShare || out.kinks_per_period > kKinks;
  return out;
}

}  // namespace slipmode::diagnostics
