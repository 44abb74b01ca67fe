#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// A balance over the exact orbit behind it, as phase portraits; where orders were tried, their true errors.
[[nodiscard]] std::vector<FileFigure> balance_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
