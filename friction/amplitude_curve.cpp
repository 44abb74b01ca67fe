#include <slipmode/friction/amplitude_curve.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace slipmode::friction {

namespace {

using Constant = AmplitudeCurve::Constant;
using Polynomial = AmplitudeCurve::Polynomial;
using Table = AmplitudeCurve::Table;
using Exponential = AmplitudeCurve::Exponential;

double value(const Constant& curve, double /*f*/) { return curve.amplitude; }

double value(const Polynomial& curve, double f) {
  return std::accumulate(curve.coefficients.rbegin(), curve.coefficients.rend(), 0.0,
                         [f](double sum, double coefficient) { return sum * f + coefficient; });
}

double value(const Table& curve, double f) {
  const auto& points = curve.points;
  if (!(f >= points.front().first && f <= points.back().first)) {
    throw InvalidInput(fmt::format("amplitude curve: no value at {} Hz; the table goes from {} to {} Hz", f,
                                   points.front().first, points.back().first));
  }
  const auto right = std::ranges::lower_bound(points, f, {}, &std::pair<double, double>::first);
  if (right->first == f) return right->second;
  const auto left = right - 1;
  return std::lerp(left->second, right->second, (f - left->first) / (right->first - left->first));
}

double value(const Exponential& curve, double f) { return curve.amplitude * std::exp(-(f - curve.at) / curve.decay); }

/// Coefficients on [low, high] in Bernstein's form: the polynomial lies between the least and the greatest of them.
std::vector<double> bernstein(std::vector<double> a, double low, double high) {
  const std::size_t n = a.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {  // Taylor shift to low
    for (std::size_t k = n - 1; k-- > i;) a[k] += low * a[k + 1];
  }
  double scale = 1.0;  // (high − low)^k / C(n−1, k)
  for (std::size_t k = 0; k < n; ++k) {
    a[k] *= scale;
    scale *= (high - low) * static_cast<double>(k + 1) / static_cast<double>(n - 1 - k);
  }
  for (std::size_t k = 1; k < n; ++k) {
    for (std::size_t i = n - 1; i >= k; --i) a[i] += a[i - 1];
  }
  return a;
}

/// Halves the interval until the coefficients settle the sign; a double root, which never does, counts as no crossing.
bool is_non_negative(std::vector<double> b, int depth) {
  if (b.front() < 0.0 || b.back() < 0.0) return false;
  if (depth == 0 || *std::ranges::min_element(b) >= 0.0) return true;
  std::vector<double> left;
  for (std::size_t size = b.size(); size > 0; --size) {  // de Casteljau at the middle; b becomes the right half
    left.push_back(b.front());
    for (std::size_t i = 0; i + 1 < size; ++i) b[i] = 0.5 * (b[i] + b[i + 1]);
  }
  return is_non_negative(std::move(left), depth - 1) && is_non_negative(std::move(b), depth - 1);
}

bool covers(const Constant& /*curve*/, double /*low*/, double /*high*/) { return true; }
bool covers(const Exponential& /*curve*/, double /*low*/, double /*high*/) { return true; }

bool covers(const Table& curve, double low, double high) {
  return low >= curve.points.front().first && high <= curve.points.back().first;
}

bool covers(const Polynomial& curve, double low, double high) {
  constexpr int kDepth = 30;
  return is_non_negative(bernstein(curve.coefficients, low, high), kDepth);
}

[[noreturn]] void fail(const std::string& found, const char* expected) {
  throw InvalidInput(fmt::format("amplitude curve: {}; expected {}", found, expected));
}

void check_amplitude(double amplitude) {
  if (!(amplitude >= 0.0) || !std::isfinite(amplitude)) fail(fmt::format("amplitude = {}", amplitude), "a number >= 0");
}

void check(const Constant& curve) { check_amplitude(curve.amplitude); }

void check(const Polynomial& curve) {
  if (curve.coefficients.empty()) fail("a polynomial without coefficients", "at least one");
  for (const double coefficient : curve.coefficients) {
    if (!std::isfinite(coefficient)) fail(fmt::format("coefficient {}", coefficient), "finite coefficients");
  }
}

void check(const Table& curve) {
  if (curve.points.size() < 2) fail(fmt::format("a table of {} points", curve.points.size()), "at least two points");
  double last = 0.0;
  for (const auto& [frequency, amplitude] : curve.points) {
    check_amplitude(amplitude);
    if (!(frequency > last) || !std::isfinite(frequency)) {
      fail(fmt::format("frequency {} Hz after {} Hz", frequency, last), "ascending frequencies > 0");
    }
    last = frequency;
  }
}

void check(const Exponential& curve) {
  check_amplitude(curve.amplitude);
  if (!std::isfinite(curve.at)) fail(fmt::format("at = {}", curve.at), "a finite number");
  if (!(curve.decay > 0.0) || !std::isfinite(curve.decay)) fail(fmt::format("decay = {}", curve.decay), "a number > 0");
}

}  // namespace

double AmplitudeCurve::at(double frequency_hz) const {
  if (!(frequency_hz > 0.0) || !std::isfinite(frequency_hz)) {
    fail(fmt::format("a frequency of {} Hz", frequency_hz), "a finite frequency > 0");
  }
  const double found = std::visit([frequency_hz](const auto& curve) { return value(curve, frequency_hz); }, kind);
  if (!(found >= 0.0) || !std::isfinite(found)) {
    fail(fmt::format("the curve gives {} m at {} Hz", found, frequency_hz), "an amplitude >= 0");
  }
  return found;
}

bool AmplitudeCurve::covers(double from_hz, double to_hz) const {
  const auto [low, high] = std::minmax(from_hz, to_hz);
  return std::visit([low = low, high = high](const auto& curve) { return friction::covers(curve, low, high); }, kind);
}

void validate(const AmplitudeCurve& curve) {
  std::visit([](const auto& any) { check(any); }, curve.kind);
}

}  // namespace slipmode::friction
