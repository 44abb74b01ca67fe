#include <slipmode/diagnostics/series/surrogates.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>
#include "diagnostics/series/internal/fourier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace slipmode::diagnostics {

namespace {

std::vector<Eigen::Index> order_of(const Eigen::VectorXd& values) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return values(a) < values(b); });
  return order;
}

/// The samples `sorted` in the order of ranks of `like`.
Eigen::VectorXd reordered(const Eigen::VectorXd& sorted, const Eigen::VectorXd& like) {
  Eigen::VectorXd out(sorted.size());
  Eigen::Index rank = 0;
  for (const Eigen::Index at : order_of(like)) out(at) = sorted(rank++);
  return out;
}

Eigen::VectorXd with_random_phases(const Eigen::VectorXd& values, RealTransform& transform, Random& random) {
  Eigen::VectorXcd spectrum = transform.forward(values);
  // The mean, and the alternation of an even length, have no phase.
  const Eigen::Index last = values.size() % 2 == 0 ? spectrum.size() - 1 : spectrum.size();
  for (Eigen::Index k = 1; k < last; ++k) {
    spectrum(k) = std::polar(std::abs(spectrum(k)), 2.0 * std::numbers::pi * random.uniform());
  }
  return transform.inverse(spectrum);
}

Eigen::VectorXd amplitude_adjusted(const Eigen::VectorXd& values, const Eigen::VectorXd& sorted,
                                   RealTransform& transform, Random& random) {
  Eigen::VectorXd normal(values.size());
  for (double& x : normal) x = random.normal();
  std::sort(normal.begin(), normal.end());
  return reordered(sorted, with_random_phases(reordered(normal, values), transform, random));
}

Eigen::VectorXd iterated(const Eigen::VectorXd& values, const Eigen::VectorXd& sorted, RealTransform& transform,
                         Random& random) {
  constexpr int kMost = 100;
  const Eigen::VectorXd amplitude = transform.forward(values).cwiseAbs();
  Eigen::VectorXd x = values;
  for (Eigen::Index j = x.size() - 1; j > 0; --j) {
    std::swap(x(j), x(static_cast<Eigen::Index>(random.uniform() * static_cast<double>(j + 1))));
  }
  for (int iteration = 0; iteration < kMost; ++iteration) {
    Eigen::VectorXcd spectrum = transform.forward(x);
    for (Eigen::Index k = 0; k < spectrum.size(); ++k) {
      spectrum(k) = std::polar(amplitude(k), std::arg(spectrum(k)));
    }
    Eigen::VectorXd next = reordered(sorted, transform.inverse(spectrum));
    const bool settled = next == x;
    x = std::move(next);
    if (settled) break;
  }
  return x;
}

}  // namespace

Series surrogate(const Series& series, SurrogateKind kind, Random& random) {
  constexpr Eigen::Index kLeast = 16;
  check_series(series, kLeast, "surrogate");
  Series out = part(series, 0, series.values.size());
  RealTransform transform(series.values.size());
  Eigen::VectorXd sorted = series.values;
  std::sort(sorted.begin(), sorted.end());
  switch (kind) {
    case SurrogateKind::kPhase:
      out.values = with_random_phases(series.values, transform, random);
      break;
    case SurrogateKind::kAmplitude:
      out.values = amplitude_adjusted(series.values, sorted, transform, random);
      break;
    case SurrogateKind::kIterated:
      out.values = iterated(series.values, sorted, transform, random);
      break;
  }
  return out;
}

double forecast_error(const Series& series, const Embedding& embedding, Eigen::Index ahead, Eigen::Index window,
                      Eigen::Index references) {
  constexpr std::size_t kNeighbours = 5;
  if (ahead < 1 || window < 0 || references < 1) {
    throw InvalidInput(
        fmt::format("forecast: expected ahead and references >= 1 and a window >= 0, found {}, {} and {}", ahead,
                    references, window));
  }
  check_series(series, embedding.span() + ahead + 2 * window + 100, "forecast");
  const NeighbourTree tree(delay_vectors(part(series, 0, series.values.size() - ahead), embedding), Norm::kEuclidean);
  const Eigen::Index shift = embedding.span() + ahead, count = std::min(references, tree.size());
  double sum = 0.0;
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Index i = r * tree.size() / count;
    double forecast = 0.0;
    for (const Neighbour& n : tree.nearest(i, kNeighbours, {.window = window})) {
      forecast += series.values(n.index + shift) / static_cast<double>(kNeighbours);
    }
    const double miss = forecast - series.values(i + shift);
    sum += miss * miss;
  }
  const double variance = (series.values.array() - series.values.mean()).square().mean();
  return std::sqrt(sum / static_cast<double>(count) / variance);
}

SurrogateTest surrogate_test(const Series& series, const SurrogateOptions& options) {
  constexpr int kLeast = 19;
  if (options.surrogates < kLeast || options.window < 0) {
    throw InvalidInput(fmt::format("surrogate test: expected at least {} surrogates and a window >= 0, found {} and {}",
                                   kLeast, options.surrogates, options.window));
  }
  check_series(series, 2, "surrogate test");
  SurrogateTest out;
  out.settings = options;
  auto& settings = out.settings;
  if (settings.window == 0) settings.window = theiler_window(series);
  const auto error_of = [&](const Series& of) {
    return forecast_error(of, settings.embedding, settings.ahead, settings.window, settings.references);
  };
  out.error = error_of(series);
  out.of_surrogates.resize(settings.surrogates);
  rethrow_first(parallel_for(static_cast<std::size_t>(settings.surrogates), settings.run, [&](std::size_t k) {
    Random random = Random::stream(settings.seed, k);
    out.of_surrogates(static_cast<Eigen::Index>(k)) = error_of(surrogate(series, settings.kind, random));
  }));
  out.rank = static_cast<int>((out.of_surrogates.array() < out.error).count());
  out.p = (out.rank + 1.0) / (settings.surrogates + 1.0);
  const double mean = out.of_surrogates.mean();
  const double spread = std::sqrt((out.of_surrogates.array() - mean).square().sum() / (settings.surrogates - 1.0));
  out.distance = spread > 0.0 ? (mean - out.error) / spread : 0.0;
  out.rejected = out.p <= 0.05 + 1e-12;
  return out;
}

}  // namespace slipmode::diagnostics
