#pragma once

#include <slipmode/orbits/basins.hpp>

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace slipmode::diagnostics {

/// Share of a plane of starts that ends on an attractor, from a grid.
struct BasinShare {
  int attractor = orbits::BasinCell::kUndecided;  ///< index, or undecided
  std::size_t cells = 0;
  double share = 0.0;      ///< of all cells
  double error = 0.0;      ///< standard error, of the grid's resolution
  double met_event = 0.0;  ///< share of the own cells that met an event on the way; 0 without cells
  /// Range of the gap's coordinate over the own cells; NaN where they have none.
  double least_coordinate = std::numeric_limits<double>::quiet_NaN();
  double largest_coordinate = std::numeric_limits<double>::quiet_NaN();
};

/// One per attractor, in their order, then the undecided.
/// A grid laid at random over a region with a boundary of L cells' length, of no preferred direction, counts its area
/// to σ² = ζ(3/2)β(3/2)/π³ L = 0.0728 L cells², and L is π/4 of its crossings, the neighbours in rows and columns of
/// which one belongs to it. A grid is no random sample: the binomial error knows nothing of the boundary. Source:
/// Kendall, Quart. J. Math. 19 (1948) 1; docs/theory/basins.md, section 6.
[[nodiscard]] std::vector<BasinShare> basin_shares(const orbits::Basins& basins);

/// How uncertain the end of a start is that is known to ε.
struct BoundaryUncertainty {
  std::vector<double> displacement;  ///< ε, in cells
  std::vector<double> share;  ///< f: of the cells from which a step of ε along either key leads to another label
  /// f ~ ε^α: 1 for a smooth boundary, less for a fractal one, whose dimension in the plane is 2 − α. NaN where fewer
  /// than three f lie between 0 and ½.
  double exponent = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();  ///< standard error of the fitted slope
};

/// Over ε = 1, 2, 4, … cells, up to a sixteenth of the grid. @param labels  [y x x]
/// Source: McDonald, Grebogi, Ott, Yorke, Physica D 17 (1985) 125.
[[nodiscard]] BoundaryUncertainty boundary_uncertainty(const Eigen::MatrixXi& labels);

/// Starts whose linear motion would fit in the gap, the strip of S2 (15).
struct BasinStrip {
  double share = 0.0;      ///< of all cells
  double met_event = 0.0;  ///< share of the strip's cells that met an event on the way; 0 without cells
};

struct BasinMeasures {
  std::vector<BasinShare> shares;
  BoundaryUncertainty boundary;     ///< of the labels with the gap's edge closed
  std::optional<BasinStrip> strip;  ///< none without a gap motion
};
[[nodiscard]] BasinMeasures basin_measures(const orbits::Basins& basins);

}  // namespace slipmode::diagnostics
