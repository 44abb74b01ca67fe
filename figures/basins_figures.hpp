#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of basins of attraction.
[[nodiscard]] std::vector<FileFigure> basins_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
