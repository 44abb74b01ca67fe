#include <slipmode/diagnostics/attractors/basin_measures.hpp>

#include <slipmode/core/to_vector.hpp>
#include <slipmode/diagnostics/series/linear_region.hpp>

#include <algorithm>
#include <cmath>

namespace slipmode::diagnostics {

using orbits::BasinCell;

namespace {

/// Neighbours along rows and columns of which one has the label and the other has not.
double crossings_of(const Eigen::MatrixXi& labels, int label) {
  const Eigen::ArrayXXi own = (labels.array() == label).cast<int>();
  const auto changes = [](const auto& a, const auto& b) { return static_cast<double>((a != b).count()); };
  return changes(own.rightCols(own.cols() - 1), own.leftCols(own.cols() - 1)) +
         changes(own.bottomRows(own.rows() - 1), own.topRows(own.rows() - 1));
}

}  // namespace

std::vector<BasinShare> basin_shares(const orbits::Basins& basins) {
  const Eigen::MatrixXi labels = basins.labels();
  const auto all = static_cast<double>(labels.size());
  constexpr double kPerCrossing = 0.05721;  // ζ(3/2) β(3/2)/(4π²), cells²
  std::vector<BasinShare> shares(basins.attractors.size() + 1);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    BasinShare& own = shares[k];
    own.attractor = k < basins.attractors.size() ? static_cast<int>(k) : BasinCell::kUndecided;
    own.cells = static_cast<std::size_t>((labels.array() == own.attractor).count());
    own.share = static_cast<double>(own.cells) / all;
    own.error = std::sqrt(kPerCrossing * crossings_of(labels, own.attractor)) / all;
    std::size_t met = 0;
    for (const auto& row : basins.rows) {
      for (const BasinCell& cell : row) {
        if (cell.attractor != own.attractor) continue;
        met += cell.met_event ? 1 : 0;
        own.least_coordinate = std::fmin(own.least_coordinate, cell.coordinate);  // of NaN and a number, the number
        own.largest_coordinate = std::fmax(own.largest_coordinate, cell.coordinate);
      }
    }
    if (own.cells > 0) own.met_event = static_cast<double>(met) / static_cast<double>(own.cells);
  }
  return shares;
}

BoundaryUncertainty boundary_uncertainty(const Eigen::MatrixXi& labels) {
  BoundaryUncertainty found;
  const Eigen::Index rows = labels.rows(), columns = labels.cols();
  Eigen::Index largest = 1;
  while (32 * largest <= std::min(rows, columns)) largest *= 2;
  if (std::min(rows, columns) <= 2 * largest) return found;
  for (Eigen::Index step = 1; step <= largest; step *= 2) {
    // The same cells for every step: those from which the largest stays on the grid.
    const auto shifted = [&](Eigen::Index down, Eigen::Index right) {
      return labels.block(largest + down, largest + right, rows - 2 * largest, columns - 2 * largest).array();
    };
    const auto own = shifted(0, 0);
    const Eigen::Index differ =
        (own != shifted(step, 0) || own != shifted(-step, 0) || own != shifted(0, step) || own != shifted(0, -step))
            .count();
    found.displacement.push_back(static_cast<double>(step));
    found.share.push_back(static_cast<double>(differ) / static_cast<double>(own.size()));
  }
  std::vector<double> x, y;
  for (std::size_t k = 0; k < found.share.size(); ++k) {
    if (!(found.share[k] > 0.0 && found.share[k] < 0.5)) continue;
    x.push_back(std::log(found.displacement[k]));
    y.push_back(std::log(found.share[k]));
  }
  if (x.size() < 3) return found;
  const Eigen::VectorXd along = to_vector(x);
  const LinearFit line = fit_line(along, to_vector(y), 0, along.size());
  const auto count = static_cast<double>(x.size());
  found.exponent = line.slope;
  found.error = line.residual * std::sqrt(count / (count - 2.0)) / (along.array() - along.mean()).matrix().norm();
  return found;
}

BasinMeasures basin_measures(const orbits::Basins& basins) {
  BasinMeasures all{
      .shares = basin_shares(basins), .boundary = boundary_uncertainty(basins.closed_labels()), .strip = {}};
  if (basins.room.size() == 0) return all;
  double inside = 0.0, met = 0.0;
  for (std::size_t j = 0; j < basins.rows.size(); ++j) {
    for (std::size_t i = 0; i < basins.rows[j].size(); ++i) {
      if (!(basins.room(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) > 0.0)) continue;
      inside += 1.0;
      met += basins.rows[j][i].met_event ? 1.0 : 0.0;
    }
  }
  all.strip = {.share = inside / static_cast<double>(basins.room.size()),
               .met_event = inside > 0.0 ? met / inside : 0.0};
  return all;
}

}  // namespace slipmode::diagnostics
