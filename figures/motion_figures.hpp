#pragma once

#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/results/store.hpp>

namespace slipmode::figures {

// Figures of a shaken trajectory.

/// Force of the first contact against relative displacement and velocity (drive less contact), over the last cycles:
/// the form of S4 Figs 6.2 to 6.4.
[[nodiscard]] Figure friction_loops(const results::StoreReader& store);
/// The scene's reading against itself a quarter of a drive period later.
[[nodiscard]] Figure reading_delay_map(const results::StoreReader& store);
/// Averaged amplitude spectrum of the scene's reading.
[[nodiscard]] Figure reading_spectrum(const results::StoreReader& store);

}  // namespace slipmode::figures
