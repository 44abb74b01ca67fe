#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of a stored orbit: phase portrait, multipliers, history.
[[nodiscard]] std::vector<FileFigure> orbit_figures_of(const results::StoreReader& store);
/// Figures of stored curves of special points: the plane of both keys.
[[nodiscard]] std::vector<FileFigure> curve_figures_of(const results::StoreReader& store);
/// Figures of stored branches: response, multipliers.
[[nodiscard]] std::vector<FileFigure> branch_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
