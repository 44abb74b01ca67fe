#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of a stored orbit ("orbit", "multipliers") or of stored branches ("response", "multipliers"); none for other
/// files.
[[nodiscard]] std::vector<FileFigure> orbit_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
