#pragma once

#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/results/store.hpp>
#include "cli/session.hpp"
#include "cli/validation_report.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::cli {

inline constexpr const char* kShakenValidationGroup = "shaken_validation";

/// Full against reduced models over [validation] frequencies (or at the drive's own, where there are none), into a
/// file; resumable like a sweep.
/// @throws Interrupted  when Ctrl-C was pressed; the journal beside the file then holds what was finished
[[nodiscard]] diagnostics::DrivenValidationReport validate_shaken_into(
    const Session& session, const scene::Scene& scene, const std::vector<diagnostics::DrivenCandidate>& candidates,
    const std::filesystem::path& file);

[[nodiscard]] Json to_json(const diagnostics::DrivenValidationReport& report);
[[nodiscard]] std::string summary_text(const diagnostics::DrivenValidationReport& report, const scene::Scene& scene);

}  // namespace slipmode::cli
