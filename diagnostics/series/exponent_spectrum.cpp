#include <slipmode/diagnostics/series/exponent_spectrum.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/kaplan_yorke.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>
#include "diagnostics/series/internal/stretches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

namespace slipmode::diagnostics {

namespace {

constexpr Eigen::Index kLeastSteps = 100;

SpectrumOptions checked(const Series& series, SpectrumOptions options) {
  if (options.neighbours < 2 * options.embedding.dimension || options.window < 0) {
    throw InvalidInput(
        fmt::format("exponent spectrum: expected at least {} neighbours in dimension {} and a window >= 0, "
                    "found {} and {}",
                    2 * options.embedding.dimension, options.embedding.dimension, options.neighbours, options.window));
  }
  check_series(series, 2, "exponent spectrum");
  if (options.window == 0) options.window = theiler_window(series);
  check_series(
      series,
      options.embedding.span() + options.embedding.lag * (kLeastSteps + 1) + 2 * options.window + options.neighbours,
      fmt::format("exponent spectrum in dimension {}", options.embedding.dimension));
  return options;
}

/// Slopes of the sample `ahead` of a point with its coordinates, fitted to the points near point i.
Eigen::VectorXd slopes(const NeighbourTree& tree, const Eigen::VectorXd& values, Eigen::Index i, Eigen::Index ahead,
                       const SpectrumOptions& options) {
  const auto near = tree.nearest(i, static_cast<std::size_t>(options.neighbours), {.window = options.window});
  const auto count = static_cast<Eigen::Index>(near.size());
  const auto& points = tree.points();
  Eigen::MatrixXd from(count, points.rows());
  Eigen::VectorXd to(count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const Eigen::Index j = near[static_cast<std::size_t>(n)].index;
    from.row(n) = (points.col(j) - points.col(i)).transpose();
    to(n) = values(j + ahead) - values(i + ahead);
  }
  // Without their means, so that a constant is fitted too: curvature must not tilt the slopes.
  from.rowwise() -= from.colwise().mean().eval();
  to.array() -= to.mean();
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(from).solve(to);
}

}  // namespace

ExponentSpectrum exponent_spectrum(const Series& series, const SpectrumOptions& options) {
  ExponentSpectrum out;
  out.settings = checked(series, options);
  const auto& settings = out.settings;
  const int d = settings.embedding.dimension;
  const Eigen::Index lag = settings.embedding.lag;
  const Series known = part(series, 0, series.values.size() - lag);
  const NeighbourTree tree(delay_vectors(known, settings.embedding), Norm::kEuclidean);
  out.steps = (tree.size() - 1) / lag + 1;
  out.steps -= out.steps % kStretches;
  Eigen::MatrixXd rows(d, out.steps);
  constexpr Eigen::Index kBlock = 64;
  rethrow_first(
      parallel_for(static_cast<std::size_t>((out.steps + kBlock - 1) / kBlock), settings.run, [&](std::size_t b) {
        const auto begin = static_cast<Eigen::Index>(b) * kBlock;
        for (Eigen::Index n = begin; n < std::min(out.steps, begin + kBlock); ++n) {
          rows.col(n) = slopes(tree, series.values, n * lag, d * lag, settings);
        }
      }));
  Eigen::MatrixXd frame = Eigen::MatrixXd::Identity(d, d), jacobian = Eigen::MatrixXd::Zero(d, d);
  jacobian.topRightCorner(d - 1, d - 1).setIdentity();
  const Eigen::Index stretch = out.steps / kStretches;
  Eigen::MatrixXd growth = Eigen::MatrixXd::Zero(d, kStretches);
  for (Eigen::Index n = 0; n < out.steps; ++n) {
    jacobian.bottomRows(1) = rows.col(n).transpose();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian * frame);
    frame = qr.householderQ();
    growth.col(n / stretch) += qr.matrixQR().diagonal().cwiseAbs().array().log().matrix();
  }
  growth /= static_cast<double>(stretch * lag) * series.interval;
  const Eigen::VectorXd mean = growth.rowwise().mean();
  const Eigen::VectorXd error = standard_error(growth);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(d));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return mean(a) > mean(b); });
  out.exponents = mean(order);
  out.error = error(order);
  out.dimension = kaplan_yorke_dimension(out.exponents);
  return out;
}

}  // namespace slipmode::diagnostics
