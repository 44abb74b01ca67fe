#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of a map over two keys, and of one over one key.
[[nodiscard]] std::vector<FileFigure> map_figures_of(const results::StoreReader& store);
[[nodiscard]] std::vector<FileFigure> strobe_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
