#pragma once

#include <slipmode/studies/run_options.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::report {

/// True when this build has D3, which draws the report (Debian: node-d3).
[[nodiscard]] bool is_available();
/// @throws InvalidInput  when it is not, saying what brings it
void require_available();

/// Result files as one HTML page that needs nothing else: what was modelled, how far the reduced model is to be
/// trusted, every figure and table of every file, where it came from.
///
/// Of a validation with its POD beside it, motions of the full model and of reduced ones are computed, at a bounded
/// number of belt speeds or shaker frequencies, so that the page can show the motion at one that is clicked.
/// @param inputs  result files, and folders of which all are taken (*.h5)
/// @throws InvalidInput  as require_available; when an input is missing, no result file, or a folder has none
/// @throws Interrupted   when the stop flag was set
[[nodiscard]] std::string page(const std::vector<std::filesystem::path>& inputs, const studies::RunOptions& run = {});

}  // namespace slipmode::report
