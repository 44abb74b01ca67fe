#pragma once

#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// Says which times the scene left open, and what was chosen for them by which period; nothing where none was.
/// @param names  of tables and keys that matter: "time", "validation", "validation.block"
void tell_chosen_times(const scene::Scene& scene, const std::vector<std::string>& names, Report& out_report);

/// Says what is not to be had where no contact's law sticks; nothing elsewhere, or where slips are not asked for.
void tell_without_slips(const scene::Scene& scene, Report& out_report);

/// Says that an ensemble's runs all start alike, where they do.
void tell_alike_runs(const scene::Scene& scene, Report& out_report);

}  // namespace slipmode::cli
