#include <slipmode/diagnostics/series/divergence.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/median.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace slipmode::diagnostics {

namespace {

constexpr std::size_t kColumnBlock = 128;

DivergenceOptions checked(const Series& series, DivergenceOptions options) {
  if (options.steps < 2 || options.stride < 1 || options.window < 0 || !(options.radius >= 0.0) ||
      options.least_neighbours < 1 || options.references < 0) {
    throw InvalidInput(fmt::format(
        "divergence: expected steps >= 2, stride and least_neighbours >= 1, window, radius and references >= "
        "0, found {}, {}, {}, {}, {} and {}",
        options.steps, options.stride, options.least_neighbours, options.window, options.radius, options.references));
  }
  check_series(series, 2, "divergence");
  if (options.window == 0) options.window = theiler_window(series);
  check_series(series, options.embedding.span() + options.steps * options.stride + 2 * options.window + 100,
               fmt::format("divergence over {} samples", options.steps * options.stride));
  return options;
}

/// The points of a record, of which those with a known future are followed.
class Followed {
 public:
  Followed(const Series& series, const DivergenceOptions& options)
      : values_(series.values),
        options_(options),
        tree_(delay_vectors(series, options.embedding),
              options.method == DivergenceMethod::kKantz ? Norm::kMaximum : Norm::kEuclidean),
        allowed_{.window = options.window, .limit = tree_.size() - options.steps * options.stride},
        count_(options.references == 0 ? allowed_.limit : std::min(options.references, allowed_.limit)) {}

  Eigen::Index count() const { return count_; }

  /// Twice the median distance to the tenth neighbour over 200 references.
  double usual_radius() const {
    constexpr Eigen::Index kProbes = 200;
    std::vector<double> tenth;
    for (Eigen::Index p = 0; p < kProbes; ++p) {
      tenth.push_back(tree_.nearest(p * allowed_.limit / kProbes, 10, allowed_).back().distance);
    }
    return 2.0 * median(std::move(tenth));
  }

  /// Logarithms of distance over time of reference r, NaN where it has none [steps + 1].
  Eigen::VectorXd follow(Eigen::Index r, double radius) const {
    const Eigen::Index i = r * allowed_.limit / count_;
    switch (options_.method) {
      case DivergenceMethod::kRosenstein:
        return follow_nearest(i);
      case DivergenceMethod::kTransverse:
        return follow_path(i);
      case DivergenceMethod::kKantz:
        break;
    }
    return follow_all(i, radius);
  }

 private:
  Eigen::VectorXd follow_nearest(Eigen::Index i) const {
    const Eigen::Index j = tree_.nearest(i, 1, allowed_).front().index;
    Eigen::VectorXd logs(options_.steps + 1);
    for (int k = 0; k <= options_.steps; ++k) {
      const double distance = tree_.distance(i + k * options_.stride, j + k * options_.stride);
      logs(k) = distance > 0.0 ? std::log(distance) : kNone;
    }
    return logs;
  }

  /// Distance of point i from the path near sample j, and the sample nearest to the foot of the perpendicular.
  Neighbour from_path(Eigen::Index i, Eigen::Index j) const {
    constexpr int kSlips = 4;
    const auto& x = tree_.points();
    Neighbour foot{.index = j};
    for (int slip = 0; slip < kSlips; ++slip) {
      j = std::clamp<Eigen::Index>(foot.index, 1, x.cols() - 2);
      const Eigen::VectorXd tangent = 0.5 * (x.col(j + 1) - x.col(j - 1));
      const Eigen::VectorXd bend = x.col(j + 1) - 2.0 * x.col(j) + x.col(j - 1);
      const Eigen::VectorXd apart = x.col(i) - x.col(j);
      const double speed = tangent.squaredNorm();
      const double theta = speed > 0.0 ? std::clamp(apart.dot(tangent) / speed, -1.0, 1.0) : 0.0;
      foot = {.index = j + std::lround(theta),
              .distance = (apart - theta * tangent - 0.5 * theta * theta * bend).norm()};
      if (foot.index == j) break;
    }
    return foot;
  }

