#pragma once

#include "figures/file_figure.hpp"
#include "results/store.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::figures {

/// Figures of a diagnosed model: exponents with errors, their convergence, their rates, or exponents against a key
/// below the bifurcation diagram; empty when the file holds none.
[[nodiscard]] std::vector<FileFigure> exponents_figures_of(const results::StoreReader& store);

/// Draws each of them as FOLDER/<name>.svg and .png; makes the folder when it is not there.
/// @return the names, in order
std::vector<std::string> draw_exponents_figures(const results::StoreReader& store, const std::filesystem::path& folder);

}  // namespace slipmode::figures
