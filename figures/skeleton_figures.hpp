#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of a result of `slipmode orbit skeleton`; none when the file holds no skeleton.
[[nodiscard]] std::vector<FileFigure> skeleton_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
