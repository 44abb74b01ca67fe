#pragma once

#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// Says which times the scene left open, and what was chosen for them by which period; nothing where none was.
/// @param tables  of the scene: "time", "validation"
void tell_chosen_times(const scene::Scene& scene, const std::vector<std::string>& tables, Report& out_report);

}  // namespace slipmode::cli
