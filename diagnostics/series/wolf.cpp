#include <slipmode/diagnostics/series/wolf.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/neighbours.hpp>
#include "diagnostics/series/internal/stretches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace slipmode::diagnostics {

namespace {

WolfOptions checked(const Series& series, WolfOptions options) {
  if (options.evolution < 1 || options.window < 0 || !(options.smallest >= 0.0) ||
      !(options.largest > options.smallest) || !(options.angle > 0.0)) {
    throw InvalidInput(
        fmt::format("Wolf's exponent: expected evolution >= 1, window >= 0, 0 <= smallest < largest and "
                    "angle > 0, found {}, {}, {}, {} and {}",
                    options.evolution, options.window, options.smallest, options.largest, options.angle));
  }
  check_series(series, 2, "Wolf's exponent");
  if (options.window == 0) options.window = theiler_window(series);
  check_series(series, options.embedding.span() + 100 * options.evolution + 2 * options.window + 100,
               "Wolf's exponent");
  return options;
}

/// The pair that is followed.
class Pair {
 public:
  Pair(const NeighbourTree& tree, const WolfOptions& options, double sigma)
      : tree_(tree),
        smallest_(options.smallest * sigma),
        largest_(options.largest * sigma),
        cosine_(std::cos(options.angle)),
        allowed_{.window = options.window, .limit = tree.size() - options.evolution} {}

  /// The nearest point that is not noise, whatever its direction.
  Eigen::Index nearest(Eigen::Index i) const {
    for (std::size_t count = 16;; count *= 4) {
      const auto near = tree_.nearest(i, count, allowed_);
      for (const Neighbour& n : near) {
        if (n.distance > 0.0 && n.distance >= smallest_) return n.index;
      }
      if (near.size() < count) break;
    }
    throw NumericalFailure(
        fmt::format(
            "Wolf's exponent: point {} has no neighbour at a distance of {:.4g} or more outside the window; lower "
            "`smallest` or the window",
            i, smallest_),
        std::numeric_limits<double>::quiet_NaN(), {}, std::numeric_limits<double>::quiet_NaN());
  }

  /// The nearest point within the angle of the vector from i to j; none if no point qualifies.
  std::optional<Eigen::Index> replacement(Eigen::Index i, Eigen::Index j) const {
    const auto& x = tree_.points();
    const Eigen::VectorXd direction = (x.col(j) - x.col(i)).normalized();
    for (std::size_t count = 32;; count *= 8) {
      const auto near = tree_.nearest(i, count, allowed_);
      for (const Neighbour& n : near) {
        if (n.distance > largest_) return std::nullopt;
        if (n.distance < smallest_ || n.distance == 0.0) continue;
        if ((x.col(n.index) - x.col(i)).dot(direction) >= cosine_ * n.distance) return n.index;
      }
      if (near.size() < count) return std::nullopt;
    }
  }

  bool may_stay(Eigen::Index i, Eigen::Index j) const {
    const double distance = tree_.distance(i, j);
    return j < allowed_.limit && distance > 0.0 && distance <= largest_;
  }

 private:
  const NeighbourTree& tree_;
  double smallest_, largest_, cosine_;
  NeighbourTree::Allowed allowed_;
};

}  // namespace

WolfExponent wolf_exponent(const Series& series, const WolfOptions& options) {
  WolfExponent out;
  out.settings = checked(series, options);
  const auto& settings = out.settings;
  const double sigma = std::sqrt((series.values.array() - series.values.mean()).square().mean());
  const NeighbourTree tree(delay_vectors(series, settings.embedding), Norm::kEuclidean);
  const Pair pair(tree, settings, sigma);
  const Eigen::Index evolutions = (tree.size() - 1) / settings.evolution / kStretches * kStretches;
  Eigen::RowVectorXd growth = Eigen::RowVectorXd::Zero(kStretches);
  Eigen::Index j = pair.nearest(0);
  double distances = 0.0;
  for (Eigen::Index n = 0; n < evolutions; ++n) {
    const Eigen::Index i = n * settings.evolution;
    if (n > 0) {
      const auto better = pair.replacement(i, j);
      if (!better) ++out.kept;
      if (better) {
        j = *better;
      } else if (!pair.may_stay(i, j)) {
        j = pair.nearest(i);
      }
    }
    const double before = tree.distance(i, j);
    distances += before;
    j += settings.evolution;
    const double after = tree.distance(i + settings.evolution, j);
    // A pair that meets exactly has no logarithm; it counts as unchanged and is replaced next.
    if (after > 0.0) growth(n * kStretches / evolutions) += std::log(after / before);
  }
  const double time = static_cast<double>(evolutions * settings.evolution) * series.interval;
  const Eigen::RowVectorXd rates = growth * static_cast<double>(kStretches) / time;
  out.nats = rates.mean();
  out.bits = out.nats / std::numbers::ln2;
  out.error = standard_error(rates)(0);
  out.evolutions = static_cast<int>(evolutions);
  out.mean_distance = distances / static_cast<double>(evolutions);
  return out;
}

}  // namespace slipmode::diagnostics
