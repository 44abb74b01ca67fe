#pragma once

#include "cli/file_figures.hpp"

#include <vector>

namespace slipmode::cli {

/// Figures of a result of `slipmode orbit skeleton`; none when the file holds no skeleton.
[[nodiscard]] std::vector<FileFigure> skeleton_figures_of(const results::StoreReader& store);

}  // namespace slipmode::cli
