#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of a result of `slipmode orbit map`; none when the file holds no map.
[[nodiscard]] std::vector<FileFigure> map_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
