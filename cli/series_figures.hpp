#pragma once

#include "cli/file_figures.hpp"
#include "results/store.hpp"

#include <filesystem>
#include <vector>

namespace slipmode::cli {

/// Figures of a diagnosed series: delay map, mutual information, autocorrelation, false neighbours, divergence,
/// correlation sum, spectrum, section, recurrence; empty when the file holds none.
[[nodiscard]] std::vector<figures::FileFigure> series_figures_of(const results::StoreReader& store);

/// Draws each of them as FOLDER/<name>.svg and .png; makes the folder when it is not there.
/// @return the names, in order
std::vector<std::string> draw_series_figures(const results::StoreReader& store, const std::filesystem::path& folder);

}  // namespace slipmode::cli
