#include "cli/verbs.hpp"

namespace slipmode::cli {

std::vector<Verb> add_orbit(CLI::App& app) {
  CLI::App* orbit = app.add_subcommand(
      "orbit", "periodic orbits: find, follow, map, basins, spectra, and skeletons of chaotic motion");
  orbit->require_subcommand(1);
  orbit->footer("Example:\n  slipmode orbit find datasets/backlash_sdof/scene.toml\nHelp: slipmode orbit VERB --help");
  return {add_orbit_find(*orbit),     add_orbit_continue(*orbit), add_orbit_map(*orbit),     add_orbit_basins(*orbit),
          add_orbit_skeleton(*orbit), add_orbit_returns(*orbit),  add_orbit_spectrum(*orbit)};
}

}  // namespace slipmode::cli
