#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/figures/file_figure.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::figures {

/// Kinds of files that figures are made of.
[[nodiscard]] std::vector<results::FileKind> drawn_kinds();

/// All figures a file can give, the most telling first; empty when it holds nothing to draw.
[[nodiscard]] std::vector<FileFigure> figures_of(const results::StoreReader& store);

/// Draws every figure that the files give, as SVG and PNG, into their folder. Read from the files, so that
/// `slipmode plot` draws the same; drawn side by side, as each is a process of its own.
/// @param skipped  files whose figures are those of another
/// @return         names of the figures
std::vector<std::string> save_figures_of(const std::filesystem::path& folder, const std::vector<std::string>& files,
                                         const std::vector<std::string>& skipped, const ParallelOptions& parallel);

}  // namespace slipmode::figures
