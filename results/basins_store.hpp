#pragma once

#include <slipmode/diagnostics/attractors/basin_measures.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/sweep_store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

/// Group of a result of `slipmode orbit basins`.
inline constexpr const char* kBasinsGroup = "basins";

/// Finished rows of basins as lines of a journal, and those it holds already. The journal must outlive the sink.
/// @param part  which of several basins the rows belong to, without spaces
[[nodiscard]] orbits::BasinSink basin_sink(Journal& journal, const std::string& part);

/// "gap", "gap-edge", "period 3, 5 crossings", "chaotic", "undecided": an attractor in a word or two.
/// @param kind  as a file's table of attractors has it
[[nodiscard]] std::string attractor_text(const std::string& kind, double order, double crossings);
[[nodiscard]] std::string attractor_text(const std::vector<orbits::BasinAttractor>& attractors, int attractor);

/// What is kept of basins at one value of a third key.
struct BasinsAlong {
  double value = 0.0;
  std::vector<orbits::BasinAttractor> attractors;
  std::vector<diagnostics::BasinShare> shares;
};

/// Writes group `basins`: both keys; per start the attractor and how it got there; per attractor what it is (its orbit
/// as records of orbits have it) and its share; the boundary's uncertainty; shares along a third key.
/// @param along  empty: no third key, `third` is not read
void store_basins(StoreWriter& writer, const SweepAxis& x, const SweepAxis& y, const orbits::MapGrid& grid,
                  const orbits::Basins& basins, const diagnostics::BasinMeasures& measures, const SweepAxis& third,
                  const std::vector<BasinsAlong>& along, const Units& units);

}  // namespace slipmode::results
