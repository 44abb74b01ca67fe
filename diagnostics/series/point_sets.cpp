#include <slipmode/diagnostics/series/point_sets.hpp>

#include <slipmode/core/errors.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::diagnostics {

namespace {

std::vector<double> sorted_finite(std::span<const double> points) {
  if (points.empty()) throw InvalidInput("point set: expected at least one point, found none");
  for (const double x : points) {
    if (!std::isfinite(x)) throw InvalidInput("point set: expected finite values, found one that is not");
  }
  std::vector<double> sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

double distance_to(const std::vector<double>& sorted, double x) {
  const auto above = std::lower_bound(sorted.begin(), sorted.end(), x);
  if (above == sorted.end()) return x - sorted.back();
  if (above == sorted.begin()) return *above - x;
  return std::min(*above - x, x - *std::prev(above));
}

double directed(const std::vector<double>& from, const std::vector<double>& to) {
  double largest = 0.0;
  for (const double x : from) largest = std::max(largest, distance_to(to, x));
  return largest;
}

}  // namespace

double wasserstein(std::span<const double> a, std::span<const double> b) {
  const std::vector<double> x = sorted_finite(a);
  const std::vector<double> y = sorted_finite(b);
  // The quantile functions are steps of heights 1/n and 1/m: walk both, in units of 1/(n m), which are exact.
  const std::size_t n = x.size();
  const std::size_t m = y.size();
  std::size_t i = 0;
  std::size_t j = 0;
  std::size_t at = 0;
  double sum = 0.0;
  while (i < n && j < m) {
    const std::size_t end = std::min((i + 1) * m, (j + 1) * n);
    sum += std::abs(x[i] - y[j]) * static_cast<double>(end - at);
    at = end;
    if (end == (i + 1) * m) ++i;
    if (end == (j + 1) * n) ++j;
  }
  return sum / (static_cast<double>(n) * static_cast<double>(m));
}

double hausdorff(std::span<const double> a, std::span<const double> b) {
  const std::vector<double> x = sorted_finite(a);
  const std::vector<double> y = sorted_finite(b);
  return std::max(directed(x, y), directed(y, x));
}

}  // namespace slipmode::diagnostics
