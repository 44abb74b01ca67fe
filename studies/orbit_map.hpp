#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/results/map_store.hpp>
#include <slipmode/studies/command.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

struct OrbitMapOptions {
  /// Where motions begin: "scene" (its [initial]) and "centre" (the steady linear motion in the gap).
  std::vector<std::string> starts = {"scene"};
  int max_order = 8;
  int periods = 1000;
  int kept = 100;
  double tolerance = 1e-5;
  bool follow = false;
  results::Journal* journal = nullptr;  ///< keeps finished values and gives back earlier ones

  static constexpr auto fields() {
    using Own = OrbitMapOptions;
    return std::tuple{
        optional("max_order", &Own::max_order, "", "longest period looked for, in periods of the drive", kCount),
        optional("periods", &Own::periods, "", "periods of the drive simulated at most", kCount),
        optional("kept", &Own::kept, "", "one key: periods of them kept, the last ones", kCount),
        optional("tolerance", &Own::tolerance, "1", "one key: sections nearer than this, relative, are the same",
                 kPositive),
        optional("follow", &Own::follow, "", "one key: start each value where the one before it ended")};
  }
};

/// Settled motion of a driven scene over one key (`strobes`) or two (`maps`), one entry per start.
struct OrbitMapStudy {
  orbits::MapGrid grid;  ///< x: the first key's values, y: the second's; empty over one key
  std::vector<results::StartedMap> maps;
  std::vector<results::StartedStrobe> strobes;
  bool interrupted = false;
};

/// @throws InvalidInput  for more than two keys, a drive without period, no start or another one, following
///                       over two keys
void check(const Family& family, const OrbitMapOptions& options);

/// A row of a map can be computed alone, over one key a value, or where values follow each other all from one start.
/// @param values  as orbit_map
[[nodiscard]] Pieces pieces(const std::vector<std::vector<double>>& values, const OrbitMapOptions& options);

[[nodiscard]] std::string command_of(const std::vector<Over>& over, const OrbitMapOptions& options);

/// @param values  of each key of the family, in their order
/// @throws InvalidInput  as check, orbits::orbit_map and orbits::strobe_map
[[nodiscard]] OrbitMapStudy orbit_map(const Family& family, const std::vector<std::vector<double>>& values,
                                      const OrbitMapOptions& options = {}, const RunOptions& run = {});

/// Writes the group `map` or `strobe`.
void store(results::StoreWriter& writer, const Family& family, const OrbitMapStudy& study);

}  // namespace slipmode::studies
