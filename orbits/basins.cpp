#include <slipmode/orbits/basins.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

namespace slipmode::orbits {

Eigen::MatrixXi Basins::labels() const {
  Eigen::MatrixXi all(static_cast<Eigen::Index>(rows.size()),
                      static_cast<Eigen::Index>(rows.empty() ? 0 : rows.front().size()));
  for (Eigen::Index j = 0; j < all.rows(); ++j) {
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
      all(j, i) = rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)].attractor;
    }
  }
  return all;
}

Eigen::MatrixXi Basins::closed_labels() const {
  const auto of_kind = [this](BasinAttractor::Kind kind) {
    const auto found = std::ranges::find(attractors, kind, &BasinAttractor::kind);
    return static_cast<int>(found - attractors.begin());
  };
  const Eigen::MatrixXi all = labels();
  return (all.array() == of_kind(BasinAttractor::Kind::kEdge)).select(of_kind(BasinAttractor::Kind::kGap), all);
}

namespace {

using Starts = std::function<dynamics::State(double x, double y)>;

/// Adds what was found, described, where it is new. Nothing when it cannot be described.
std::optional<std::size_t> take_in(const BasinFinder& finder, const BasinFinder::Found& found,
                                   std::vector<BasinAttractor>& known) {
  auto attractor = finder.describe(found);
  if (!attractor) return std::nullopt;
  const std::size_t index = finder.index_of(*attractor, known);
  if (index == known.size()) known.push_back(std::move(*attractor));
  return index;
}

/// Numbers spread evenly over 0 … count − 1.
std::vector<std::size_t> spread(std::size_t count, int wanted) {
  const std::size_t many = std::min(count, static_cast<std::size_t>(wanted));
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < many; ++k) chosen.push_back((2 * k + 1) * count / (2 * many));
  return chosen;
}

/// The attractors of a sample of the starts. In batches of a fixed size, each knowing what those before it found: the
/// same for any number of threads.
std::vector<BasinAttractor> sampled_attractors(const BasinFinder& finder, const Starts& start, const MapGrid& grid,
                                               const ParallelOptions& parallel) {
  constexpr std::size_t kBatch = 16;
  std::vector<BasinAttractor> known = finder.gap_attractors();
  std::vector<std::pair<double, double>> sample;
  for (const std::size_t j : spread(grid.y.size(), finder.options().sample)) {
    for (const std::size_t i : spread(grid.x.size(), finder.options().sample))
      sample.emplace_back(grid.x[i], grid.y[j]);
  }
  for (std::size_t begin = 0; begin < sample.size(); begin += kBatch) {
    std::vector<BasinFinder::Arrival> batch(std::min(kBatch, sample.size() - begin));
    rethrow_first(parallel_for(batch.size(), {.threads = parallel.threads, .stop = parallel.stop}, [&](std::size_t k) {
      const auto [x, y] = sample[begin + k];
      batch[k] = finder.follow(start(x, y), known);
    }));
    for (const BasinFinder::Arrival& arrival : batch) {
      if (arrival.found) (void)take_in(finder, *arrival.found, known);
    }
  }
  return known;
}

BasinLine line_of(const BasinFinder& finder, const Starts& start, const MapGrid& grid, double y,
                  std::vector<BasinAttractor> known) {
  BasinLine line;
  line.cells.reserve(grid.x.size());
  for (const double x : grid.x) {
    BasinFinder::Arrival arrival = finder.follow(start(x, y), known);
    if (arrival.found) {
      const std::size_t before = known.size();
      if (const auto index = take_in(finder, *arrival.found, known)) {
        arrival.cell.attractor = static_cast<int>(*index);
        if (known.size() > before) line.found.push_back(std::move(*arrival.found));
      }
    }
    line.cells.push_back(std::move(arrival.cell));
  }
  return line;
}

}  // namespace

Basins basins(const BasinFinder& finder, const Starts& start, const MapGrid& grid, const ParallelOptions& parallel,
              const BasinSink& sink) {
  if (grid.x.empty() || grid.y.empty()) {
    throw InvalidInput(fmt::format("basins: expected a grid of at least one start each way, found {} x {}",
                                   grid.x.size(), grid.y.size()));
  }
  Basins result;
  try {
    result.attractors = sampled_attractors(finder, start, grid, parallel);
  } catch (const Interrupted&) {
    result.interrupted = true;
    return result;
  }
  const std::vector<BasinAttractor> known = result.attractors;
  auto finished = SweepRunner<BasinLine, std::monostate>(
                      {.settle = [&](std::size_t j, int,
                                     const std::monostate&) { return line_of(finder, start, grid, grid.y[j], known); },
                       .carry = [](const BasinLine&) { return std::monostate(); }},
                      grid.y, {}, SweepMode::kIndependent, 1, parallel, sink)
                      .run_alone();
  result.interrupted = finished.interrupted;
  if (result.interrupted || finished.points.size() < grid.y.size()) return result;
  for (auto& row : finished.points) {
    std::vector<int> number;  // of what the row found, among all
    for (const BasinFinder::Found& found : row.settled.found) {
      number.push_back(static_cast<int>(take_in(finder, found, result.attractors).value()));
    }
    for (BasinCell& cell : row.settled.cells) {
      const int beyond = cell.attractor - static_cast<int>(known.size());
      if (beyond >= 0) cell.attractor = number[static_cast<std::size_t>(beyond)];
    }
    result.rows.push_back(std::move(row.settled.cells));
  }
  if (!finder.gap()) return result;
  result.room.resize(static_cast<Eigen::Index>(grid.y.size()), static_cast<Eigen::Index>(grid.x.size()));
  for (Eigen::Index j = 0; j < result.room.rows(); ++j) {
    for (Eigen::Index i = 0; i < result.room.cols(); ++i) {
      const dynamics::State at = start(grid.x[static_cast<std::size_t>(i)], grid.y[static_cast<std::size_t>(j)]);
      result.room(j, i) = finder.gap()->room_at_end(stacked(at)).least;
    }
  }
  return result;
}

}  // namespace slipmode::orbits
