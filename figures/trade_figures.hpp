#pragma once

#include <slipmode/figures/file_figures.hpp>
#include <slipmode/trade/study.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::figures {

/// A Pareto front for each measure that has values, as SVG and PNG: pareto_dX.svg, …
/// @return names of the files
std::vector<std::string> save_trade_figures(const trade::Study& study, const scene::Scene& scene,
                                            const std::filesystem::path& folder);

/// The same of a file that `slipmode trade` wrote; empty for another file.
[[nodiscard]] std::vector<FileFigure> trade_figures_of(const results::StoreReader& store);

}  // namespace slipmode::figures
