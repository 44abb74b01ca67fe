#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::cli {

/// All figures a file can give, the most telling first; empty when it holds nothing to draw.
[[nodiscard]] std::vector<figures::FileFigure> figures_of(const results::StoreReader& store);

}  // namespace slipmode::cli
