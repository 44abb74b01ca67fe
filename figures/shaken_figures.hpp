#pragma once

#include <slipmode/figures/file_figures.hpp>

namespace slipmode::figures {

/// Figures of a file made from a scene with a shaker, the most telling first: sections over the swept key, small
/// multiples of reduced models over the full one, agreement against the number of modes, functions along the beam,
/// friction loops, delay map and spectrum.
[[nodiscard]] std::vector<FileFigure> shaken_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