  Eigen::VectorXd follow_path(Eigen::Index i) const {
    constexpr std::size_t kCandidates = 24;
    Neighbour nearest{.index = -1, .distance = std::numeric_limits<double>::infinity()};
    for (const Neighbour& candidate : tree_.nearest(i, kCandidates, allowed_)) {
      const Neighbour foot = from_path(i, candidate.index);
      if (foot.distance < nearest.distance) nearest = foot;
    }
    Eigen::VectorXd logs(options_.steps + 1);
    for (int k = 0; k <= options_.steps; ++k) {
      logs(k) = nearest.distance > 0.0 ? std::log(nearest.distance) : kNone;
      if (k == options_.steps) break;
      nearest = from_path(i + (k + 1) * options_.stride, nearest.index + options_.stride);
    }
    return logs;
  }

  Eigen::VectorXd follow_all(Eigen::Index i, double radius) const {
    const std::vector<Neighbour> near = tree_.within(i, radius, allowed_);
    Eigen::VectorXd logs = Eigen::VectorXd::Constant(options_.steps + 1, kNone);
    if (near.size() < static_cast<std::size_t>(options_.least_neighbours)) return logs;
    for (int k = 0; k <= options_.steps; ++k) {
      const Eigen::Index ahead = options_.embedding.span() + k * options_.stride;
      double sum = 0.0;
      for (const Neighbour& n : near) sum += std::abs(values_(i + ahead) - values_(n.index + ahead));
      if (sum > 0.0) logs(k) = std::log(sum / static_cast<double>(near.size()));
    }
    return logs;
  }

  const Eigen::VectorXd& values_;
  const DivergenceOptions& options_;
  NeighbourTree tree_;
  NeighbourTree::Allowed allowed_;
  Eigen::Index count_;
};

/// Mean over the columns begin … end − 1 of what is known in each row.
Eigen::VectorXd mean_of_known(const Eigen::MatrixXd& logs, Eigen::Index begin, Eigen::Index end) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(logs.rows()), known = sum;
  for (Eigen::Index r = begin; r < end; ++r) {
    for (Eigen::Index k = 0; k < logs.rows(); ++k) {
      if (std::isnan(logs(k, r))) continue;
      sum(k) += logs(k, r);
      known(k) += 1.0;
    }
  }
  return sum.cwiseQuotient(known);
}

}  // namespace

Divergence divergence(const Series& series, const DivergenceOptions& options) {
  Divergence out;
  out.settings = checked(series, options);
  auto& settings = out.settings;
  const Followed followed(series, settings);
  if (settings.method == DivergenceMethod::kKantz && settings.radius == 0.0) settings.radius = followed.usual_radius();
  Eigen::MatrixXd logs(settings.steps + 1, followed.count());
  const auto blocks = (static_cast<std::size_t>(logs.cols()) + kColumnBlock - 1) / kColumnBlock;
  rethrow_first(parallel_for(blocks, settings.run, [&](std::size_t block) {
    const auto begin = static_cast<Eigen::Index>(block * kColumnBlock);
    const auto end = std::min<Eigen::Index>(logs.cols(), begin + static_cast<Eigen::Index>(kColumnBlock));
    for (Eigen::Index r = begin; r < end; ++r) logs.col(r) = followed.follow(r, settings.radius);
  }));
  for (const double last : logs.bottomRows(1).reshaped()) out.references += std::isnan(last) ? 0 : 1;
  if (out.references < 100) {
    throw NumericalFailure(
        fmt::format(
            "divergence of {}: expected at least 100 points with {} distinct neighbours, found {}{}", series.name,
            settings.method == DivergenceMethod::kKantz ? settings.least_neighbours : 1, out.references,
            settings.method == DivergenceMethod::kKantz
                ? fmt::format("; radius {:.4g} is too small, {:.4g} would do", settings.radius, followed.usual_radius())
                : "; the record repeats itself exactly"),
        kNone, {}, kNone);
  }
  const Eigen::Index half = logs.cols() / 2;
  out.time = Eigen::VectorXd::LinSpaced(settings.steps + 1, 0.0, settings.steps) *
             (series.interval * static_cast<double>(settings.stride));
  out.mean_log = mean_of_known(logs, 0, logs.cols());
  out.region = linear_region(out.time, out.mean_log, settings.region);
  out.exponent = out.region.slope;
  for (const int h : {0, 1}) {
    const Eigen::VectorXd curve = mean_of_known(logs, h == 0 ? 0 : half, h == 0 ? half : logs.cols());
    out.of_halves[h] = fit_line(out.time, curve, out.region.begin, out.region.end).slope;
  }
  out.error = std::hypot(0.5 * (out.of_halves[0] - out.of_halves[1]), out.region.curvature);
  return out;
}

}  // namespace slipmode::diagnostics
