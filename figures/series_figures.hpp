#pragma once

#include <slipmode/figures/file_figures.hpp>
#include <slipmode/results/store.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of a diagnosed series: delay map, mutual information, autocorrelation, false neighbours, divergence,
/// correlation sum, spectrum, section, recurrence; empty when the file holds none.
[[nodiscard]] std::vector<FileFigure> series_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
