#pragma once

#include "cli/session.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::cli {

/// Draws every figure that the files give, as SVG and PNG, into their folder. Read from the files, so that
/// `slipmode plot` draws the same; drawn side by side, as each is a process of its own.
/// @param skipped  files whose figures are those of another
/// @return         names of the figures
std::vector<std::string> save_figures_of(const Session& session, const std::filesystem::path& folder,
                                         const std::vector<std::string>& files,
                                         const std::vector<std::string>& skipped);

}  // namespace slipmode::cli
