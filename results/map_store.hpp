#pragma once

#include <slipmode/orbits/orbit_map.hpp>
#include <slipmode/orbits/strobe_map.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/sweep_store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

/// Groups of a result of `slipmode orbit map`: over two keys, over one.
inline constexpr const char* kMapGroup = "map";
inline constexpr const char* kStrobeGroup = "strobe";

/// Finished rows of a map as lines of a journal, and those it holds already. The journal must outlive the sink.
/// @param start  which of the starts the rows belong to
[[nodiscard]] orbits::MapSink map_sink(Journal& journal, const std::string& start);

/// The same for values of a stroboscopic map.
[[nodiscard]] orbits::StrobeSink strobe_sink(Journal& journal, const std::string& start);

/// One kind of start and the map from it.
struct StartedMap {
  std::string start;  ///< "scene" or "centre"
  orbits::OrbitMap map;
};

/// Writes group `map`: values of both keys, and per start one dataset [y x x] of each number of a point.
void store_map(StoreWriter& writer, const SweepAxis& x, const SweepAxis& y, const orbits::MapGrid& grid,
               const std::vector<StartedMap>& maps, const std::string& length_unit);

/// One kind of start and the points from it.
struct StartedStrobe {
  std::string start;
  std::vector<orbits::StrobePoint> points;
};

/// Writes group `strobe`: per start a table `values` (one row per value and contact) and a table `sections` (one row
/// per value, contact and section).
void store_strobe(StoreWriter& writer, const SweepAxis& axis, const std::vector<StartedStrobe>& runs,
                  const std::string& length_unit);

}  // namespace slipmode::results
