#include <slipmode/orbits/close_returns.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>

namespace slipmode::orbits {

namespace {

void check(const Eigen::MatrixXd& points, const ReturnOptions& options) {
  if (options.min_length < 1 || options.max_length < options.min_length || options.per_length < 1 ||
      !(options.threshold > 0.0) || !(options.apart >= 0.0)) {
    throw InvalidInput(
        fmt::format("close returns: expected 1 <= min_length <= max_length, per_length >= 1, threshold > 0, apart >= "
                    "0, found {}, {}, {}, {}, {}",
                    options.min_length, options.max_length, options.per_length, options.threshold, options.apart));
  }
  if (points.cols() < 2 || points.rows() < 1) {
    throw InvalidInput(fmt::format("close returns: expected at least two points, found {} of size {}. Record longer",
                                   points.cols(), points.rows()));
  }
  if (!points.allFinite()) throw InvalidInput("close returns: expected finite points, found a value that is not");
}

double distance(const Eigen::MatrixXd& points, Eigen::Index i, Eigen::Index k) {
  return (points.col(k) - points.col(i)).norm();
}

/// Near an orbit with a weak multiplier −m its double returns nearer than itself, by m − 1.
constexpr double kExplained = 3.0;

/// True when a divisor of the length brings the point back about as near.
bool divisor_explains(const Eigen::MatrixXd& points, const CloseReturn& candidate) {
  for (Eigen::Index q = 1; 2 * q <= candidate.length; ++q) {
    if (candidate.length % q == 0 &&
        distance(points, candidate.begin, candidate.begin + q) <= kExplained * candidate.distance) {
      return true;
    }
  }
  return false;
}

bool nearer(const CloseReturn& a, const CloseReturn& b) {
  return std::tie(a.length, a.distance, a.begin) < std::tie(b.length, b.distance, b.begin);
}

/// True when the stretches of two returns of one length, in some phase, are nearer than `apart` at every point.
bool run_together(const Eigen::MatrixXd& points, const CloseReturn& a, const CloseReturn& b, double apart) {
  const Eigen::Index p = a.length;
  for (Eigen::Index shift = 0; shift < p; ++shift) {
    Eigen::Index k = 0;
    while (k < p && distance(points, a.begin + k, b.begin + (k + shift) % p) < apart) ++k;
    if (k == p) return true;
  }
  return false;
}

/// Appends the nearest `per_length` of returns of one length that are not each other's doubles.
void keep_nearest_apart(const Eigen::MatrixXd& points, std::vector<CloseReturn> returns, const ReturnOptions& options,
                        std::vector<CloseReturn>& out_kept) {
  std::sort(returns.begin(), returns.end(), nearer);
  const std::size_t first = out_kept.size();
  for (const CloseReturn& candidate : returns) {
    if (static_cast<Eigen::Index>(out_kept.size() - first) == options.per_length) return;
    const bool is_new = std::none_of(out_kept.begin() + static_cast<std::ptrdiff_t>(first), out_kept.end(),
                                     [&](const CloseReturn& other) {
                                       return std::abs(other.begin - candidate.begin) <= candidate.length ||
                                              run_together(points, candidate, other, options.apart);
                                     });
    if (is_new) out_kept.push_back(candidate);
  }
}

/// Sorts by length and distance and cuts each length to the nearest `per_length`.
std::vector<CloseReturn> nearest_of_each_length(std::vector<CloseReturn> returns, Eigen::Index per_length) {
  std::sort(returns.begin(), returns.end(), nearer);
  std::vector<CloseReturn> kept;
  Eigen::Index length = 0;
  Eigen::Index count = 0;
  for (const CloseReturn& candidate : returns) {
    count = candidate.length == length ? count + 1 : 1;
    length = candidate.length;
    if (count <= per_length) kept.push_back(candidate);
  }
  return kept;
}

/// The first return of point i, or none within max_length.
std::optional<CloseReturn> first_return(const Eigen::MatrixXd& points, Eigen::Index i, const ReturnOptions& options) {
  const Eigen::Index end = std::min(points.cols() - 1, i + options.max_length);
  Eigen::Index k = i + 1;
  while (k <= end && (k < i + options.min_length || distance(points, i, k) <= options.threshold)) ++k;
  while (k <= end && distance(points, i, k) > options.threshold) ++k;
  if (k > end) return std::nullopt;
  CloseReturn nearest{.begin = i, .length = k - i, .distance = distance(points, i, k)};
  for (++k; k <= end; ++k) {
    const double here = distance(points, i, k);
    if (here > options.threshold) break;
    if (here < nearest.distance) nearest = {.begin = i, .length = k - i, .distance = here};
  }
  return nearest;
}

}  // namespace

std::vector<CloseReturn> section_returns(const Eigen::MatrixXd& points, const ReturnOptions& options) {
  check(points, options);
  std::vector<CloseReturn> kept;
  for (Eigen::Index p = options.min_length; p <= options.max_length && p < points.cols(); ++p) {
    std::vector<CloseReturn> returns;
    for (Eigen::Index i = 0; i + p < points.cols(); ++i) {
      const CloseReturn here{i, p, distance(points, i, i + p)};
      if (here.distance <= options.threshold && !divisor_explains(points, here)) returns.push_back(here);
    }
    keep_nearest_apart(points, std::move(returns), options, kept);
  }
  return kept;
}

std::vector<CloseReturn> path_returns(const Eigen::MatrixXd& points, const ReturnOptions& options) {
  check(points, options);
  std::vector<CloseReturn> returns;
  Eigen::Index last_length = 0;  // of the point before; 0: it had no return
  for (Eigen::Index i = 0; i + 1 < points.cols(); ++i) {
    const std::optional<CloseReturn> found = first_return(points, i, options);
    if (!found) {
      last_length = 0;
      continue;
    }
    const bool same_visit = last_length != 0 && std::abs(found->length - last_length) <= 1;
    last_length = found->length;
    if (!same_visit) {
      returns.push_back(*found);
    } else if (found->distance < returns.back().distance) {
      returns.back() = *found;
    }
  }
  return nearest_of_each_length(std::move(returns), options.per_length);
}

double half_mean_step(const Eigen::MatrixXd& points) {
  if (points.cols() < 2) {
    throw InvalidInput(fmt::format("mean step: expected at least two points, found {}", points.cols()));
  }
  const Eigen::Index steps = points.cols() - 1;
  return 0.5 * (points.rightCols(steps) - points.leftCols(steps)).colwise().norm().mean();
}

}  // namespace slipmode::orbits
