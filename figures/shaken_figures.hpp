#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

// Figures of results of scenes with a shaker, sweeps and validations also with a force, the most telling first.

/// Agreement against the number of modes, small multiples of reduced models over the full one, labels.
[[nodiscard]] std::vector<FileFigure> driven_validation_figures_of(const results::StoreReader& store);
/// Sections and labelled amplitudes over the swept key.
[[nodiscard]] std::vector<FileFigure> driven_sweep_figures_of(const results::StoreReader& store);
/// Modal functions and modes along the beam; none where there is no beam.
[[nodiscard]] std::vector<FileFigure> shaken_pod_figures_of(const results::StoreReader& store);
[[nodiscard]] std::vector<FileFigure> shaken_reduced_figures_of(const results::StoreReader& store);
/// Friction loops, delay map and spectrum before those of any trajectory.
[[nodiscard]] std::vector<FileFigure> shaken_trajectory_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
