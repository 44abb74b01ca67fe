#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// The lowest natural modes, contacts slipping, stuck, and held by their springs.
[[nodiscard]] std::vector<FileFigure> natural_mode_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
