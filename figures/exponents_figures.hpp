#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Figures of diagnosed models: exponents with errors, their convergence, their rates; none if all models failed.
[[nodiscard]] std::vector<FileFigure> exponents_figures_of(const results::StoreReader& store);
/// Exponents over a key below the bifurcation diagram.
[[nodiscard]] std::vector<FileFigure> exponent_sweep_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
