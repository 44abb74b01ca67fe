#pragma once

#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// Says which times the scene left open, and what was chosen for them by which period; nothing where none was.
/// @param tables  of the scene: "time", "validation"
void tell_chosen_times(const scene::Scene& scene, const std::vector<std::string>& tables, Report& out_report);

/// Says what is not to be had where no contact's law sticks; nothing elsewhere, or where slips are not asked for.
void tell_without_slips(const scene::Scene& scene, Report& out_report);

}  // namespace slipmode::cli
