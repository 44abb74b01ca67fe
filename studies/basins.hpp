#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/results/basins_store.hpp>
#include <slipmode/studies/command.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <array>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

/// A plane of starts; what the two keys leave is as the scene's start has it.
struct BasinsRequest {
  std::array<Over, 2> over;        ///< across, up: coordinates of the start, "initial.velocity.2"
  std::vector<double> along = {};  ///< values of the family's key, where it has one
};

struct BasinsOptions {
  int max_order = 8;
  int periods = 1000;
  int sample = 16;
  results::Journal* journal = nullptr;  ///< keeps finished rows and gives back earlier ones

  static constexpr auto fields() {
    using Own = BasinsOptions;
    return std::tuple{
        optional("max_order", &Own::max_order, "", "longest period looked for, in periods of the drive", kCount),
        optional("periods", &Own::periods, "",
                 "periods of the drive simulated at most where a start arrives at no attractor known before", kCount),
        optional("sample", &Own::sample, "", "starts each way that are followed first, to find attractors", kCount)};
  }
};

/// Basins of a driven scene over two coordinates of the start, and along a key of the scene.
struct BasinsStudy {
  orbits::MapGrid grid;
  orbits::Basins basins = {};                    ///< of the scene's own values
  diagnostics::BasinMeasures measures = {};      ///< of these
  std::vector<results::BasinsAlong> along = {};  ///< by value of the third key
  bool interrupted = false;
};

/// @throws InvalidInput  for a key that is no coordinate of the start, two alike, no values or values that are not
///                       finite, a third key that is one of the start, a drive without period
void check(const Family& family, const BasinsRequest& request);

/// @param family  as basins
[[nodiscard]] std::string command_of(const Family& family, const BasinsRequest& request, const BasinsOptions& options);

/// A row of each plane can be computed alone.
[[nodiscard]] Pieces pieces(const BasinsRequest& request);

/// @param family  over the third key, or none
/// @throws InvalidInput  as check and orbits::basins
[[nodiscard]] BasinsStudy basins(const Family& family, const BasinsRequest& request, const BasinsOptions& options = {},
                                 const RunOptions& run = {});

/// Writes the group `basins`.
void store(results::StoreWriter& writer, const Family& family, const BasinsRequest& request, const BasinsStudy& study);

}  // namespace slipmode::studies
