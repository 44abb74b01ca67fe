#pragma once

#include <slipmode/diagnostics/validation/validate.hpp>
#include "cli/session.hpp"

#include <filesystem>
#include <vector>

namespace slipmode::cli {

/// Validates and writes the result file with tables, sweeps and portraits. The sweep is journalled beside the file, so
/// that the same command goes on after an interruption; the journal is removed at the end.
/// @param options  progress, stop flag and sink are set here
/// @throws Interrupted  with the journal kept
[[nodiscard]] diagnostics::ValidationReport validate_into(const Session& session, const scene::Scene& scene,
                                                          const dynamics::HybridSystem& full,
                                                          const std::vector<diagnostics::Candidate>& candidates,
                                                          diagnostics::ValidationOptions options,
                                                          const std::filesystem::path& file);

}  // namespace slipmode::cli
