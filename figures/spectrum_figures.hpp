#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

/// Amplitude over order of every contact's displacement, velocity and force.
[[nodiscard]] std::vector<FileFigure> spectrum_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
