#pragma once

#include <slipmode/figures/file_figure.hpp>
#include <slipmode/results/store.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of a diagnosed model: exponents with errors, their convergence, their rates, or exponents against a key
/// below the bifurcation diagram; empty when the file holds none.
[[nodiscard]] std::vector<FileFigure> exponents_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
