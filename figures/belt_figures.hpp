#pragma once

#include <slipmode/figures/file_figure.hpp>

#include <vector>

namespace slipmode::figures {

// Figures of results of scenes without a shaker, and of any trajectory.

/// Displacement, velocity and force of the first contact, the last stretch of a trajectory.
[[nodiscard]] FileFigure history_figure();
/// History and phase portrait of the first contact.
[[nodiscard]] std::vector<FileFigure> trajectory_figures_of(const results::StoreReader& store);
/// Proper orthogonal modes beside natural modes, energy shares.
[[nodiscard]] std::vector<FileFigure> belt_pod_figures_of(const results::StoreReader& store);
[[nodiscard]] std::vector<FileFigure> belt_reduced_figures_of(const results::StoreReader& store);
/// Bifurcation diagram.
[[nodiscard]] std::vector<FileFigure> belt_sweep_figures_of(const results::StoreReader& store);
/// Deviations against the number of modes, bifurcation diagram if there is one, phase portraits.
[[nodiscard]] std::vector<FileFigure> belt_validation_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
