#pragma once

#include <slipmode/orbits/basin_finder.hpp>

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace slipmode::orbits {

/// A row of basins as it was computed: attractors it met beyond those known before are numbered after them.
struct BasinLine {
  std::vector<BasinCell> cells;
  std::vector<BasinFinder::Found> found;
};
using BasinSink = SinkOf<BasinLine>;

struct Basins {
  std::vector<BasinAttractor> attractors;    ///< the gap's first, then in the order in which they were found
  std::vector<std::vector<BasinCell>> rows;  ///< by y; none when interrupted or when some were left to others
  /// GapMotion::room_at_end of each start, the strip of S2 (15) where positive [y x x, m]; empty without a gap motion.
  Eigen::MatrixXd room;
  bool interrupted = false;

  /// Attractor of each start [y x x].
  [[nodiscard]] Eigen::MatrixXi labels() const;
  /// The same with the edge of the gap's continuum as the gap: one closed set, whose starts interleave.
  [[nodiscard]] Eigen::MatrixXi closed_labels() const;
};

/// Which attractor each start of a grid ends on. Attractors are looked for from a fixed sample of the starts first; one
/// that only other starts reach is found with them and numbered after the others, in the order of the starts. Rows are
/// computed side by side; the bytes are the same for any number of threads, and a start followed alone to the
/// attractors of the result gives its cell.
/// @param start  at two coordinates, at time 0; called from several threads
/// @throws InvalidInput  for an empty grid, and as BasinFinder
/// How attractors are recognised, what is proved and what is measured: docs/theory/basins.md.
[[nodiscard]] Basins basins(const BasinFinder& finder, const std::function<dynamics::State(double x, double y)>& start,
                            const MapGrid& grid, const ParallelOptions& parallel = {}, const BasinSink& sink = {});

}  // namespace slipmode::orbits
