#include <slipmode/diagnostics/series/section.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/to_vector.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::diagnostics {

namespace {

/// The polynomial through order + 1 samples about an interval; argument in samples from the interval's left end.
class LocalPolynomial {
 public:
  LocalPolynomial(const Eigen::VectorXd& samples, Eigen::Index left, int order)
      : nodes_(order + 1),
        begin_(std::clamp<Eigen::Index>(left - order / 2, 0, samples.size() - nodes_)),
        offset_(static_cast<double>(begin_ - left)),
        differences_(samples.segment(begin_, nodes_)) {
    // Newton's divided differences over the nodes 0, 1, ….
    for (int k = 1; k < nodes_; ++k) {
      for (int i = nodes_ - 1; i >= k; --i) differences_(i) = (differences_(i) - differences_(i - 1)) / k;
    }
  }

  struct Value {
    double value, slope;
  };

  Value at(double place) const {
    const double u = place - offset_;
    Value out{.value = differences_(nodes_ - 1), .slope = 0.0};
    for (int i = nodes_ - 2; i >= 0; --i) {
      out.slope = out.slope * (u - i) + out.value;
      out.value = out.value * (u - i) + differences_(i);
    }
    return out;
  }

 private:
  int nodes_;
  Eigen::Index begin_;
  double offset_;
  Eigen::VectorXd differences_;
};

/// Zero in [0, 1] of a function whose signs differ at the ends, by bisection to rounding.
template <typename Function>
double bisect_interval(const Function& f) {
  constexpr int kHalvings = 52;
  double low = 0.0, high = 1.0;
  const bool rising = f(0.0) < 0.0;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    ((f(middle) < 0.0) == rising ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void check_section(const Series& series, const SectionOptions& options) {
  if (options.order != 1 && options.order != 3 && options.order != 5) {
    throw InvalidInput(fmt::format("section of {}: expected order 1, 3 or 5, found {}", series.name, options.order));
  }
  if (options.cut == Cut::kMaximum && options.order < 3) {
    throw InvalidInput(fmt::format("section of {} at maxima: expected order 3 or 5, found 1", series.name));
  }
  if (options.cut == Cut::kStrobe &&
      (!(options.period >= series.interval) || !(options.phase >= 0.0 && options.phase < 1.0))) {
    throw InvalidInput(
        fmt::format("section of {} once per period: expected a period of at least one interval, {:g}, and a phase in "
                    "[0, 1), found {:g} and {:g}",
                    series.name, series.interval, options.period, options.phase));
  }
  if (options.embedding.dimension < 1 || options.embedding.lag < 1) {
    throw InvalidInput(fmt::format("section of {}: expected a dimension and a lag of at least 1, found {} and {}",
                                   series.name, options.embedding.dimension, options.embedding.lag));
  }
  check_series(series, options.embedding.span() + options.order + 2, "section");
}

/// Instants in samples, ascending, all below `end`.
std::vector<double> strobe_instants(const Series& series, const SectionOptions& options, double end) {
  std::vector<double> out;
  const double step = options.period / series.interval;
  for (std::size_t k = 0;; ++k) {
    const double at = (static_cast<double>(k) + options.phase) * step;
    if (at > end) return out;
    out.push_back(at);
  }
}

std::vector<double> level_instants(const Series& series, const SectionOptions& options, Eigen::Index end) {
  std::vector<double> out;
  const Eigen::VectorXd& s = series.values;
  const double sign = options.cut == Cut::kUpward ? 1.0 : -1.0, level = options.level.value_or(0.0);
  for (Eigen::Index i = 0; i < end; ++i) {
    if (!(sign * (s(i) - level) < 0.0 && sign * (s(i + 1) - level) >= 0.0)) continue;
    const LocalPolynomial p(s, i, options.order);
    out.push_back(static_cast<double>(i) + bisect_interval([&](double u) { return p.at(u).value - level; }));
  }
  return out;
}

std::vector<double> maximum_instants(const Series& series, const SectionOptions& options, Eigen::Index end) {
  std::vector<double> out;
  const Eigen::VectorXd& s = series.values;
  for (Eigen::Index i = 1; i < end; ++i) {
    if (!(s(i) > s(i - 1) && s(i) >= s(i + 1))) continue;
    // The top lies in the interval before or after the highest sample.
    const double slope = LocalPolynomial(s, i, options.order).at(0.0).slope;
    const Eigen::Index left = slope > 0.0 ? i : i - 1;
    const LocalPolynomial p(s, left, options.order);
    if (!(p.at(0.0).slope > 0.0 && p.at(1.0).slope <= 0.0)) continue;
    out.push_back(static_cast<double>(left) + bisect_interval([&](double u) { return p.at(u).slope; }));
  }
  return out;
}

std::vector<double> cut_instants(const Series& series, const SectionOptions& options) {
  const Eigen::Index end = series.values.size() - 1 - options.embedding.span();
  switch (options.cut) {
    case Cut::kStrobe:
      return strobe_instants(series, options, static_cast<double>(end));
    case Cut::kMaximum:
      return maximum_instants(series, options, end);
    case Cut::kUpward:
    case Cut::kDownward:
      break;
  }
  return level_instants(series, options, end);
}

}  // namespace

SectionPoints section(const Series& series, const SectionOptions& options) {
  check_section(series, options);
  SectionPoints out;
  out.settings = options;
  if (!options.level) out.settings.level = series.values.mean();
  const std::vector<double> at = cut_instants(series, out.settings);
  const auto count = static_cast<Eigen::Index>(at.size());
  out.time = to_vector(at) * series.interval;
  out.points.resize(options.embedding.dimension, count);
  for (Eigen::Index m = 0; m < count; ++m) {
    const double instant = at[static_cast<std::size_t>(m)];
    const auto left = std::min(static_cast<Eigen::Index>(instant), series.values.size() - 2 - options.embedding.span());
    for (int k = 0; k < options.embedding.dimension; ++k) {
      const Eigen::Index shifted = left + k * options.embedding.lag;
      out.points(k, m) =
          LocalPolynomial(series.values, shifted, options.order).at(instant - static_cast<double>(left)).value;
    }
  }
  if (count < 2) return out;
  const Eigen::ArrayXd gaps = out.time.tail(count - 1) - out.time.head(count - 1);
  out.mean_return = gaps.mean();
  if (count > 2) {
    out.return_error = std::sqrt((gaps - out.mean_return).square().sum() / static_cast<double>(count - 2) /
                                 static_cast<double>(count - 1));
  }
  return out;
}

}  // namespace slipmode::diagnostics
