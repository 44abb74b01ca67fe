#pragma once

#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

/// The stable periodic orbit a driven motion settles to, in the numbers a map shows.
struct MapPoint {
  int order = 0;      ///< periods of the drive; 0: no periodic motion up to max_order within max_periods
  int crossings = 0;  ///< PeriodicOrbit::crossings, over the whole period
  /// Largest |multiplier|, those of a floating family included; NaN without an orbit.
  double multiplier = std::numeric_limits<double>::quiet_NaN();
  bool symmetric = false;  ///< x(T/2) = −x(0)
  bool floating = false;   ///< one of a family of orbits, as those in the gap are
  double alternating = std::numeric_limits<double>::quiet_NaN();  ///< (max − min)/2 of the row's displacement
  double residual = std::numeric_limits<double>::quiet_NaN();     ///< of shooting
  int periods = 0;                                                ///< of the drive simulated before shooting took over
  std::string failure = {};                                       ///< empty, or why the flow failed there

  [[nodiscard]] bool is_periodic() const { return order > 0; }
};

struct MapOptions {
  int max_order = 8;       ///< subharmonics looked for, ≥ 1
  int block = 16;          ///< periods of the drive between looks at the section, > 0
  int max_periods = 1000;  ///< simulated at most, > 0
  /// Shooting takes over when section points `order` periods apart differ by less than this, relative to the motion.
  double near = 1e-3;
  Eigen::VectorXd row = {};  ///< r of the displacement rᵀq whose amplitude is mapped [n]; empty: no amplitude
  ShootingOptions shooting = {};
};

/// Where a driven motion was followed to.
struct SettledMotion {
  std::optional<PeriodicOrbit> orbit;  ///< the stable orbit it ends on, or one of a floating family; none found
  int periods = 0;                     ///< of the drive simulated before shooting took over
  dynamics::State end;                 ///< after them, at the phase of the start
};

/// The orbit a motion settles to: periods of the drive are simulated until the section nearly repeats, then shooting
/// finds the orbit. It counts when it is stable (or one of a floating family) and as near as its multipliers say the
/// motion must be; otherwise the simulation goes on. An orbit of a divisor of the order is recognised.
/// @throws InvalidInput  for options out of range, a drive without period, and as simulate
[[nodiscard]] SettledMotion settled_motion(const dynamics::HybridSystem& system, const dynamics::State& start,
                                           const MapOptions& options);
/// The same in the numbers a map shows.
[[nodiscard]] MapPoint settled_orbit(const dynamics::HybridSystem& system, const dynamics::State& start,
                                     const MapOptions& options);

/// A grid of two parameters. Row j belongs to y[j], point i of it to x[i].
struct MapGrid {
  std::vector<double> x, y;
};

/// A row of a map, at parameter y[index].
using MapRow = SweptValue<std::vector<MapPoint>>;
using MapSink = SinkOf<std::vector<MapPoint>>;

struct OrbitMap {
  std::vector<std::vector<MapPoint>> rows;  ///< by y; those not finished, or left to others, are empty
  bool interrupted = false;
};

/// Settled orbits over a grid. Rows are computed side by side and each point from its own start: the bytes are the same
/// for any number of threads. A NumericalFailure is recorded in its point.
/// @param system  the system at (x, y); called from several threads
/// @param start   where the motion of that system begins
/// @throws InvalidInput  for an empty grid, options out of range, and what the factory finds wrong
/// Source: S0 section 4.1.2, Figures 4.8 to 4.12, 4.18, 4.19.
[[nodiscard]] OrbitMap orbit_map(const std::function<dynamics::HybridSystem(double x, double y)>& system,
                                 const std::function<dynamics::State(const dynamics::HybridSystem&)>& start,
                                 const MapGrid& grid, const MapOptions& options, const ParallelOptions& parallel = {},
                                 const MapSink& sink = {});

}  // namespace slipmode::orbits
