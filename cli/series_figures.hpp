#pragma once

#include <slipmode/results/store.hpp>
#include "cli/file_figures.hpp"

#include <vector>

namespace slipmode::cli {

/// Figures of a diagnosed series: delay map, mutual information, autocorrelation, false neighbours, divergence,
/// correlation sum, spectrum, section, recurrence; empty when the file holds none.
[[nodiscard]] std::vector<figures::FileFigure> series_figures_of(const results::StoreReader& store);

}  // namespace slipmode::cli
